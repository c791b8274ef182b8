// The messages in words beside their bytes. Bounded; drawn at most once a frame, and only what is on the page.
import { by, input, make, say } from './dom.js';

const KEPT = 2000;
const SHOWN = 200;

/** @typedef {{ time: number, from: string, text: string, bytes: string, bad: boolean }} Entry */

export class Traffic {
  constructor() {
    /** @type {Entry[]} */
    this.entries = [];
    this.total = 0;
    this.paused = false;
    this.due = false;
    this.rows = by('traffic-rows');
    this.scroll = by('traffic-scroll');
    this.filter = input('traffic-filter');
    this.filter.addEventListener('input', () => this.draw());
  }

  clear() {
    this.entries = [];
    this.total = 0;
    this.draw();
  }

  /** @param {Entry} entry */
  add(entry) {
    this.entries.push(entry);
    this.total += 1;
    if (this.entries.length > KEPT) this.entries.splice(0, KEPT / 10);
    if (!this.paused) this.drawSoon();
  }

  drawSoon() {
    if (this.due || this.rows.closest('[hidden]')) return;
    this.due = true;
    setTimeout(() => {
      this.due = false;
      if (!this.paused) this.draw();
    }, 400);
  }

  draw() {
    const wanted = this.filter.value.trim().toLowerCase();
    const matches = this.entries.filter(({ from, text, bytes }) => !wanted || `${from} ${text} ${bytes}`.toLowerCase().includes(wanted));
    const follows = this.scroll.scrollTop + this.scroll.clientHeight >= this.scroll.scrollHeight - 30;
    this.rows.replaceChildren(...matches.slice(-SHOWN).map(({ time, from, text, bytes, bad }) => {
      const cells = [new Date(time * 1000).toISOString().slice(11, 23), from, text, bytes];
      return make('tr', bad ? { class: 'bad' } : {}, ...cells.map((cell) => make('td', {}, cell)));
    }));
    say(by('traffic-count'), wanted ? `${matches.length} of the last ${this.entries.length}` : `${this.total} messages`);
    if (follows) this.scroll.scrollTop = this.scroll.scrollHeight;
  }

  /** @param {boolean} paused */
  pause(paused) {
    this.paused = paused;
    this.draw();
  }
}
