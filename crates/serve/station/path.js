// Paths: drawn or loaded, checked by the server, run by it, and seen in space: wanted, out of reach, reached.
import * as three from './vendor/three.js';
import { by, enable, input, make, say, usable } from './dom.js';
import { Drawing } from './draw.js';
import { isTracing } from './panel.js';
import { dispose, path } from './scene.js';

/** @typedef {import('./kinematics.js').Vec} Vec */
/** @typedef {import('./robot.js').Robot} Robot */
/** @typedef {import('./robot.js').Checked} Checked */

const FORMATS = [['csv', /\.(csv|tsv|txt)$/i], ['svg', /\.svg$/i], ['gcode', /\.(gcode|gc|nc|ngc|tap|cnc)$/i]];

export class PathPanel {
  /** @param {() => Robot | null} robot @param {import('./scene.js').MachineScene} scene */
  constructor(robot, scene) {
    this.robot = robot;
    this.scene = scene;
    this.group = new three.Group();
    scene.overlay.add(this.group);
    this.drawing = new Drawing(scene, (points) => this.checkPoints(points));
    /** What to check again when the plane or the tolerance changes. @type {(() => Promise<void>) | null} */
    this.again = null;
    /** @type {(() => import('./robot.js').PathRequest) | null} */
    this.request = null;
    /** @type {Checked | null} */
    this.checked = null;
    /** @type {Vec[]} */
    this.reached = [];
    const button = (/** @type {string} */ id, /** @type {string} */ text, /** @type {() => void} */ act, attributes = {}) => {
      const made = make('button', { type: 'button', id, ...attributes }, text);
      made.addEventListener('click', () => { if (usable(made)) act(); });
      return made;
    };
    const field = (/** @type {string} */ id, /** @type {string} */ text, /** @type {string} */ value, step = 'any') => {
      const made = make('input', { type: 'number', id, step, value });
      made.addEventListener('change', () => this.changed());
      return make('label', { class: 'inline' }, text, made);
    };
    const file = make('input', { type: 'file', id: 'path-file', accept: '.csv,.tsv,.txt,.svg,.gcode,.gc,.nc,.ngc,.tap,.cnc' });
    file.addEventListener('change', () => this.load(file.files?.[0]));
    by('path').append(
      make('div', { class: 'row' },
        button('path-draw', 'Draw', () => this.arm(!this.drawing.active), { 'aria-pressed': 'false' }),
        make('label', { class: 'inline' }, 'or file', file),
        field('path-tolerance', 'Tolerance (mm)', '0.5'), field('path-scale', 'Size ×', '1')),
      make('div', { class: 'row', role: 'group', 'aria-label': 'Plane' },
        field('path-x', 'Plane (mm) X', ''), field('path-y', 'Y', ''), field('path-z', 'Z', ''),
        field('path-tilt1', 'Tilt (°)', '0'), field('path-tilt2', 'and', '0'),
        button('path-here', 'To the tool', () => this.placeHere())),
      make('div', { class: 'row' },
        button('path-run', 'Run', () => this.run()),
        button('path-pause', 'Pause', () => this.act((robot) => robot.pausePath())),
        button('path-resume', 'Resume', () => this.act((robot) => robot.resumePath())),
        make('span', { id: 'path-progress-text', role: 'status' })),
      make('progress', { id: 'path-progress', max: '1', value: '0', 'aria-label': 'Progress of the path' }),
      make('p', { id: 'path-note', role: 'status' }),
      make('ul', { id: 'path-problems', 'aria-label': 'What is out of reach' }));
    this.drawing.show(false);
  }

  /** @param {boolean} shown whether its tab is open */
  show(shown) {
    if (!shown) this.arm(false);
    if (shown && this.scene.machine && input('path-x').value === '') this.placeHere();
    this.drawing.show(shown && this.scene.machine !== null);
  }

