// A robot as the page sees it: its state, and what can be asked of it.
import { number } from './dom.js';
import { tokenHeaders } from './token.js';

/** @typedef {import('./kinematics.js').Vec} Vec */
/** @typedef {import('./kinematics.js').Machine} Machine */
/** Length of a leg = offset + scale * displacement. @typedef {{ offset: number, scale: number, min?: number | null, max?: number | null }} Arm */
/** As openapi.json has it. @typedef {{ joints: [Vec, Vec, Vec], edge: number, offset: number, arms: [Arm, Arm, Arm] }} Geometry */
/** @typedef {'home' | 'move'} Motion */
/** @typedef {{ id: number, kind: Motion, target: Vec | null, by: string, outcome: string | null, reason: string | null }} Operation */
/** @typedef {Record<string, number | null>} Health */
/**
 * A state as openapi.json has it.
 * @typedef {object} Wire
 * @property {string} name
 * @property {string} link
 * @property {string | null} link_error
 * @property {string} time
 * @property {string} state
 * @property {boolean} stale
 * @property {string | null} reported
 * @property {Vec | null} displacements
 * @property {string[]} end_stops
 * @property {Vec | null} pose
 * @property {Geometry | null} geometry
 * @property {Operation | null} operation
 * @property {{ client: string } | null} driver
 * @property {Health} health
 */

/**
 * @typedef {object} State
 * @property {string} link `connected`, or what it is instead
 * @property {string} linkNote why it is not connected
 * @property {string | null} state of the controller: idle, homing, moving, error
 * @property {boolean} stale whether what is known is from before the connection was lost
 * @property {Vec | null} displacements
 * @property {boolean[]} stops
 * @property {Vec | null} pose
 * @property {Geometry | null} geometry
 * @property {Machine | null} machine
 * @property {[number, number][] | null} limits of the displacements
 * @property {[number, number][] | null} lengths what the legs' lengths are limited to
 * @property {{ text: string, target: Vec | null } | null} operation under way
 * @property {string} failure how the last operation failed, until one succeeds
 * @property {{ name: string, mine: boolean } | null} driver
 * @property {[string, string][]} health
 * @property {PathRun | null} path
 */

/** @typedef {{ state: string, done: number, total: number, left: number | null, error: { mean: number, max: number } | null, message: string }} PathRun */
/** @typedef {{ kind: 'wanted' | 'travel' | 'unreachable', points: Vec[] }} Stroke */
/** @typedef {{ targets: number, length: number, strokes: Stroke[], unreachable: { lines: [number, number], reason: string }[] }} Checked */
/** @typedef {{ points: Vec[], tolerance: number } | { format: string, file: string, tolerance: number, scale: number, plane: { origin: Vec, x: Vec, y: Vec } }} PathRequest */

/**
 * Something that happened, for plot and traffic.
 * @typedef {object} Entry
 * @property {number} time in seconds since 1970
 * @property {Vec | null} [displacements] a report's
 * @property {Vec | null} [pose] a report's
 * @property {string} [event] in words
 * @property {import('./traffic.js').Entry} [traffic]
 * @property {Partial<State>} [state]
 */

/** @type {State} */
export const UNKNOWN = {
  link: 'unknown', linkNote: 'nothing is known yet', state: null, stale: true, displacements: null, stops: [false, false, false], pose: null, geometry: null,
  machine: null, limits: null, lengths: null, operation: null, failure: '', driver: null, health: [], path: null,
};

const ARMS = ['A', 'B', 'C'];

/** How an operation ended. @param {Partial<Operation>} operation */
export const endText = ({ kind, outcome, reason }) => `${kind} ${String(outcome).replace('_', ' ')}${reason ? `: ${reason}` : ''}`;

/** What people read in a state. @param {Wire} wire @param {boolean} mine whether this page drives @returns {State} */
export function stateOf(wire, mine) {
  const { geometry, operation, health } = wire;
  const arms = geometry?.arms ?? [];
  const limits = arms.map(({ min, max }) => (min == null || max == null ? null : /** @type {[number, number]} */ ([min, max])));
  const known = limits.length === 3 && limits.every((limit) => limit !== null) ? limits : null;
  const says = (/** @type {Operation} */ { kind, target }) => (kind === 'home' ? 'homing' : `move to ${target?.map((value) => number(value)).join(' ') ?? '?'}`);
  const failed = operation?.outcome && !['finished', 'cancelled'].includes(operation.outcome);
  return {
    link: wire.link === 'up' ? 'connected' : wire.link,
    linkNote: wire.link_error ?? (wire.link === 'opening' ? 'the port is being opened' : 'the port was lost'),
    state: wire.state === 'unknown' ? null : wire.state,
    stale: wire.stale,
    displacements: wire.displacements,
    stops: ARMS.map((arm) => wire.end_stops.includes(arm)),
    pose: wire.pose,
    geometry,
    machine: geometry && { a1: geometry.joints[0], a2: geometry.joints[1], a3: geometry.joints[2], d_b1b3: geometry.edge, d_e: geometry.offset },
    limits: known,
    lengths: known && known.map((limit, arm) => {
      const [one, other] = limit.map((value) => arms[arm].offset + arms[arm].scale * value);
      return [Math.min(one, other), Math.max(one, other)];
    }),
    operation: operation && operation.outcome === null ? { text: `${says(operation)}, by ${operation.by}`, target: operation.target } : null,
    failure: failed ? `${says(operation)} ${operation.outcome?.replace('_', ' ')}${operation.reason ? `: ${operation.reason}` : ''}` : '',
    driver: wire.driver && { name: wire.driver.client, mine },
    health: [
      ['Round trip', health.round_trip_ms == null ? '?' : `${health.round_trip_ms} ms`], ['Messages', String(health.frames)],
      ['Garbage', `${health.garbage_bytes} bytes`], ['Checksums', `${health.checksum_failures} wrong`],
      ['Repeats', String(health.retransmissions)], ['Timeouts', String(health.timeouts)],
      ['Malformed', String(health.malformed)], ['Reconnects', String(health.reconnects)],
    ],
    path: null,
  };
}

