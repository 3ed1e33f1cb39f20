// The data of the page, as the program wrote them into it.

/** One table row as an object; `index` is its place on the page. */
export function readData() {
  const data = JSON.parse(document.getElementById('data').textContent);
  const names = Object.keys(data.columns);
  const length = data.columns.mesh.length;
  data.rows = Array.from({length}, (_, index) => {
    const row = {index};
    for (const name of names) row[name] = data.columns[name][index];
    return row;
  });
  data.labels = shortLabels(data.settings);
  data.modelOfRow = new Map(data.models.map((model, i) => [model.row, i]));
  return data;
}

/** The options by which settings differ from each other; of settings that stand alone, all. */
export function shortLabels(settings) {
  if (settings.length < 2) return settings;
  const options = settings.map(text => text.split(/ (?=--)/));
  const common = options[0].filter(option => options.every(all => all.includes(option)));
  return options.map(all => all.filter(option => !common.includes(option)).join(' ') || '(no other options)');
}

/** The numbers of a column, without rows that have none. */
export const numbers = (rows, column) => rows.map(row => row[column]).filter(value => value !== null);

export function quantile(sorted, part) {
  if (sorted.length === 0) return null;
  const place = (sorted.length - 1) * part;
  const below = sorted[Math.floor(place)];
  return below + (sorted[Math.ceil(place)] - below) * (place % 1);
}

export const sorted = values => Float64Array.from(values).sort();
export const median = values => quantile(sorted(values), 0.5);
export const mean = values => values.reduce((sum, value) => sum + value, 0) / values.length;

/** Shares of values that hold, as a percentage. */
export const percentage = (part, whole) => whole === 0 ? '-' : `${(100 * part / whole).toFixed(1)} %`;

/** Three significant digits, thousands apart; a dash for nothing. */
export function pretty(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return '-';
  const whole = Number.isInteger(value) || Math.abs(value) >= 1000;
  if (whole) return Math.round(value).toLocaleString('en').replaceAll(',', ' ');
  return String(Number(value.toPrecision(3)));
}

/** An element with attributes and children; text is never read as HTML. */
export function element(name, attributes = {}, ...children) {
  const made = Object.assign(document.createElement(name), attributes);
  made.append(...children);
  return made;
}

/** A table of texts and elements, the first row being its head. */
export function plainTable([head, ...rows]) {
  const line = (cell, cells) => element('tr', {}, ...cells.map(content => element(cell, {}, content)));
  return element('table', {}, element('thead', {}, line('th', head)),
                 element('tbody', {}, ...rows.map(row => line('td', row))));
}
