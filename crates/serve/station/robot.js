// A robot as the page sees it: its state, and what can be asked of it.

/** @typedef {import('./kinematics.js').Vec} Vec */
/** @typedef {import('./kinematics.js').Machine} Machine */
/** @typedef {Machine & { scale: Vec, offset: Vec, min?: Vec, max?: Vec }} Geometry length in metres = offset + scale * displacement */

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
 * @property {{ text: string, pose: Vec | null } | null} operation under way
 * @property {string} failure how the last operation failed, until one succeeds
 * @property {{ name: string, mine: boolean } | null} driver
 * @property {[string, string][]} health
 * @property {PathRun | null} path
 */

/** @typedef {{ state: string, done: number, total: number, left: number | null, error: { rms: number, max: number } | null, message: string }} PathRun */
/** @typedef {{ kind: 'wanted' | 'travel' | 'unreachable', points: Vec[] }} Stroke */
/** @typedef {{ targets: number, length: number, strokes: Stroke[], unreachable: { line: number | null, reason: string }[] }} Checked */
/** @typedef {{ points: Vec[], tolerance: number } | { format: string, file: string, tolerance: number, scale: number, plane: { origin: Vec, x: Vec, y: Vec } }} PathRequest */

/**
 * Something that happened, for plot and traffic.
 * @typedef {object} Entry
 * @property {number} time in seconds since 1970
 * @property {Vec | null} [displacements] a report's
 * @property {string} [event] in words
 * @property {import('./traffic.js').Entry} [traffic]
 * @property {Partial<State>} [state]
 */

/** @type {State} */
export const UNKNOWN = {
  link: 'unknown', linkNote: 'nothing is known yet', state: null, stale: true, displacements: null, stops: [false, false, false], pose: null, geometry: null,
  machine: null, limits: null, lengths: null, operation: null, failure: '', driver: null, health: [], path: null,
};
