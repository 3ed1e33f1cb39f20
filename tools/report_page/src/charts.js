// The charts: distributions as in figures 10, 11 and 15 of the paper, and time against size.
import * as Plot from '@observablehq/plot';
import {measures} from './columns.js';
import {element, mean, median, numbers, pretty} from './data.js';
import {density, histogram, logarithmicCells, powerLaw} from './statistics.js';

const size = {width: 450, height: 260, marginLeft: 50, marginBottom: 36, style: {fontSize: '11px'}};
const mostPoints = 1500;  // beyond it points are counted in cells

const largest = values => values.reduce((a, b) => Math.max(a, b));

const axis = ({logarithmic, unit}) => ({type: logarithmic ? 'log' : 'linear', label: unit, tickFormat: pretty,
                                        ...(logarithmic && {ticks: 6})});

function figure(title, plot, ...caption) {
  return element('figure', {}, element('h3', {}, title), plot, element('figcaption', {}, ...caption));
}

const marked = (kind, value, unit) => element('span', {className: kind}, `${kind === 'most' ? 'maximum' : kind} ${
  pretty(value)}${unit}`);

/** A histogram with its density; lines for median, mean and maximum. */
function distribution(measured, values) {
  const bars = histogram(values, measured);
  const lines = [[median(values), '#1f5fbf', null], [mean(values), '#2e8b57', '6 4'],
                 [largest(values), '#c0392b', '2 3']]
                    .filter(([x]) => x > 0 || !measured.logarithmic);
  return Plot.plot({
    ...size,
    x: axis(measured),
    y: {label: 'meshes', grid: true},
    marks: [
      Plot.rectY(bars, {x1: 'x1', x2: 'x2', y: 'count', fill: '#a9c5e0', insetLeft: 0.5, insetRight: 0.5,
                        title: ({x1, x2, count}) => `${pretty(x1)} to ${pretty(x2)}: ${count}`}),
      Plot.lineY(density(values, bars, measured), {x: 'x', y: 'y', stroke: '#34495e'}),
      ...lines.map(([x, stroke, strokeDasharray]) => Plot.ruleX([x], {stroke, strokeDasharray, strokeWidth: 1.5})),
      Plot.ruleY([0]),
    ],
  });
}

function distributionFigure(measured, values) {
  const unit = measured.unit.startsWith('%') ? ' %' : ` ${measured.unit}`;
  const caption = [marked('median', median(values), unit), ', ', marked('mean', mean(values), unit), ', ',
                   marked('most', largest(values), unit), `; ${pretty(values.length)} meshes`];
  if (measured.key === 'seconds') {
    const share = most => (100 * values.filter(value => value <= most).length / values.length).toFixed(1);
    caption.push(`; within 20 s: ${share(20)} %, within a minute: ${share(60)} %`);
  }
  return figure(measured.chart, distribution(measured, values), ...caption);
}

/** Violations are zero for most cages: these are a number, and the histogram is that of the others, with its counts. */
function violationFigure(measured, values) {
  const above = values.filter(value => value > 0);
  const bars = histogram(above, {bins: 20});
  const plot = Plot.plot({
    ...size,
    x: axis(measured),
    y: {label: 'meshes', grid: true},
    marks: [
      Plot.rectY(bars, {x1: 'x1', x2: 'x2', y: 'count', fill: '#e0b8a9', insetLeft: 0.5, insetRight: 0.5}),
      Plot.text(bars.filter(({count}) => count > 0),
                {x: ({x1, x2}) => (x1 + x2) / 2, y: 'count', text: 'count', dy: -7}),
      Plot.ruleY([0]),
    ],
  });
  const caption = `not at all: ${values.length - above.length} of ${values.length} cages; mean ${
    pretty(mean(values))} %, worst ${pretty(largest(values))} %`;
  return figure(measured.chart, above.length > 0 ? plot : element('p', {}, 'No cage is beyond tau anywhere.'), caption);
}

function growthFigure(rows) {
  const points = rows.filter(row => row.input_faces > 0 && row.seconds > 0)
                     .map(row => ({x: row.input_faces, y: row.seconds, name: row.mesh}));
  if (points.length === 0) return null;
  const fit = powerLaw(points);
  const ends = [Math.min, Math.max].map(end => points.reduce((x, p) => end(x, p.x), points[0].x));
  const line = fit ? ends.map(x => ({x, y: fit.factor * x ** fit.exponent})) : [];
  const many = points.length > mostPoints;
  const look = {x: 'x', y: 'y', fill: '#2f6ea8', fillOpacity: 0.6};
  const dots = many ? Plot.dot(logarithmicCells(points), {...look, r: 'count'})
                    : Plot.dot(points, {...look, r: 2.5, tip: true, channels: {mesh: 'name'}});
  const plot = Plot.plot({
    ...size,
    grid: true,
    r: {range: [1, 7]},
    x: {type: 'log', label: 'faces of the input', tickFormat: pretty, ticks: 6},
    y: {type: 'log', label: 'seconds', tickFormat: pretty, ticks: 6},
    marks: [dots, Plot.line(line, {x: 'x', y: 'y', stroke: '#c0392b', strokeWidth: 1.5})],
  });
  const text = fit ? element('span', {}, 'time grows as faces to the power ',
                             element('b', {id: 'growth'}, fit.exponent.toFixed(2)),
                             ` (least squares of the logarithms of ${pretty(fit.count)} meshes)`)
                   : 'too few meshes for a fit';
  return figure('Time against faces', plot, text, many ? '; the area of a dot is its number of meshes' : '');
}

/** Draws the charts of rows with a cage into `place`, in place of those that are there. */
export function drawCharts(place, rows) {
  const figures = measures.map(measured => {
    const values = numbers(rows, measured.key).map(value => value * measured.scale);
    if (values.length === 0) return null;
    return measured.zeros ? violationFigure(measured, values) : distributionFigure(measured, values);
  });
  place.replaceChildren(...[...figures, growthFigure(rows)].filter(Boolean));
  if (place.childElementCount === 0) place.append('There is no cage to measure.');
}
