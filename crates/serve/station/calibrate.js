// The dialog that sets the geometry: the base's joints, the platform, and how displacements become lengths.
import { by, make, number, say } from './dom.js';
import { platform } from './kinematics.js';

/** @typedef {import('./kinematics.js').Vec} Vec */
/** @typedef {import('./kinematics.js').Machine} Machine */
/** @typedef {import('./robot.js').Arm} Arm */
/** @typedef {{ pose: Vec, displacements: Vec }} Known */

/**
 * Scale and offset of each arm from known poses, by least squares: two poses determine them, more even out what was
 * measured badly.
 * @param {Machine} machine
 * @param {Known[]} known
 * @returns {{ arms: Arm[], error: number }} the error is the largest one of a leg's length, in metres
 */
export function fit(machine, known) {
  const lengths = known.map(({ pose }) => {
    const there = platform(machine, pose);
    if (!there) throw new Error(`the pose ${pose.join(' ')} is none that this geometry has`);
    return there.lengths;
  });
  if (known.length < 2) throw new Error('two known poses are needed at least');
  const arms = [0, 1, 2].map((arm) => {
    const mean = (/** @type {number[]} */ values) => values.reduce((sum, value) => sum + value, 0) / values.length;
    const [x, y] = [known.map(({ displacements }) => displacements[arm]), lengths.map((length) => length[arm])];
    const [middleX, middleY] = [mean(x), mean(y)];
    const spread = mean(x.map((value) => (value - middleX) ** 2));
    if (spread < 1e-9) throw new Error(`arm ${'ABC'[arm]} stands at the same displacement in all of these poses`);
    const scale = mean(x.map((value, at) => (value - middleX) * (y[at] - middleY))) / spread;
    if (Math.abs(scale) < 1e-12) throw new Error(`arm ${'ABC'[arm]} has the same length in all of these poses`);
    return { scale, offset: middleY - scale * middleX };
  });
  const errors = known.flatMap(({ displacements }, at) => arms.map(({ scale, offset }, arm) => Math.abs(offset + scale * displacements[arm] - lengths[at][arm])));
  return { arms, error: Math.max(...errors) };
}

const POINTS = /** @type {const} */ (['a1', 'a2', 'a3']);

