// The section of the page with the view in 3D: its controls, its scale and what is said of the model.
import {pretty} from './data.js';
import {scaleColour, Viewer} from './viewer.js';

const field = id => document.getElementById(id);

export class ModelSection {
  constructor(data) {
    this.data = data;
    field('models').hidden = data.models.length === 0;
    data.models.forEach((model, i) => {
      const row = data.rows[model.row];
      const settings = data.settings.length > 1 ? ` (${data.labels[row.settings]})` : '';
      field('model').add(new Option(row.mesh + settings, i));
    });
    field('model').addEventListener('change', () => this.open(Number(field('model').value)));
    field('viewer-controls').addEventListener('input', ({target}) => {
      if (target.id !== 'model') this.update();
    });
    field('reset-view').addEventListener('click', () => this.viewer?.reset());
    this.openWhenSeen();
  }

  /** WebGL and the arrays of a model are for those only who look at it. */
  openWhenSeen() {
    const seen = new IntersectionObserver(([entry]) => {
      if (!entry.isIntersecting) return;
      seen.disconnect();
      if (this.opened === undefined) this.open(0);
    });
    if (this.data.models.length > 0) seen.observe(field('stage'));
  }

  showRow(row) {
    field('models').scrollIntoView();
    this.open(this.data.modelOfRow.get(row.index));
  }

  open(place) {
    this.opened = place;
    field('model').value = place;
    const contents = this.data.models[place];
    field('view').hidden = contents.error !== '';
    field('model-text').textContent = contents.error ? `Cannot be shown: ${contents.error}` : this.text(contents);
    if (contents.error === '' && this.start()) this.viewer.show(contents, place, this.view());
    this.drawScale(contents);
  }

  start() {
    try {
      this.viewer ??= new Viewer(field('view'));
    } catch (error) {
      field('model-text').textContent = `This browser shows no 3D (WebGL): ${error.message}`;
    }
    return Boolean(this.viewer);
  }

  view() {
    const checked = id => field(id).checked;
    const axis = field('section-axis').value;
    return {input: checked('show-input'), inputWires: checked('show-input-wires'), cage: checked('show-cage'),
            wires: checked('show-wires'), distance: checked('show-distance'),
            section: axis ? {axis: 'xyz'.indexOf(axis), part: Number(field('section-place').value)} : null};
  }

  update() {
    field('section-place').disabled = field('section-axis').value === '';
    const contents = this.data.models[this.opened];
    if (contents?.error === '' && this.viewer) this.viewer.update(this.view());
    if (contents) this.drawScale(contents);
  }

  text(contents) {
    const {input, cage} = contents;
    const whole = input.faces === input.faces_of_file;
    const faces = whole ? `${pretty(input.faces)} faces` :
        `${pretty(input.faces_of_file)} faces, simplified to ${pretty(input.faces)} for this view, so that it may ` +
        'seem to touch the cage; distances are those to the whole input';
    const row = this.data.rows[contents.row];
    const around = cage ? `Cage: ${pretty(cage.faces)} faces.` : `No cage: ${[row.status, row.message, row.defects]
        .filter(Boolean).join('; ')}.`;
    return `Input: ${faces}. ${around} Positions are rounded to 1/65535 of the model's size.`;
  }

  drawScale(contents) {
    field('scale').hidden = !(contents.cage && field('show-distance').checked && field('show-cage').checked);
    if (field('scale').hidden) return;
    const most = contents.largest_distance;
    const {tau_rel: tau} = this.data.rows[contents.row];
    field('scale-most').textContent = `distance ${pretty(most)} = ${pretty(100 * most / contents.diagonal)} % of the ` +
        `diagonal; tau is ${pretty(tau === null ? null : 100 * tau)} %`;
    const stops = Array.from({length: 17}, (_, i) => scaleColour(i / 16));
    field('scale-bar').style.background = `linear-gradient(to top, ${stops.join(', ')})`;
  }
}
