// The machine in three dimensions. It draws what it is given; it knows no robot and no connection.
import * as three from './vendor/three.js';
import { platform, workingSide, workspace } from './kinematics.js';

/** @typedef {import('./kinematics.js').Vec} Vec */
/** @typedef {import('./kinematics.js').Machine} Machine */

const ARMS = [0x0072b2, 0xe69f00, 0x009e73];
/** Of some minutes: a robot that moves has 25 a second at most. */
const TRACE_POINTS = 10_000;

/** A tube between two points. */
class Tube {
  /** @param {number} radius @param {three.MeshStandardMaterial | three.MeshBasicMaterial} material */
  constructor(radius, material) {
    this.mesh = new three.Mesh(new three.CylinderGeometry(radius, radius, 1, 16), material);
  }

  /** @param {three.Vector3} from @param {three.Vector3} to */
  span(from, to) {
    const way = to.clone().sub(from);
    this.mesh.position.copy(from).addScaledVector(way, 0.5);
    this.mesh.scale.y = way.length() || 1e-9;
    this.mesh.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), way.normalize());
  }
}

/** Legs and platform at one pose: the robot itself, or the ghost of its target. */
class Moving {
  /** @param {number} size of the machine @param {boolean} ghost */
  constructor(size, ghost) {
    this.group = new three.Group();
    const material = (/** @type {number} */ color) => ghost
      ? new three.MeshBasicMaterial({ color: 0x8899aa, transparent: true, opacity: 0.35, depthWrite: false })
      : new three.MeshStandardMaterial({ color, roughness: 0.5 });
    this.outer = ARMS.map((color) => new Tube(size * 0.035, material(color)));
    this.inner = ARMS.map(() => new Tube(size * 0.018, material(0xb5bcc2)));
    this.edges = ARMS.map(() => new Tube(size * 0.02, material(0x59636b)));
    this.tool = new three.Mesh(new three.SphereGeometry(size * 0.05, 20, 12), material(0xd55e00));
    this.group.add(...[...this.outer, ...this.inner, ...this.edges].map((tube) => tube.mesh), this.tool);
  }

  /** @param {Machine} machine @param {Vec} pose */
  place(machine, pose) {
    const there = platform(machine, pose);
    this.group.visible = there !== null;
    if (there === null) return;
    const joints = there.joints.map((joint) => new three.Vector3(...joint));
    [machine.a1, machine.a2, machine.a3].forEach((base, leg) => {
      const from = new three.Vector3(...base);
      this.outer[leg].span(from, from.clone().lerp(joints[leg], 0.55));
      this.inner[leg].span(from, joints[leg]);
      this.edges[leg].span(joints[leg], joints[(leg + 1) % 3]);
    });
    this.tool.position.set(...pose);
  }
}

export class MachineScene {
  /** @param {HTMLElement} parent */
  constructor(parent) {
    this.parent = parent;
    this.scene = new three.Scene();
    this.camera = new three.PerspectiveCamera(40, 1, 0.001, 1000);
    this.renderer = new three.WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    parent.append(this.renderer.domElement);
    this.lights = new three.Group();
    const sun = new three.DirectionalLight(0xffffff, 2.2);
    sun.position.set(1, 2, 3);
    this.lights.add(new three.AmbientLight(0xffffff, 1.4), sun);
    this.camera.add(this.lights);
    this.scene.add(this.camera);
    /** @type {Machine | null} */
    this.machine = null;
    /** @type {Vec | null} */
    this.pose = null;
    this.size = 1;
    this.depth = 1;
    this.body = new three.Group();
    /** What other modules draw, in the machine's coordinates. */
    this.overlay = new three.Group();
    this.scene.add(this.body, this.overlay);
    this.stops = /** @type {three.Mesh[]} */ ([]);
    this.controls = this.orbit();
    this.tracePoints = new Float32Array(TRACE_POINTS * 3);
    this.traceCount = 0;
    this.wanted = true;
    new ResizeObserver(() => this.resize()).observe(parent);
    this.resize();
    this.renderer.setAnimationLoop(() => this.frame());
  }

