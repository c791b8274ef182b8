// A recording in the same views as a robot: its entries are fed again, up to a time that moves or is dragged.
import { by, input, options, say, select } from './dom.js';

/** @typedef {import('./robot.js').Entry} Entry */

/** What the views can hold: no more than that is fed to them at a time. */
const FED = 100_000;

export class Playback {
  /**
   * @param {() => void} restart empties the views
   * @param {(entries: Entry[]) => void} feed shows what came next
   */
  constructor(restart, feed) {
    this.restart = restart;
    this.feed = feed;
    /** @type {Entry[]} */
    this.entries = [];
    this.next = 0;
    this.time = 0;
    this.playing = false;
    options('playback-speed', ['0.1', '0.5', '1', '2', '5', '20'], ['0.1 ×', '0.5 ×', '1 ×', '2 ×', '5 ×', '20 ×']);
    select('playback-speed').value = '1';
    by('playback-play').addEventListener('click', () => this.play(!this.playing));
    input('playback-time').addEventListener('input', () => this.seek(this.start + Number(input('playback-time').value)));
  }

  get start() {
    return this.entries[0]?.time ?? 0;
  }

  get end() {
    return this.entries.at(-1)?.time ?? 0;
  }

  /** @param {Entry[]} entries in the order of their times */
  open(entries) {
    this.play(false);
    this.entries = entries;
    this.time = Infinity;
    input('playback-time').max = String(this.end - this.start);
    this.seek(this.start);
  }

  /** @param {boolean} playing */
  play(playing) {
    if (playing && this.time >= this.end) this.seek(this.start);
    this.playing = playing;
    by('playback-play').setAttribute('aria-pressed', String(playing));
    let before = performance.now();
    const step = () => {
      if (!this.playing) return;
      const now = performance.now();
      this.advance(this.time + (now - before) / 1000 * Number(select('playback-speed').value));
      before = now;
      if (this.time >= this.end) this.play(false); else setTimeout(step, 40);
    };
    if (playing) step();
  }

  /** @param {number} time */
  seek(time) {
    const passed = this.passed(time);
    if (time < this.time || passed > this.next + FED) {
      this.restart();
      this.next = Math.max(0, passed - FED);
    }
    this.advance(time);
  }

  /** How many entries have happened by then. @param {number} time */
  passed(time) {
    let [low, high] = [0, this.entries.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.entries[middle].time <= time) low = middle + 1; else high = middle;
    }
    return low;
  }

  /** @param {number} time */
  advance(time) {
    this.time = Math.min(time, this.end);
    const from = this.next;
    this.next = this.passed(this.time);
    if (this.next > from) this.feed(this.entries.slice(from, this.next));
    input('playback-time').value = String(this.time - this.start);
    // Times of a recording without a date begin at 0.
    const date = this.start > 1e8 ? `, ${new Date(this.time * 1000).toLocaleString()}` : '';
    say(by('playback-note'), `${(this.time - this.start).toFixed(1)} of ${(this.end - this.start).toFixed(1)} s${date}`);
  }
}
