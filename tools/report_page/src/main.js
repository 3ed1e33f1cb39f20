// The page of `prcage report`. What is seen first is drawn first: the tables and the view in 3D follow.
import {drawCharts} from './charts.js';
import {pretty, readData} from './data.js';
import {ModelSection} from './models.js';
import {drawCauses, drawSummary, drawWorst} from './summary.js';
import {drawFailures, drawRows} from './tables.js';

const field = id => document.getElementById(id);
const painted = () => new Promise(done => requestAnimationFrame(() => setTimeout(done)));

function drawHead(data) {
  document.title = data.title;
  field('title').textContent = data.title;
  const options = data.settings.length === 1 ? `, ${data.settings[0]}` : '';
  field('origin').textContent = `${pretty(data.total_rows)} results of ${data.table}, the last of ${
    data.last_finished || 'no known time'}${options}`;
  field('version').textContent = data.version;
  if (data.rows.length < data.total_rows) {
    field('sampled').textContent = `Medians, charts, lists and tables are of ${pretty(data.rows.length)} of the ${
      pretty(data.total_rows)} rows: an even choice, and the worst. The numbers of meshes and cages are of all.`;
  }
}

/** Charts and lists are those of one of the settings, or of all of them. */
function drawChosen(data, models) {
  const chosen = field('settings').value;
  const rows = data.rows.filter(row => row.has_cage && (chosen === '' || row.settings === Number(chosen)));
  drawCharts(field('charts'), rows);
  drawWorst(field('worst'), data, rows, row => models.showRow(row));
}

function offerSettings(data, models) {
  if (data.settings.length < 2) return;
  data.labels.forEach((label, i) => field('settings').add(new Option(label, i)));
  field('settings').add(new Option('all of them', ''));
  field('choice').hidden = false;
  field('settings').addEventListener('change', () => drawChosen(data, models));
}

async function draw() {
  const data = readData();
  const models = new ModelSection(data);
  offerSettings(data, models);
  drawHead(data);
  drawSummary(field('summary'), data);
  drawCauses(field('causes'), data);
  drawChosen(data, models);
  await painted();
  const firstView = performance.now();
  const failures = data.rows.filter(row => !row.has_cage);
  field('no-failures').hidden = failures.length > 0;
  if (failures.length > 0) drawFailures(field('failures'), data, failures, row => models.showRow(row));
  drawRows(field('rows'), data, row => models.showRow(row),
           count => field('row-count').textContent = `${pretty(count)} of ${pretty(data.rows.length)} rows.`);
  await painted();
  Object.assign(document.documentElement.dataset, {firstView, complete: performance.now()});
}

draw();