  /** Another robot, or another geometry. */
  reset() {
    this.checked = null;
    this.again = null;
    this.reached = [];
    for (const id of ['path-x', 'path-y', 'path-z']) input(id).value = '';
    this.note('', false);
    by('path-problems').replaceChildren();
    this.draw();
    this.update();
  }

  /** @param {string} text @param {boolean} bad */
  note(text, bad) {
    by('path-note').className = bad ? 'bad' : '';
    say(by('path-note'), text);
  }

  /** @param {boolean} active */
  arm(active) {
    if (active && !this.scene.machine) {
      this.note('Drawing needs the geometry: set it with "Geometry…".', true);
      return;
    }
    this.drawing.arm(active);
    by('path-draw').setAttribute('aria-pressed', String(active));
    if (active) this.note('Draw on the plane with mouse, pen or finger.', false);
  }

  /** Puts the plane where the tool is, or into the middle of where it may be. */
  placeHere() {
    const machine = this.scene.machine;
    if (!machine) return;
    const at = this.robot()?.state.pose ?? this.scene.controls.target.toArray();
    ['path-x', 'path-y', 'path-z'].forEach((id, axis) => { input(id).value = String(Math.round(at[axis] * 1e5) / 100); });
    this.changed();
  }

  /** What a number field holds, in the unit it is written in. @param {string} id */
  number(id) {
    const value = input(id).valueAsNumber;
    if (!Number.isFinite(value)) throw new Error(`${input(id).closest('label')?.textContent}: a number is needed`);
    return value;
  }

  placed() {
    const [x, y, z] = ['path-x', 'path-y', 'path-z'].map((id) => this.number(id) / 1000);
    this.drawing.place([x, y, z], this.number('path-tilt1'), this.number('path-tilt2'));
    if (!this.drawing.placed) throw new Error('the geometry of this robot is not set');
    return this.drawing.placed;
  }

  changed() {
    try {
      this.placed();
      this.again?.();
    } catch (error) {
      this.fail(error);
    }
  }

  /** @param {unknown} error */
  fail(error) {
    this.note(error instanceof Error ? error.message : String(error), true);
  }

  /** @param {Vec[]} points */
  checkPoints(points) {
    this.arm(false);
    return this.check(() => ({ points, tolerance: this.number('path-tolerance') / 1000 }), 'drawn');
  }

  /** @param {File | undefined} file */
  async load(file) {
    if (!file) return;
    const format = FORMATS.find(([, ending]) => /** @type {RegExp} */ (ending).test(file.name))?.[0];
    input('path-file').value = '';
    if (!format) return this.fail('the name of the file has to end in .csv, .svg or .gcode');
    if (file.size > 8 << 20) return this.fail(`${file.name} has more than 8 MB`);
    const text = await file.text();
    await this.check(() => {
      const { middle, x, y } = this.placed();
      return { format: String(format), file: text, tolerance: this.number('path-tolerance') / 1000, plane: { origin: middle, x, y }, scale: this.number('path-scale') };
    }, file.name);
  }

  /** @param {() => import('./robot.js').PathRequest} request @param {string} name */
  async check(request, name) {
    this.request = request;
    this.again = async () => {
      try {
        this.note(`${name}: being checked…`, false);
        const robot = this.robot();
        if (!robot) return;
        this.forgetRun(robot);
        this.checked = await robot.checkPath(request());
        const { targets, unreachable, length } = this.checked;
        this.note(unreachable.length === 0 ? `${name}: ${targets} targets, ${(length * 1000).toFixed(0)} mm, all within reach`
          : `${name}: ${unreachable.length} part${unreachable.length === 1 ? ' is' : 's are'} out of reach`, unreachable.length > 0);
        by('path-problems').replaceChildren(...unreachable.slice(0, 50).map(({ lines, reason }) => make('li', { class: 'bad' }, `${name === 'drawn' ? 'points' : 'lines'} ${lines[0]} to ${lines[1]}: ${reason}`)));
      } catch (error) {
        this.checked = null;
        by('path-problems').replaceChildren();
        this.fail(new Error(`${name}: ${error instanceof Error ? error.message : error}`));
      }
      this.draw();
      this.update();
    };
    await this.again();
  }

