// A recording, as a robot that only shows what it did: decoded by the server, posed by the geometry of a robot.
import { trafficOf } from './connection.js';
import { Robot, UNKNOWN, ask } from './robot.js';

/** @typedef {import('./robot.js').Entry} Entry */
/** @typedef {import('./robot.js').Geometry} Geometry */
/** @typedef {import('./kinematics.js').Vec} Vec */

/** Displacements that the server takes at a time. */
const AT_A_TIME = 10_000;

export class Recorded {
  constructor() {
    this.robot = new Robot('Recording', null);
    /** @type {import('./robot.js').State} */
    this.empty = { ...UNKNOWN, link: 'connected', driver: { name: 'A recording', mine: false } };
    this.reset();
  }

  reset() {
    this.robot.state = { ...this.empty };
    this.robot.changed(this.robot);
  }

  /** @param {File} file @param {import('./robot.js').State | null} like whose geometry is taken @returns {Promise<Entry[]>} */
  async read(file, like) {
    const recording = await ask('POST', '/api/recordings', file);
    this.empty = { ...this.empty, geometry: like?.geometry ?? null, machine: like?.machine ?? null, limits: like?.limits ?? null, lengths: like?.lengths ?? null };
    const began = recording.started ? Date.parse(recording.started) / 1000 : 0;
    /** @type {Vec[]} */
    const known = recording.events.flatMap((/** @type {any} */ event) => (event.type === 'state' && event.displacements ? [event.displacements] : []));
    const poses = await this.poses(known);
    let at = 0;
    /** @type {Entry[]} */
    const entries = recording.events.map((/** @type {any} */ event) => {
      const time = began + event.at;
      if (event.type === 'message') return { time, traffic: trafficOf(time, event) };
      const pose = event.displacements ? poses[at++] : null;
      return { time, displacements: event.displacements, state: { state: event.state, stale: false, displacements: event.displacements, pose, stops: ['A', 'B', 'C'].map((arm) => event.end_stops.includes(arm)) } };
    });
    if (recording.damage) entries.unshift({ time: entries[0]?.time ?? began, event: `damaged: ${recording.damage}` });
    if (!entries.length) throw new Error('nothing is in it');
    return entries;
  }

  /** @param {Vec[]} displacements @returns {Promise<(Vec | null)[]>} */
  async poses(displacements) {
    const { geometry } = this.empty;
    if (!geometry) return displacements.map(() => null);
    const poses = [];
    for (let from = 0; from < displacements.length; from += AT_A_TIME) {
      const answer = await ask('POST', '/api/kinematics/forward', { geometry, displacements: displacements.slice(from, from + AT_A_TIME) });
      poses.push(...answer.poses);
    }
    return poses;
  }

  /** @param {Entry[]} entries */
  feed(entries) {
    const last = entries.findLast((entry) => entry.state);
    if (!last) return;
    this.robot.state = { ...this.robot.state, ...last.state };
    this.robot.changed(this.robot);
  }
}
