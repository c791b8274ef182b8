// The server: states of all robots over one WebSocket, which also holds the leases; messages of one over another.
import { Robot, UNKNOWN, endText, stateOf } from './robot.js';
import { askToken, tokenHeaders, tokenProtocols } from './token.js';

/** @typedef {import('./robot.js').Wire} Wire */

const seconds = (/** @type {string} */ time) => Date.parse(time) / 1000;

/** @param {string} path */
function socket(path) {
  const url = new URL(path, location.href);
  url.protocol = url.protocol.replace('http', 'ws');
  return new WebSocket(url, tokenProtocols());
}

/** Whether the server wants another token: a WebSocket is not told why it is refused. */
async function isRefused() {
  const answer = await fetch('/api/robots', { method: 'HEAD', headers: tokenHeaders() }).catch(() => null);
  return answer?.status === 401;
}

export class Connection {
  constructor() {
    /** @type {Map<string, Robot>} */
    this.robots = new Map();
    /** How others see who drives: one of its own for each page. */
    this.client = `station ${crypto.getRandomValues(new Uint16Array(1))[0].toString(16).padStart(4, '0')}`;
    this.onRobots = () => {};
    /** @type {(robot: Robot) => void} */
    this.onUpdate = () => {};
    /** @type {(text: string, bad: boolean) => void} */
    this.onLink = () => {};
    /** What the server has refused. @type {(text: string) => void} */
    this.onRefused = () => {};
    this.wait = 250;
    /** The robot whose messages are wanted. @type {Robot | null} */
    this.watched = null;
    this.lost = 0;
  }

  open() {
    this.events = socket('/api/events');
    this.events.addEventListener('open', () => {
      this.wait = 250;
      this.onLink('Connected', false);
    });
    this.events.addEventListener('message', ({ data }) => this.receive(JSON.parse(data)));
    this.events.addEventListener('close', async () => {
      this.onLink('No connection to the server: trying again', true);
      for (const robot of this.robots.values()) {
        // The lease has ended with its connection.
        robot.lease = '';
        robot.state = { ...robot.state, link: UNKNOWN.link, linkNote: 'no connection to the server', state: null, stale: true, driver: null, operation: null };
        robot.changed(robot);
      }
      if (await isRefused()) {
        this.onLink('The server asks for a token', true);
        await askToken();
      } else {
        await new Promise((resolve) => setTimeout(resolve, this.wait));
        this.wait = Math.min(this.wait * 2, 5000);
      }
      this.open();
    });
  }

  /** @param {unknown} message */
  send(message) {
    if (this.events?.readyState !== WebSocket.OPEN) throw new Error('no connection to the server');
    this.events.send(JSON.stringify(message));
  }

  /** @param {string} name */
  robot(name) {
    let robot = this.robots.get(name);
    if (!robot) {
      robot = new Robot(name, this);
      robot.changed = (changed) => this.onUpdate(changed);
      this.robots.set(name, robot);
      this.onRobots();
    }
    return robot;
  }

  /** @param {any} event as openapi.json describes it */
  receive(event) {
    if (event.type === 'dropped') {
      this.drop(event.count);
    } else if (event.type === 'refused') {
      this.onRefused(event.problem.detail || event.problem.title);
    } else if (event.type === 'state') {
      this.update(this.robot(event.robot), event);
    } else if (event.type === 'driver') {
      const robot = this.robot(event.robot);
      this.setDriver(robot, event.driver);
      robot.changed(robot);
    } else if (event.type === 'lease') {
      const robot = this.robot(event.robot);
      robot.lease = event.lease;
      this.setDriver(robot, { client: event.client });
      robot.changed(robot);
    } else if (event.type === 'released') {
      const robot = this.robot(event.robot);
      robot.lease = '';
      this.setDriver(robot, null);
      robot.changed(robot);
    } else if (event.type === 'ended') {
      this.robot(event.robot).watcher?.({ time: seconds(event.time), event: endText(event.operation) });
    } else if (event.type === 'path') {
      const robot = this.robot(event.robot);
      robot.run = event.run;
      robot.state = { ...robot.state, path: event.run };
      robot.changed(robot);
    }
  }

  /** @param {number} count of events that this page was too slow for */
  drop(count) {
    this.lost += count;
    this.onLink(`Connected; ${this.lost} events skipped`, false);
  }

  /** @param {Robot} robot @param {{ client: string } | null} driver */
  setDriver(robot, driver) {
    robot.state = { ...robot.state, driver: driver && { name: driver.client, mine: this.drives(robot, driver) } };
  }

  /** Whether that is this page. @param {Robot} robot @param {{ client: string } | null} driver */
  drives(robot, driver) {
    // A state without a driver may be older than the lease.
    if (driver && driver.client !== this.client) robot.lease = '';
    return driver !== null && robot.lease !== '';
  }

  /** @param {Robot} robot @param {Wire} wire */
  update(robot, wire) {
    const before = robot.state;
    robot.state = stateOf(wire, this.drives(robot, wire.driver));
    robot.state.path = robot.run;
    robot.findTarget().catch(() => {});
    if (robot.watcher) {
      const changes = [
        before.link !== robot.state.link && `link ${robot.state.link}`,
        before.state !== robot.state.state && (robot.state.state ?? 'does not answer'),
      ].filter((change) => typeof change === 'string');
      const [displacements, pose] = wire.stale ? [null, null] : [wire.displacements, wire.pose];
      robot.watcher({ time: seconds(wire.time), displacements, pose, event: before === UNKNOWN ? '' : changes.join(', ') });
    }
    robot.changed(robot);
  }

  /** @param {Robot | null} robot whose messages are wanted from now on */
  watchMessages(robot) {
    this.watched = robot;
    this.messages?.close();
    this.messages = undefined;
    if (!robot) return;
    const messages = socket(`${robot.path}/events?messages=true`);
    this.messages = messages;
    messages.addEventListener('message', ({ data }) => {
      const event = JSON.parse(data);
      if (event.type === 'dropped') this.drop(event.count);
      if (event.type === 'message') robot.watcher?.({ time: seconds(event.time), traffic: trafficOf(seconds(event.time), event) });
    });
    messages.addEventListener('close', () => setTimeout(() => { if (this.watched === robot && this.messages === messages) this.watchMessages(robot); }, 1000));
  }
}

/** @param {number} time @param {{ from: string | null, text: string, bytes: string, json: Record<string, unknown> }} message */
export function trafficOf(time, { from, text, bytes, json }) {
  return { time, from: from ?? '', text, bytes, bad: 'garbage' in json };
}