  run() {
    const { request } = this;
    const running = this.robot();
    if (!request || !running) return;
    this.forgetRun(running);
    this.draw();
    this.update();
    this.act((robot) => robot.runPath(request()));
  }

  /** Shows nothing of the run before as if it were of this path. @param {Robot} robot */
  forgetRun(robot) {
    this.reached = [];
    if (!isTracing(robot.state)) robot.run = robot.state.path = null;
  }

  /** @param {(robot: Robot) => Promise<void>} act */
  async act(act) {
    const robot = this.robot();
    try {
      if (robot) await act(robot);
    } catch (error) {
      this.fail(error);
    }
  }

  /** To be drawn by the next update. @param {Vec} pose where the tool was while the path ran */
  addReached(pose) {
    if (this.robot()?.state.path?.state !== 'running' || this.reached.length >= 20_000) return;
    this.reached.push(pose);
  }

  draw() {
    dispose(this.group);
    this.reachedLine = undefined;
    this.scene.wanted = true;
    if (!this.checked) return;
    const strokes = { wanted: 0x0072b2, travel: 0x8b949b, unreachable: 0xe0301e };
    for (const { kind, points } of this.checked.strokes) {
      // Dashed besides red, and over what is wanted: colour alone tells nothing to many people.
      const material = kind === 'wanted' ? new three.LineBasicMaterial({ color: strokes[kind] })
        : new three.LineDashedMaterial({ color: strokes[kind], dashSize: this.scene.size / (kind === 'travel' ? 12 : 6), gapSize: this.scene.size / 24 });
      const line = new three.Line(path(points), material).computeLineDistances();
      line.renderOrder = kind === 'unreachable' ? 1 : 0;
      this.group.add(line);
    }
    this.reachedLine = new three.Line(path(this.reached), new three.LineBasicMaterial({ color: 0x009e73 }));
    this.reachedLine.frustumCulled = false;
    this.group.add(this.reachedLine);
  }

  /** What is drawn, in kinds and points. */
  drawn() {
    const count = (/** @type {string} */ kind) => this.checked?.strokes.filter((stroke) => stroke.kind === kind).length ?? 0;
    return { wanted: count('wanted'), unreachable: count('unreachable'), reached: this.reachedLine?.geometry.getAttribute('position').count ?? 0 };
  }

  update() {
    const state = this.robot()?.state;
    if (!state) return;
    if (this.reachedLine && this.drawn().reached < this.reached.length) {
      this.reachedLine.geometry.dispose();
      this.reachedLine.geometry = path(this.reached);
      this.scene.wanted = true;
    }
    const run = state.path;
    const drives = state.driver?.mine === true;
    const why = drives ? '' : 'take control first';
    enable(by('path-run'), drives && this.checked?.unreachable.length === 0 && !state.operation && !isTracing(state),
      why || (this.checked ? 'busy, or parts are out of reach' : 'no path yet'));
    enable(by('path-pause'), drives && run?.state === 'running', why || 'no path runs');
    enable(by('path-resume'), drives && run?.state === 'paused', why || 'no path is paused');
    /** @type {HTMLProgressElement} */ (by('path-progress')).value = run ? run.done / Math.max(run.total, 1) : 0;
    const error = run?.error ? `, error ${(run.error.mean * 1000).toFixed(2)} mm on average, ${(run.error.max * 1000).toFixed(2)} mm at most` : '';
    const left = run?.left != null && run.state === 'running' ? `, ${Math.ceil(run.left)} s left` : '';
    say(by('path-progress-text'), run ? `${run.state}: ${run.done} of ${run.total}${left}${error}${run.message ? `: ${run.message}` : ''}` : '');
  }
}