/**
 * Asks the server; throws what it says is wrong.
 * @param {string} method @param {string} path @param {unknown} [body] @param {Record<string, string>} [headers]
 */
export async function ask(method, path, body, headers = {}) {
  const raw = body instanceof Blob;
  const response = await fetch(path, {
    method,
    headers: { ...tokenHeaders(), ...headers, ...(body === undefined ? {} : { 'Content-Type': raw ? 'application/octet-stream' : 'application/json' }) },
    body: raw ? body : body === undefined ? undefined : JSON.stringify(body),
    signal: AbortSignal.timeout(raw ? 120_000 : 20_000),
  }).catch((error) => {
    throw new Error(error.name === 'TimeoutError' ? 'the server does not answer' : 'the server can not be reached');
  });
  const text = await response.text();
  const answer = text.startsWith('{') ? JSON.parse(text) : {};
  if (!response.ok) throw new Error(answer.detail || answer.title || `${response.status} ${response.statusText}`);
  return answer;
}

/** A robot of the server's. */
export class Robot {
  /** @param {string} name @param {import('./connection.js').Connection | null} connection */
  constructor(name, connection) {
    this.name = name;
    this.connection = connection;
    /** @type {State} */
    this.state = UNKNOWN;
    /** The word that shows who drives. */
    this.lease = '';
    /** Where the target of the operation is, by the server's kinematics. @type {Vec | null} */
    this.targetPose = null;
    this.target = '';
    /** The path that runs, or ran last. @type {PathRun | null} */
    this.run = null;
    /** @type {(robot: Robot) => void} */
    this.changed = () => {};
    /** @type {((entry: Entry) => void) | null} */
    this.watcher = null;
  }

  get path() {
    return `/api/robots/${encodeURIComponent(this.name)}`;
  }

  /** @param {string} what @param {unknown} [body] */
  order(what, body) {
    return ask('POST', `${this.path}/${what}`, body, this.lease ? { 'Deltarobot-Lease': this.lease } : {});
  }

  async home() {
    await this.order('home', { wait: false });
  }

  /** @param {Vec} displacements */
  async move(displacements) {
    await this.order('move', { displacements, wait: false });
  }

  /** @param {Vec} position */
  async moveTo(position) {
    await this.order('move', { position, wait: false });
  }

  /** Without a lease, whoever asks. Returns only when the controller has answered. */
  async cancel() {
    const { outcome } = await ask('POST', `${this.path}/cancel`);
    if (outcome === 'refused') throw new Error('the controller refused');
    if (outcome !== 'finished') throw new Error('the controller does not answer');
    return 'Cancelled: the controller has confirmed';
  }

  /** @param {boolean} force whether to take over */
  async take(force) {
    this.connection?.send({ type: 'lease', robot: this.name, client: this.connection.client, force });
  }

  async release() {
    this.connection?.send({ type: 'release', robot: this.name });
  }

  /** @param {Geometry | null} geometry */
  async setGeometry(geometry) {
    await (geometry ? ask('PUT', `${this.path}/geometry`, geometry) : ask('DELETE', `${this.path}/geometry`));
  }

  /** @param {PathRequest} request @returns {Promise<Checked>} */
  checkPath(request) {
    return this.order('path', request);
  }

  /** @param {PathRequest} request */
  async runPath(request) {
    await this.order('path/run', request);
  }

  async pausePath() {
    await this.order('path/pause');
  }

  async resumePath() {
    await this.order('path/resume');
  }

  /** Looks up where the target is, once for each. */
  async findTarget() {
    const { geometry, operation } = this.state;
    const target = operation?.target;
    const wanted = target && geometry ? JSON.stringify([target, geometry]) : '';
    if (wanted === this.target) return;
    this.target = wanted;
    this.targetPose = null;
    if (!wanted) return;
    const { poses } = await ask('POST', '/api/kinematics/forward', { geometry, displacements: [target] });
    if (this.target !== wanted) return;
    this.targetPose = poses[0];
    this.changed(this);
  }

  /** Has what happens shown, messages too. @param {((entry: Entry) => void) | null} watcher */
  watch(watcher) {
    this.watcher = watcher;
    this.connection?.watchMessages(watcher ? this : null);
  }
}
