// Numbers at the top of the page, and the lists of the worst models.
import {measures, scaled} from './columns.js';
import {element, median, numbers, percentage, plainTable, pretty} from './data.js';

const sum = counts => counts.reduce((total, {count}) => total + count, 0);

function settingsLine(data, settings) {
  const counts = data.counts.filter(entry => entry.settings === settings);
  const rows = data.rows.filter(row => row.settings === settings && row.has_cage);
  const [all, made] = [sum(counts), sum(counts.filter(entry => entry.has_cage))];
  const judged = rows.filter(row => row.paper_success !== null);
  const held = judged.filter(row => row.paper_success === 1);
  const medians = measures.map(({key, scale}) => {
    const values = numbers(rows, key);
    return values.length ? pretty(median(values) * scale) : '-';
  });
  return [data.labels[settings], pretty(all), pretty(made), percentage(made, all),
          percentage(held.length, judged.length), ...medians];
}

/** Success of each of the settings: the form of the paper's table 1. Counts are of all rows of the table. */
export function drawSummary(place, data) {
  const head = ['Settings', 'Meshes', 'Cages', 'Success', 'Paper\'s conditions',
                ...measures.map(({title}) => `${title}, median`)];
  place.replaceChildren(plainTable([head, ...data.settings.map((_, i) => settingsLine(data, i))]));
}

/** How many rows ended in which way, the most frequent first. */
export function drawCauses(place, data) {
  const counts = new Map();
  for (const {status, cause, count} of data.counts) {
    const key = JSON.stringify([status, cause]);
    counts.set(key, (counts.get(key) ?? 0) + count);
  }
  const lines = [...counts].sort(([, a], [, b]) => b - a).map(([key, count]) => {
    const [status, cause] = JSON.parse(key);
    return [status, cause, pretty(count), percentage(count, data.total_rows)];
  });
  place.replaceChildren(plainTable([['Status', 'Cause', 'Meshes', 'Share'], ...lines]));
}

/** The name of a row's mesh, as a button if the page has the model. */
export function nameOf(row, data, show) {
  if (!data.modelOfRow.has(row.index)) return element('span', {}, row.mesh);
  return element('button', {type: 'button', className: 'link', title: 'show in 3D', onclick: () => show(row)},
                 row.mesh);
}

/** For each measure the models with the largest values. */
export function drawWorst(place, data, rows, show) {
  const lists = measures.map(measured => {
    const worst = rows.filter(row => row[measured.key] > 0)
                      .sort((a, b) => b[measured.key] - a[measured.key])
                      .slice(0, 8);
    if (worst.length === 0) return null;
    const lines = worst.map(row => [nameOf(row, data, show), pretty(scaled(row, measured)), pretty(row.input_faces)]);
    return element('div', {}, plainTable([['Mesh', measured.title, 'Input faces'], ...lines]));
  });
  place.replaceChildren(...lists.filter(Boolean));
}