  orbit() {
    const controls = new three.OrbitControls(this.camera, this.renderer.domElement);
    controls.addEventListener('change', () => { this.wanted = true; });
    return controls;
  }

  /** Draws only when something has changed. */
  frame() {
    this.controls.update();
    if (!this.wanted || !this.parent.clientWidth) return;
    this.wanted = false;
    this.renderer.render(this.scene, this.camera);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.parent;
    if (!width || !height) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.wanted = true;
  }

  /**
   * Builds the machine anew, or removes it.
   * @param {Machine | null} machine
   * @param {[number, number][] | null} limits of the legs' lengths
   */
  setMachine(machine, limits) {
    dispose(this.body);
    this.machine = machine;
    this.pose = null;
    this.stops = [];
    this.clearTrace();
    this.wanted = true;
    if (machine === null) return;
    const bases = [machine.a1, machine.a2, machine.a3].map((base) => new three.Vector3(...base));
    const middle = bases[0].clone().add(bases[1]).add(bases[2]).divideScalar(3);
    this.size = Math.max(...bases.map((base) => base.distanceTo(middle)));
    this.depth = limits ? Math.max(...limits.map((limit) => limit[1])) : this.size * 2.4;
    bases.forEach((base, leg) => {
      const edge = new Tube(this.size * 0.03, new three.MeshStandardMaterial({ color: 0x6f7a83 }));
      edge.span(base, bases[(leg + 1) % 3]);
      const joint = new three.Mesh(new three.SphereGeometry(this.size * 0.07, 24, 16), new three.MeshStandardMaterial({ color: ARMS[leg] }));
      joint.position.copy(base);
      const stop = new three.Mesh(new three.SphereGeometry(this.size * 0.11, 24, 16), new three.MeshBasicMaterial({ color: 0xd55e00, transparent: true, opacity: 0.75 }));
      stop.position.copy(base);
      stop.visible = false;
      this.stops.push(stop);
      this.body.add(edge.mesh, joint, stop, label('ABC'[leg], base.clone().lerp(middle, -0.25), this.size * 0.22));
    });
    for (const ring of limits ? workspace(machine, limits) : []) {
      this.body.add(new three.LineLoop(path(ring), new three.LineBasicMaterial({ color: 0x7f8c96, transparent: true, opacity: 0.45 })));
    }
    this.robot = new Moving(this.size, false);
    this.ghost = new Moving(this.size, true);
    this.robot.group.visible = this.ghost.group.visible = false;
    const geometry = new three.BufferGeometry();
    geometry.setAttribute('position', new three.BufferAttribute(this.tracePoints, 3));
    geometry.setDrawRange(0, 0);
    this.trace = new three.Line(geometry, new three.LineBasicMaterial({ color: 0xcc79a7 }));
    this.trace.frustumCulled = false;
    this.body.add(this.robot.group, this.ghost.group, this.trace);
    this.resetView();
  }

  /** Looks at the machine from the front, its working side down. */
  resetView() {
    if (this.machine === null) return;
    const side = new three.Vector3(...workingSide(this.machine));
    const bases = [this.machine.a1, this.machine.a2, this.machine.a3].map((base) => new three.Vector3(...base));
    const middle = bases[0].clone().add(bases[1]).add(bases[2]).divideScalar(3).addScaledVector(side, this.depth / 2);
    const across = bases[2].clone().sub(bases[0]).normalize();
    const front = new three.Vector3().crossVectors(side, across);
    const away = Math.max(this.depth, this.size * 2) * 2;
    this.controls.dispose();
    this.camera.up.copy(side).negate();
    this.camera.near = this.size / 100;
    this.camera.far = this.size * 100;
    this.camera.position.copy(middle).addScaledVector(front, away * 0.75).addScaledVector(across, -away * 0.5).addScaledVector(side, -away * 0.45);
    this.camera.updateProjectionMatrix();
    this.controls = this.orbit();
    this.controls.target.copy(middle);
    this.controls.update();
    this.wanted = true;
  }

