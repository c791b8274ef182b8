// The platform's geometry, after docs/kinematics.md: what a pose looks like. Poses themselves come from the server.

/** @typedef {[number, number, number]} Vec */
/** @typedef {{ a1: Vec, a2: Vec, a3: Vec, d_b1b3: number, d_e: number }} Machine */

const sum = (/** @type {Vec} */ p, /** @type {Vec} */ q, s = 1) => /** @type {Vec} */ ([p[0] + s * q[0], p[1] + s * q[1], p[2] + s * q[2]]);
const dot = (/** @type {Vec} */ p, /** @type {Vec} */ q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
const cross = (/** @type {Vec} */ p, /** @type {Vec} */ q) =>
  /** @type {Vec} */ ([p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]);
const unit = (/** @type {Vec} */ p) => sum([0, 0, 0], p, 1 / Math.hypot(...p));

/**
 * The platform's joints at a pose and the lengths of the legs; null where the pose does not define them.
 * @param {Machine} machine
 * @param {Vec} e
 * @returns {{ joints: [Vec, Vec, Vec], lengths: Vec } | null}
 */
export function platform(machine, e) {
  const { a1, a2, a3, d_b1b3, d_e } = machine;
  const o = sum([0, 0, 0], sum(a1, a3), 0.5);
  const a = unit(sum(a3, a1, -1));
  const from = sum(e, o, -1);
  const w = unit(sum(from, a, -dot(from, a)));
  let n = cross(w, a);
  if (dot(n, sum(a2, o, -1)) < 0) n = sum([0, 0, 0], n, -1);
  const d = sum(e, a2, -1);
  let [c, s] = [dot(d, w), dot(d, a)];
  if (c < 0) [c, s] = [-c, -s];
  const r = Math.hypot(c, s);
  const u = sum(sum([0, 0, 0], a, c / r), w, -s / r);
  /** @type {[Vec, Vec, Vec]} */
  const joints = [sum(e, u, -d_b1b3 / 2), sum(e, n, d_e), sum(e, u, d_b1b3 / 2)];
  const bases = [a1, a2, a3];
  const lengths = /** @type {Vec} */ (joints.map((joint, leg) => Math.hypot(...sum(joint, bases[leg], -1))));
  return lengths.every(Number.isFinite) ? { joints, lengths } : null;
}

/**
 * The side of the base on which the robot works, as a unit vector.
 * @param {Machine} machine
 */
export function workingSide({ a1, a2, a3 }) {
  return unit(cross(sum(a3, a1, -1), sum(a2, a1, -1)));
}

/**
 * Outlines of what the legs reach between limits of length: closed rings across the working side, for the eye.
 * @param {Machine} machine
 * @param {[number, number][]} limits shortest and longest of each leg
 * @returns {Vec[][]}
 */
export function workspace(machine, limits) {
  const reaches = (/** @type {Vec} */ e) => {
    const there = platform(machine, e);
    return there !== null && there.lengths.every((length, leg) => length >= limits[leg][0] && length <= limits[leg][1]);
  };
  const side = workingSide(machine);
  const middle = sum([0, 0, 0], sum(sum(machine.a1, machine.a2), machine.a3), 1 / 3);
  const x = unit(sum(machine.a3, machine.a1, -1));
  const y = cross(side, x);
  const longest = Math.max(...limits.map((limit) => limit[1]));
  /** @type {Vec[][]} */
  const rings = [];
  for (let level = 1; level <= 12; level += 1) {
    const centre = sum(middle, side, (longest * level) / 12);
    if (!reaches(centre)) continue;
    rings.push(Array.from({ length: 48 }, (_, step) => {
      const way = sum(sum([0, 0, 0], x, Math.cos(step * Math.PI / 24)), y, Math.sin(step * Math.PI / 24));
      let [near, far] = [0, longest];
      for (let halving = 0; halving < 16; halving += 1) {
        const half = (near + far) / 2;
        if (reaches(sum(centre, way, half))) near = half; else far = half;
      }
      return sum(centre, way, near);
    }));
  }
  return rings;
}