export class Calibration {
  /** @param {() => import('./robot.js').Robot | null} robot */
  constructor(robot) {
    this.robot = robot;
    /** @type {Known[]} */
    this.known = [];
    this.dialog = /** @type {HTMLDialogElement} */ (by('calibrate'));
    const group = (/** @type {string} */ title, /** @type {string[]} */ ids, /** @type {string[]} */ names) => make('fieldset', {}, make('legend', {}, title),
      make('div', { class: 'fields' }, ...ids.map((id, at) => make('label', {}, names[at], make('input', { id: `cal-${id}`, inputmode: 'decimal', autocomplete: 'off' })))));
    const button = (/** @type {string} */ text, /** @type {() => void} */ act) => {
      const made = make('button', { type: 'button' }, text);
      made.addEventListener('click', act);
      return made;
    };
    this.list = make('ul');
    this.note = make('p', { role: 'status' });
    this.form = make('form', { novalidate: '' },
      make('h2', { id: 'calibrate-title' }, 'Geometry'),
      make('p', {}, 'Metres, in any frame. Length of a leg = offset + scale × displacement.'),
      ...POINTS.map((point) => group(`Joint ${point.toUpperCase()} on the base`, ['x', 'y', 'z'].map((axis) => point + axis), ['X', 'Y', 'Z'])),
      group('Platform', ['d_b1b3', 'd_e'], ['B1 to B3', 'B2 off the plane']),
      group('Scale (metres per unit)', ['scale0', 'scale1', 'scale2'], ['A', 'B', 'C']),
      group('Offset (metres at displacement 0)', ['offset0', 'offset1', 'offset2'], ['A', 'B', 'C']),
      group('Least displacement (may be empty)', ['min0', 'min1', 'min2'], ['A', 'B', 'C']),
      group('Largest displacement (may be empty)', ['max0', 'max1', 'max2'], ['A', 'B', 'C']),
      group('Pose at which the robot stands now', ['px', 'py', 'pz'], ['X', 'Y', 'Z']),
      make('div', { class: 'row' }, button('Add known pose', () => this.add()), button('Compute scale and offset', () => this.compute())),
      this.list, this.note,
      make('div', { class: 'row' }, make('button', { type: 'submit' }, 'Save'), button('Remove geometry', () => this.send(null)), button('Close', () => this.dialog.close())));
    this.form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.attempt(() => this.send(this.geometry()));
    });
    this.dialog.append(this.form);
    by('calibrate-open').addEventListener('click', () => this.open());
  }

  /** @param {string} id */
  field(id) {
    return /** @type {HTMLInputElement} */ (by(`cal-${id}`));
  }

  /** @param {string} id */
  value(id) {
    const text = this.field(id).value.trim().replace(',', '.');
    const value = text === '' ? NaN : Number(text);
    this.field(id).setAttribute('aria-invalid', String(!Number.isFinite(value)));
    if (Number.isFinite(value)) return value;
    this.field(id).focus();
    throw new Error(`${this.field(id).closest('fieldset')?.querySelector('legend')?.textContent}: a number is needed`);
  }

  /** @param {string} x @param {string} y @param {string} z @returns {Vec} */
  vec(x, y, z) {
    return [this.value(x), this.value(y), this.value(z)];
  }

  /** @returns {Machine} */
  machine() {
    const [a1, a2, a3] = POINTS.map((point) => this.vec(`${point}x`, `${point}y`, `${point}z`));
    return { a1, a2, a3, d_b1b3: this.value('d_b1b3'), d_e: this.value('d_e') };
  }

  /** @returns {import('./robot.js').Geometry} */
  geometry() {
    const { a1, a2, a3, d_b1b3, d_e } = this.machine();
    const arm = (/** @type {number} */ at) => ({ scale: this.value(`scale${at}`), offset: this.value(`offset${at}`), ...this.limit('min', at), ...this.limit('max', at) });
    return { joints: [a1, a2, a3], edge: d_b1b3, offset: d_e, arms: [arm(0), arm(1), arm(2)] };
  }

  /** @param {'min' | 'max'} end @param {number} arm */
  limit(end, arm) {
    const empty = this.field(end + arm).value.trim() === '';
    this.field(end + arm).setAttribute('aria-invalid', 'false');
    return empty ? {} : { [end]: this.value(end + arm) };
  }

  open() {
    const geometry = this.robot()?.state.geometry;
    if (geometry) {
      POINTS.forEach((point) => 'xyz'.split('').forEach((axis, at) => { this.field(point + axis).value = String(geometry.joints[POINTS.indexOf(point)][at]); }));
      this.field('d_b1b3').value = String(geometry.edge);
      this.field('d_e').value = String(geometry.offset);
      [0, 1, 2].forEach((arm) => {
        for (const what of /** @type {const} */ (['scale', 'offset', 'min', 'max'])) this.field(what + arm).value = String(geometry.arms[arm][what] ?? '');
      });
    }
    say(this.note, '');
    this.dialog.showModal();
  }

  /** @param {() => void | Promise<void>} act */
  async attempt(act) {
    try {
      this.note.className = '';
      await act();
    } catch (error) {
      this.note.className = 'bad';
      say(this.note, error instanceof Error ? error.message : String(error));
    }
  }

  add() {
    this.attempt(() => {
      const displacements = this.robot()?.state.displacements;
      if (!displacements) throw new Error('the displacements are unknown: home first');
      this.known.push({ pose: this.vec('px', 'py', 'pz'), displacements: [...displacements] });
      this.list.append(make('li', {}, `${this.known.at(-1)?.pose.join(' ')} at ${displacements.map((value) => number(value)).join(' ')}`));
    });
  }

  compute() {
    this.attempt(() => {
      const { arms, error } = fit(this.machine(), this.known);
      arms.forEach(({ scale, offset }, arm) => {
        this.field(`scale${arm}`).value = scale.toPrecision(7);
        this.field(`offset${arm}`).value = offset.toPrecision(7);
      });
      say(this.note, `Computed from ${this.known.length} poses; the largest error of a leg is ${(error * 1000).toFixed(2)} mm.`);
    });
  }

  /** @param {import('./robot.js').Geometry | null} geometry */
  async send(geometry) {
    await this.attempt(async () => {
      await this.robot()?.setGeometry(geometry);
      this.dialog.close();
    });
  }
}
