// A recording, as a robot that only shows what it did: text is decoded by the server, MCAP here; posed by the geometry of
// a robot.
import { trafficOf } from './connection.js';
import { Robot, UNKNOWN, ask } from './robot.js';

/** @typedef {import('./robot.js').Entry} Entry */
/** @typedef {import('./robot.js').State} State */
/** @typedef {import('./kinematics.js').Vec} Vec */
/** What happened to a robot, in the order of time. @typedef {Entry[]} Story */

/** Displacements that the server takes at a time. */
const AT_A_TIME = 10_000;
/** What MCAP files begin with, and text does not. */
const MCAP = 0x89;

/** @param {Blob} file @returns {Promise<{ stories: Map<string, Story>, warning: string }>} */
async function readText(file) {
  const { started, events, damage } = await ask('POST', '/api/recordings', file);
  const began = started ? Date.parse(started) / 1000 : 0;
  /** @type {Story} */
  const story = events.map((/** @type {any} */ event) => {
    const time = began + event.at;
    if (event.type === 'message') return { time, traffic: trafficOf(time, event) };
    return { time, state: { state: event.state, stale: false, displacements: event.displacements, stops: ['A', 'B', 'C'].map((arm) => event.end_stops.includes(arm)) } };
  });
  return { stories: new Map(story.length ? [['', story]] : []), warning: damage ? `Damaged: ${damage}` : '' };
}

export class Recorded {
  constructor() {
    this.robot = new Robot('Recording', null);
    /** @type {State} */
    this.empty = { ...UNKNOWN, link: 'connected', driver: { name: 'A recording', mine: false } };
    /** What the file has, by robots. @type {Map<string, Story>} */
    this.stories = new Map();
    this.reset();
  }

  reset() {
    this.robot.state = { ...this.empty };
    this.robot.changed(this.robot);
  }

  /** @param {File} file @returns {Promise<string>} what could not be read of it */
  async read(file) {
    const [first] = new Uint8Array(await file.slice(0, 1).arrayBuffer());
    const read = first === MCAP ? (await import('./mcap.js')).readMcap : readText;
    const { stories, warning } = await read(file);
    if (stories.size === 0) throw new Error(warning || 'nothing is in it');
    this.stories = stories;
    return warning;
  }

  /**
   * What happened to a robot, with the poses that a geometry gives.
   * @param {string} name @param {State | null} like whose geometry that is
   * @returns {Promise<Story>}
   */
  async story(name, like) {
    const story = this.stories.get(name) ?? [];
    this.empty = { ...this.empty, geometry: like?.geometry ?? null, machine: like?.machine ?? null, limits: like?.limits ?? null, lengths: like?.lengths ?? null };
    const known = story.flatMap(({ state }) => (state?.displacements ? [state.displacements] : []));
    const poses = await this.poses(known);
    let at = 0;
    return story.map((entry) => {
      if (!entry.state) return entry;
      const { stale, displacements } = entry.state;
      return { ...entry, displacements: stale ? null : displacements, state: { ...entry.state, pose: displacements ? poses[at++] : null } };
    });
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