  /**
   * @param {Vec | null} pose of the robot: null while nobody knows it
   * @param {Vec | null} target
   */
  setPose(pose, target) {
    if (this.machine === null || !this.robot || !this.ghost) return;
    const moved = pose?.some((value, axis) => value !== this.pose?.[axis]);
    this.pose = pose;
    if (pose) this.robot.place(this.machine, pose); else this.robot.group.visible = false;
    if (target) this.ghost.place(this.machine, target); else this.ghost.group.visible = false;
    if (pose && moved) this.addTrace(pose);
    this.wanted = true;
  }

  /** @param {Vec} pose */
  addTrace(pose) {
    if (this.traceCount === TRACE_POINTS) {
      // A tenth at a time: shifting at each point would cost more than drawing.
      this.tracePoints.copyWithin(0, TRACE_POINTS * 3 / 10);
      this.traceCount -= TRACE_POINTS / 10;
    }
    this.tracePoints.set(pose, this.traceCount * 3);
    this.traceCount += 1;
    if (!this.trace) return;
    this.trace.geometry.setDrawRange(0, this.traceCount);
    this.trace.geometry.attributes.position.needsUpdate = true;
  }

  clearTrace() {
    this.traceCount = 0;
    this.trace?.geometry.setDrawRange(0, 0);
    this.wanted = true;
  }

  /** @param {boolean[]} pressed */
  setStops(pressed) {
    this.stops.forEach((stop, arm) => { stop.visible = pressed[arm] === true; });
    this.wanted = true;
  }

  /**
   * Where a point of the machine is on the page.
   * @param {Vec} point
   */
  project(point) {
    this.camera.updateMatrixWorld();
    const { x, y } = new three.Vector3(...point).project(this.camera);
    const box = this.parent.getBoundingClientRect();
    return { x: box.left + (x + 1) / 2 * box.width, y: box.top + (1 - y) / 2 * box.height };
  }

  /** What is drawn where, in pixels of the page: for the tests, and for whoever looks for an error. */
  drawn() {
    const at = (/** @type {three.Object3D} */ object) => this.project(/** @type {Vec} */ (object.getWorldPosition(new three.Vector3()).toArray()));
    return {
      robot: this.robot?.group.visible ? { tool: at(this.robot.tool), pose: this.robot.tool.position.toArray() } : null,
      ghost: this.ghost?.group.visible ? { tool: at(this.ghost.tool), pose: this.ghost.tool.position.toArray() } : null,
      stops: this.stops.map((stop) => stop.visible),
      trace: this.traceCount,
    };
  }
}

/** @param {Vec[]} points */
export function path(points) {
  const geometry = new three.BufferGeometry();
  geometry.setAttribute('position', new three.BufferAttribute(new Float32Array(points.flat()), 3));
  return geometry;
}

/** Empties a group and frees what it held. @param {three.Group} group */
export function dispose(group) {
  group.traverse((object) => {
    const { geometry, material } = /** @type {three.Mesh<three.BufferGeometry, three.SpriteMaterial>} */ (object);
    geometry?.dispose();
    material?.map?.dispose();
    material?.dispose();
  });
  group.clear();
}

/** @param {string} text @param {three.Vector3} at @param {number} size */
function label(text, at, size) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 64;
  const context = canvas.getContext('2d');
  if (context) {
    context.fillStyle = '#6f7a83';
    context.font = 'bold 48px sans-serif';
    context.textAlign = 'center';
    context.fillText(text, 32, 50);
  }
  const map = new three.CanvasTexture(canvas);
  map.colorSpace = 'srgb';
  const sprite = new three.Sprite(new three.SpriteMaterial({ map }));
  sprite.position.copy(at);
  sprite.scale.setScalar(size);
  return sprite;
}
