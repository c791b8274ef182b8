// A controller on a TCP port, for what the simulated one does not do: floods of reports, noise, and being unplugged.
import { once } from 'node:events';
import { createServer } from 'node:net';

const STATE = { idle: 0, homing: 1, moving: 2, error: 3 };

/** @param {string} opcode @param {Buffer} data */
export function frame(opcode, data = Buffer.alloc(0)) {
  const head = Buffer.from([0x24, opcode.charCodeAt(0), data.length]);
  const sum = [...head, ...data, 0x3a].reduce((sum, byte) => (sum + byte) & 0xff, 0);
  return Buffer.concat([head, data, Buffer.from([sum, 0x3a])]);
}

export class Controller {
  constructor() {
    this.at = [0, 0, 0];
    /** @type {keyof typeof STATE} */
    this.state = 'idle';
    this.stops = 0b111;
    this.port = 0;
    /** @type {Set<import('node:net').Socket>} */
    this.sockets = new Set();
  }

  get url() {
    return `tcp://127.0.0.1:${this.port}`;
  }

  async plug() {
    this.server = createServer((socket) => {
      socket.setNoDelay();
      this.sockets.add(socket);
      socket.on('error', () => {});
      socket.on('close', () => this.sockets.delete(socket));
      let buffer = Buffer.alloc(0);
      socket.on('data', (data) => {
        buffer = Buffer.concat([buffer, Buffer.from(data)]);
        while (buffer.length >= 5 && buffer.length >= buffer[2] + 5) {
          this.obey(String.fromCharCode(buffer[1]));
          buffer = buffer.subarray(buffer[2] + 5);
        }
      });
    });
    this.server.listen(this.port, '127.0.0.1');
    await once(this.server, 'listening');
    this.port = /** @type {import('node:net').AddressInfo} */ (this.server.address()).port;
  }

  unplug() {
    this.server?.close();
    for (const socket of this.sockets) socket.destroy();
  }

  /** Moves begin; how they go on is up to the test. @param {string} opcode */
  obey(opcode) {
    if (opcode === 'H') [this.at, this.state, this.stops] = [[0, 0, 0], 'idle', 0b111];
    else if (opcode === 'M') [this.state, this.stops] = ['moving', 0];
    else if (opcode === 'C') this.state = 'idle';
    if (opcode !== 'S') this.send(frame('A', Buffer.from(opcode)));
    this.report();
  }

  report() {
    const data = Buffer.alloc(16);
    this.at.forEach((value, arm) => data.writeFloatLE(value, arm * 4));
    data[12] = STATE[this.state] | this.stops << 2;
    this.send(frame('s', data));
  }

  /** @param {Buffer} bytes */
  send(bytes) {
    for (const socket of this.sockets) socket.write(bytes);
  }

  /** Goes on to there, in so many reports. @param {number[]} target @param {number} reports */
  async glide(target, reports) {
    for (let left = reports; left > 0; left -= 1) {
      await new Promise((resolve) => setTimeout(resolve, 50));
      this.at = this.at.map((value, arm) => value + (target[arm] - value) / left);
      this.report();
    }
  }

  /** Reports so often, each time from a little farther on. Returns what stops that. @param {number} perSecond */
  flood(perSecond) {
    const began = Date.now();
    let sent = 0;
    const timer = setInterval(() => {
      for (const due = (Date.now() - began) / 1000 * perSecond; sent < due; sent += 1) {
        this.at = this.at.map((_, arm) => 50 + 40 * Math.sin(sent / 200 + arm));
        this.report();
      }
    }, 5);
    return { stop: () => clearInterval(timer), get sent() { return sent; } };
  }
}
