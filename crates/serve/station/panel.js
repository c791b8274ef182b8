// State, position, target fields and link of one robot.
import { by, enable, make, number, say, select, usable } from './dom.js';
import { Jog } from './jog.js';

/** @typedef {import('./robot.js').Robot} Robot */
/** @typedef {import('./robot.js').State} State */

const AXES = ['X', 'Y', 'Z'];
const ARMS = ['A', 'B', 'C'];

/** What is shown in large: one word, and what a style sheet colours it by. @param {State} state @returns {[string, string]} */
export function headline(state) {
  if (state.link !== 'connected') return ['NO CONNECTION', 'lost'];
  if (state.state === null) return ['NO REPORT YET', 'lost'];
  return [state.state.toUpperCase(), state.state];
}

/** Whether a path runs or is paused. @param {State} state */
export const isTracing = ({ path }) => path !== null && ['running', 'paused'].includes(path.state);

/** What a person should know beside the state. @param {State} state */
export function note(state) {
  if (state.link !== 'connected') return state.linkNote;
  const path = isTracing(state) ? `path ${state.path?.state}: ${state.path?.done} of ${state.path?.total}` : '';
  const doing = state.operation ? `${state.operation.text}` : '';
  const stops = ARMS.filter((_, arm) => state.stops[arm]).map((arm) => `end stop ${arm} pressed`);
  const unknown = state.displacements === null && state.state === 'idle' ? ['position unknown: home first'] : [];
  return [path, doing, ...stops, ...unknown].filter(Boolean).join(' · ');
}

export class Panel {
  /** @param {() => Robot | null} robot */
  constructor(robot) {
    this.robot = robot;
    this.cells = ARMS.map((arm, index) => {
      const value = make('td', {}, '?');
      const stop = make('span', { class: 'stop' }, 'clear');
      by('where').querySelector('tbody')?.append(make('tr', {}, make('th', { scope: 'row', class: 'arm', 'data-arm': String(index) }, arm), value, make('td', {}, stop)));
      return { value, stop };
    });
    this.fields = ARMS.map((_, index) => {
      const field = make('input', { type: 'text', inputmode: 'decimal', autocomplete: 'off', 'aria-describedby': 'move-note', id: `target-${index}` });
      const name = make('span', {}, ARMS[index]);
      by('fields').append(make('label', {}, name, field));
      field.addEventListener('input', () => this.check());
      return { field, name };
    });
    select('move-kind').addEventListener('change', () => this.changeKind());
    by('move').addEventListener('submit', (event) => {
      event.preventDefault();
      this.go();
    });
    by('home').addEventListener('click', () => { if (usable(by('home'))) this.ask('Home', (robot) => robot.home()); });
    by('drive').addEventListener('click', () => this.drive());
    /** The limits that the note beside the fields has. */
    this.limits = '';
    this.jog = new Jog((kind, index, step) => this.step(kind, index, step));
  }

  get kind() {
    return select('move-kind').value === 'axes' ? 'axes' : 'arms';
  }

  changeKind() {
    this.fields.forEach(({ field, name }, index) => {
      field.value = '';
      name.textContent = this.kind === 'arms' ? ARMS[index] : `${AXES[index]} (m)`;
    });
    this.check();
  }

  /** The target in the fields, or why there is none. @returns {{ values: [number, number, number] } | { why: string, bad: boolean[] }} */
  target() {
    const texts = this.fields.map(({ field }) => field.value.trim().replace(',', '.'));
    const values = texts.map((text) => (text === '' ? NaN : Number(text)));
    const names = this.kind === 'arms' ? ARMS : AXES;
    const limits = this.kind === 'arms' ? this.robot()?.state?.limits ?? null : null;
    const wrong = values.map((value, index) => {
      if (texts[index] === '') return '';
      if (!Number.isFinite(value)) return `${names[index]}: not a number`;
      const limit = limits?.[index];
      return limit && (value < limit[0] || value > limit[1]) ? `${names[index]}: from ${limit[0]} to ${limit[1]}` : '';
    });
    const why = wrong.find(Boolean);
    if (why) return { why, bad: wrong.map(Boolean) };
    if (texts.includes('')) return { why: '', bad: [false, false, false] };
    return { values: /** @type {[number, number, number]} */ (values) };
  }

  check() {
    const target = this.target();
    this.fields.forEach(({ field }, index) => field.setAttribute('aria-invalid', String('bad' in target && target.bad[index])));
    const limits = this.robot()?.state?.limits;
    const units = this.kind === 'axes' ? 'metres, in the frame of the geometry'
      : `controller units${limits ? `: ${limits.map(([low, high], arm) => `${ARMS[arm]} ${low} to ${high}`).join(', ')}` : ''}`;
    this.noteMove('why' in target && target.why ? target.why : units, 'why' in target && target.why !== '');
    this.update();
  }

