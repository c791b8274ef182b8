// A plane in the machine's space, on which a path is drawn with a mouse, a pen or a finger.
import * as three from './vendor/three.js';
import { dispose, path } from './scene.js';
import { workingSide } from './kinematics.js';

/** @typedef {import('./kinematics.js').Vec} Vec */
/** The plane's middle and two unit vectors in it. @typedef {{ middle: Vec, x: Vec, y: Vec }} Placed */

export class Drawing {
  /** @param {import('./scene.js').MachineScene} scene @param {(points: Vec[]) => void} done with what was drawn */
  constructor(scene, done) {
    this.scene = scene;
    this.done = done;
    this.group = new three.Group();
    scene.scene.add(this.group);
    this.active = false;
    /** @type {Vec[] | null} */
    this.points = null;
    /** @type {Placed | null} */
    this.placed = null;
    const canvas = scene.renderer.domElement;
    canvas.addEventListener('pointerdown', (event) => this.begin(event));
    canvas.addEventListener('pointermove', (event) => this.extend(event));
    canvas.addEventListener('pointerup', (event) => { if (event.isPrimary) this.end(true); });
    // The system has taken the pointer, for a gesture of its own.
    canvas.addEventListener('pointercancel', () => this.end(false));
  }

  /**
   * Places the plane across the working side.
   * @param {Vec} middle
   * @param {number} tiltX in degrees, about its first direction
   * @param {number} tiltY about its second one
   */
  place(middle, tiltX, tiltY) {
    const machine = this.scene.machine;
    if (!machine) return;
    const side = new three.Vector3(...workingSide(machine));
    const x = new three.Vector3(...machine.a3).sub(new three.Vector3(...machine.a1)).normalize();
    const y = new three.Vector3().crossVectors(x, side).normalize();
    const turn = new three.Quaternion().setFromAxisAngle(x, tiltX * Math.PI / 180)
      .multiply(new three.Quaternion().setFromAxisAngle(y, tiltY * Math.PI / 180));
    [x, y].forEach((axis) => axis.applyQuaternion(turn));
    this.placed = { middle, x: /** @type {Vec} */ (x.toArray()), y: /** @type {Vec} */ (y.toArray()) };
    this.normal = new three.Vector3().crossVectors(x, y);
    dispose(this.group);
    const grid = new three.GridHelper(this.scene.size * 3, 12, 0x8899aa, 0x8899aa);
    grid.material.transparent = true;
    grid.material.opacity = 0.35;
    grid.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), this.normal);
    grid.position.set(...middle);
    this.group.add(grid);
    this.scene.wanted = true;
  }

  /** @param {boolean} shown */
  show(shown) {
    this.group.visible = shown;
    this.scene.wanted = true;
  }

  /** @param {boolean} active whether the pointer draws instead of turning the view */
  arm(active) {
    this.active = active;
    this.scene.controls.enabled = !active;
    this.scene.renderer.domElement.style.cursor = active ? 'crosshair' : '';
  }

  /** Where a pointer meets the plane. @param {PointerEvent} event @returns {Vec | null} */
  hit({ clientX, clientY }) {
    if (!this.placed || !this.normal) return null;
    const box = this.scene.parent.getBoundingClientRect();
    const at = new three.Vector2((clientX - box.left) / box.width * 2 - 1, 1 - (clientY - box.top) / box.height * 2);
    const ray = new three.Raycaster();
    ray.setFromCamera(at, this.scene.camera);
    const plane = new three.Plane().setFromNormalAndCoplanarPoint(this.normal, new three.Vector3(...this.placed.middle));
    const point = ray.ray.intersectPlane(plane, new three.Vector3());
    // Close to the horizon a pixel is metres.
    return point && point.distanceTo(new three.Vector3(...this.placed.middle)) < this.scene.size * 6 ? /** @type {Vec} */ (point.toArray()) : null;
  }

  /** @param {PointerEvent} event */
  begin(event) {
    if (!this.active || !event.isPrimary) return;
    this.scene.renderer.domElement.setPointerCapture(event.pointerId);
    this.points = [];
    this.extend(event);
  }

  /** @param {PointerEvent} event */
  extend(event) {
    if (!this.points || !event.isPrimary || this.points.length >= 5000) return;
    for (const each of event.getCoalescedEvents?.() ?? [event]) {
      const point = this.hit(each);
      if (point) this.points.push(point);
    }
    if (!this.line) {
      this.line = new three.Line(path([]), new three.LineBasicMaterial({ color: 0x0072b2 }));
      this.line.frustumCulled = false;
      this.group.add(this.line);
    }
    this.line.geometry.dispose();
    this.line.geometry = path(this.points);
    this.scene.wanted = true;
  }

  /** @param {boolean} isDone whether that was meant as the end */
  end(isDone) {
    const points = this.points;
    this.points = null;
    if (this.line) {
      this.line.geometry.dispose();
      this.line.removeFromParent();
      this.line = undefined;
    }
    if (isDone && points && points.length > 1) this.done(points);
  }
}
