// Histograms, densities and fits: what the charts draw, whatever draws it.
import {mean, quantile, sorted} from './data.js';

const forward = logarithmic => logarithmic ? Math.log10 : value => value;
const backward = logarithmic => logarithmic ? exponent => 10 ** exponent : value => value;

/** A number as the axis of a chart has it. Zero has no logarithm and is left out there. */
const usable = (values, logarithmic) => logarithmic ? values.filter(value => value > 0) : values;

/** Bins of equal width on the axis: [{x1, x2, count}]. */
export function histogram(values, {logarithmic = false, bins = 40} = {}) {
  const on = usable(values, logarithmic).map(forward(logarithmic));
  if (on.length === 0) return [];
  let [least, most] = [on.reduce((a, b) => Math.min(a, b)), on.reduce((a, b) => Math.max(a, b))];
  if (least === most) [least, most] = [least - 0.5, most + 0.5];
  const width = (most - least) / bins;
  const counts = new Array(bins).fill(0);
  for (const x of on) ++counts[Math.min(bins - 1, Math.floor((x - least) / width))];
  const back = backward(logarithmic);
  return counts.map((count, i) => ({x1: back(least + i * width), x2: back(least + (i + 1) * width), count}));
}

/**
 * Gaussian kernel density of the values behind a histogram, in meshes for each of its bins: [{x, y}]. The width of the
 * kernel is that of Silverman's rule.
 */
export function density(values, bars, {logarithmic = false} = {}) {
  const on = sorted(usable(values, logarithmic).map(forward(logarithmic)));
  if (on.length < 5) return [];
  const middle = mean(on);
  const deviation = Math.sqrt(mean(on.map(x => (x - middle) ** 2)));
  const spread = Math.min(deviation, (quantile(on, 0.75) - quantile(on, 0.25)) / 1.34) || deviation;
  const kernel = 0.9 * spread * on.length ** -0.2;
  if (!(kernel > 0)) return [];
  const [first, last] = [forward(logarithmic)(bars[0].x1), forward(logarithmic)(bars.at(-1).x2)];
  const cells = gathered(on, first, last, 512);
  const factor = (last - first) / bars.length / (kernel * Math.sqrt(2 * Math.PI));
  return Array.from({length: 201}, (_, i) => {
    const x = first + (last - first) * i / 200;
    const y = cells.reduce((sum, {at, count}) => sum + count * Math.exp(-0.5 * ((x - at) / kernel) ** 2), 0);
    return {x: backward(logarithmic)(x), y: factor * y};
  });
}

/** Values counted in narrow cells: thousands of them need not each have a kernel of their own. */
function gathered(values, first, last, cells) {
  const width = (last - first) / cells;
  const counts = new Array(cells).fill(0);
  for (const x of values) ++counts[Math.min(cells - 1, Math.max(0, Math.floor((x - first) / width)))];
  return counts.map((count, i) => ({at: first + (i + 0.5) * width, count})).filter(({count}) => count > 0);
}

/** y = factor * x ** exponent, by least squares of the logarithms; null if the points do not tell. */
export function powerLaw(points) {
  const logs = points.filter(({x, y}) => x > 0 && y > 0).map(({x, y}) => [Math.log(x), Math.log(y)]);
  if (logs.length < 3) return null;
  const [mx, my] = [mean(logs.map(([x]) => x)), mean(logs.map(([, y]) => y))];
  const variance = mean(logs.map(([x]) => (x - mx) ** 2));
  if (variance === 0) return null;
  const exponent = mean(logs.map(([x, y]) => (x - mx) * (y - my))) / variance;
  return {exponent, factor: Math.exp(my - exponent * mx), count: logs.length};
}

/** Points of a plane with logarithmic axes, counted in cells: [{x, y, count}], each cell at its middle. */
export function logarithmicCells(points, perDecade = 14) {
  const cells = new Map();
  for (const {x, y} of points) {
    const [i, j] = [x, y].map(value => Math.floor(Math.log10(value) * perDecade));
    const key = `${i} ${j}`;
    if (!cells.has(key)) cells.set(key, {x: 10 ** ((i + 0.5) / perDecade), y: 10 ** ((j + 0.5) / perDecade), count: 0});
    ++cells.get(key).count;
  }
  return [...cells.values()];
}