  /** @param {string} text @param {boolean} bad */
  noteMove(text, bad) {
    by('move-note').className = bad ? 'bad' : '';
    say(by('move-note'), text);
  }

  go() {
    const target = this.target();
    if (!usable(by('move-go')) || 'why' in target) {
      if ('why' in target) this.noteMove(target.why || 'three numbers are needed', true);
      return;
    }
    this.ask('Move', (robot) => this.kind === 'arms' ? robot.move(target.values) : robot.moveTo(target.values));
  }

  /** @param {'arms' | 'axes'} kind @param {number} index @param {number} step */
  step(kind, index, step) {
    const state = this.robot()?.state;
    const from = kind === 'arms' ? state?.displacements : state?.pose;
    if (!from) return;
    const to = /** @type {[number, number, number]} */ (from.map((value, at) => (at === index ? value + step : value)));
    const limit = kind === 'arms' ? state?.limits?.[index] : undefined;
    // At the edge of its travel a step goes as far as it may.
    if (limit) to[index] = Math.min(Math.max(to[index], limit[0]), limit[1]);
    this.ask('Jog', (robot) => kind === 'arms' ? robot.move(to) : robot.moveTo(to));
  }

  /** @param {string} what @param {(robot: Robot) => Promise<void>} act */
  async ask(what, act) {
    const robot = this.robot();
    if (!robot) return;
    try {
      this.noteMove(`${what}: sent`, false);
      await act(robot);
      this.noteMove(`${what}: accepted`, false);
    } catch (error) {
      this.noteMove(`${what}: ${error instanceof Error ? error.message : error}`, true);
    }
  }

  async drive() {
    const robot = this.robot();
    const state = robot?.state;
    if (!robot || !state) return;
    try {
      if (state.driver?.mine) await robot.release();
      else await robot.take(state.driver !== null);
    } catch (error) {
      this.noteMove(error instanceof Error ? error.message : String(error), true);
    }
  }

  /** Why it can't be moved now: empty when it can. @param {State} state */
  whyNot(state) {
    if (!state.driver?.mine) return state.driver ? `${state.driver.name} drives` : 'take control first';
    if (state.link !== 'connected') return 'not connected';
    return state.operation ? `busy: ${state.operation.text}` : '';
  }

  update() {
    const state = this.robot()?.state;
    if (!state) return;
    const limits = JSON.stringify(state.limits);
    if (limits !== this.limits) {
      this.limits = limits;
      this.check();
    }
    const [word, look] = headline(state);
    say(by('state'), word);
    by('state').dataset.state = look;
    say(by('state-note'), note(state));
    const isRecording = this.robot()?.connection === null;
    say(by('driver'), isRecording ? 'A recording: nothing here is driven'
      : state.driver ? (state.driver.mine ? 'You drive' : `${state.driver.name} drives: you watch`) : 'Nobody drives');
    by('drive').hidden = isRecording;
    say(by('drive'), state.driver ? (state.driver.mine ? 'Give back' : 'Take over') : 'Take control');
    this.cells.forEach(({ value, stop }, arm) => {
      say(value, number(state.displacements?.[arm]));
      say(stop, state.stops[arm] ? 'PRESSED' : 'clear');
      stop.toggleAttribute('data-pressed', state.stops[arm] === true);
    });
    say(by('cartesian'), state.pose ? AXES.map((axis, at) => `${axis} ${number((state.pose?.[at] ?? NaN) * 1000, 1)}`).join('  ') + ' mm'
      : state.machine ? 'No Cartesian position: the displacements are unknown, or no pose has them' : 'No Cartesian position: the geometry is not set');
    const why = this.whyNot(state);
    enable(by('home'), why === '', why);
    enable(by('move-go'), why === '' && 'values' in this.target(), why || 'three valid numbers are needed');
    this.jog.enable(why || (state.displacements ? '' : 'position unknown: home first'), why || (state.pose ? '' : 'no Cartesian position'));
    this.health(state);
  }

  /** @param {State} state */
  health(state) {
    const list = by('health');
    while (list.children.length > state.health.length * 2) list.lastElementChild?.remove();
    state.health.forEach(([name, value], at) => {
      if (!list.children[at * 2]) list.append(make('dt'), make('dd'));
      say(list.children[at * 2], name);
      say(list.children[at * 2 + 1], value);
    });
  }
}
