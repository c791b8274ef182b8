// All robots at a glance: what needs a person first stands first.
import { by, make, number, say } from './dom.js';
import { headline, note } from './panel.js';

/** @typedef {import('./robot.js').Robot} Robot */
/** @typedef {import('./robot.js').State} State */

/** Ranks of need; a smaller one is more urgent. @param {State} state @returns {[number, 'now' | 'soon' | 'busy' | 'no', string]} */
export function need(state) {
  if (state.state === 'error') return [0, 'now', 'Needs a person: controller in error'];
  if (state.link !== 'connected') return [1, 'now', 'Needs a person: no connection'];
  if (state.failure) return [2, 'now', `Needs a person: ${state.failure}`];
  if (state.stops.includes(true)) return [3, 'soon', 'On an end stop'];
  if (state.state === 'idle' && state.displacements === null) return [4, 'soon', 'Needs homing'];
  if (state.path?.state === 'paused') return [4, 'soon', 'Its path is paused'];
  if (state.operation || state.state !== 'idle') return [5, 'busy', 'Busy'];
  return [6, 'no', 'Ready'];
}

export class Fleet {
  constructor() {
    /** @type {Map<string, { tile: HTMLElement, link: HTMLElement, state: HTMLElement, need: HTMLElement, note: HTMLElement, where: HTMLElement }>} */
    this.tiles = new Map();
    this.due = false;
  }

  /** @param {Iterable<Robot>} robots */
  updateSoon(robots) {
    if (this.due) return;
    this.due = true;
    setTimeout(() => {
      this.due = false;
      if (!by('fleet').hidden) this.update([...robots]);
    }, 250);
  }

  /** @param {Robot[]} robots */
  update(robots) {
    const sorted = robots.map((robot) => ({ robot, rank: need(robot.state) }))
      .sort((one, other) => one.rank[0] - other.rank[0] || one.robot.name.localeCompare(other.robot.name, undefined, { numeric: true }));
    const urgent = sorted.filter(({ rank }) => rank[1] === 'now').length;
    say(by('fleet-note'), robots.length === 0 ? 'No robot is known yet' : `${robots.length} robots, ${urgent === 0 ? 'none needs a person' : `${urgent} need${urgent === 1 ? 's' : ''} a person`}`);
    const list = by('tiles');
    sorted.forEach(({ robot, rank: [, look, text] }, at) => {
      const { tile, ...parts } = this.tile(robot.name);
      tile.dataset.needs = look;
      say(parts.state, headline(robot.state)[0]);
      say(parts.need, text);
      say(parts.note, note(robot.state));
      const where = robot.state.displacements?.map((value, arm) => `${'ABC'[arm]} ${number(value)}`).join('  ') ?? 'position unknown';
      const driver = robot.state.driver ? (robot.state.driver.mine ? 'you drive' : `${robot.state.driver.name} drives`) : 'nobody drives';
      say(parts.where, `${where} · ${driver}`);
      // Moved only where the order has changed: the tile that has the focus keeps it.
      if (list.children[at] !== tile) list.insertBefore(tile, list.children[at] ?? null);
    });
    for (const [name, { tile }] of this.tiles) {
      if (robots.some((robot) => robot.name === name)) continue;
      tile.remove();
      this.tiles.delete(name);
    }
  }

  /** @param {string} name */
  tile(name) {
    const known = this.tiles.get(name);
    if (known) return known;
    const parts = {
      link: make('a', { href: `#/robot/${encodeURIComponent(name)}` }, name), state: make('p', { class: 'state' }),
      need: make('p'), note: make('p', { class: 'soft' }), where: make('p', { class: 'soft' }),
    };
    const made = { tile: make('li', {}, parts.link, parts.state, parts.need, parts.note, parts.where), ...parts };
    this.tiles.set(name, made);
    return made;
  }
}
