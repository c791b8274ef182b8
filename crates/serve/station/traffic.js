// The messages in words beside their bytes. The last ones are kept; rows are made of those alone that are in sight.
import { by, input, make, say } from './dom.js';
import { Ring } from './ring.js';

const KEPT = 50_000;
const SIZE = 12 << 20;

/** @typedef {{ time: number, from: string, text: string, bytes: string, bad: boolean }} Entry */

export class Traffic {
  constructor() {
    this.ring = new Ring(KEPT, SIZE);
    this.total = 0;
    this.paused = false;
    this.due = false;
    /** The numbers of what the filter leaves; null where there is none. @type {number[] | null} */
    this.found = null;
    /** The number of the first row. */
    this.top = 0;
    this.rows = by('traffic-rows');
    this.scroll = by('traffic-scroll');
    this.above = spacer();
    this.below = spacer();
    /** Whether the newest are shown as they come: until somebody scrolls away from them. */
    this.following = true;
    /** Where it was scrolled to when it was drawn. */
    this.place = 0;
    this.scroll.addEventListener('scroll', () => {
      const { scrollTop, clientHeight, scrollHeight } = this.scroll;
      if (Math.abs(scrollTop - this.place) > 1) this.following = scrollTop + clientHeight >= scrollHeight - 30;
      this.draw();
    });
    input('traffic-filter').addEventListener('input', () => this.search());
  }

  clear() {
    this.ring.clear();
    this.total = 0;
    this.search();
  }

  /** @param {Entry} entry */
  add(entry) {
    this.ring.add(entry);
    this.total += 1;
    if (this.found && this.matches(entry)) this.found.push(this.ring.next - 1);
    if (!this.paused) this.drawSoon();
  }

  get wanted() {
    return input('traffic-filter').value.trim().toLowerCase();
  }

  /** @param {Entry} entry */
  matches({ from, text, bytes }) {
    return `${from} ${text} ${bytes}`.toLowerCase().includes(this.wanted);
  }

  /** Looks through all that is kept for what the filter wants. */
  search() {
    this.found = null;
    if (this.wanted) {
      this.found = [];
      for (let number = this.ring.first; number < this.ring.next; number += 1) if (this.matches(this.ring.get(number))) this.found.push(number);
    }
    this.top = this.ring.first;
    this.following = true;
    this.draw();
  }

  drawSoon() {
    if (this.due || this.rows.closest('[hidden]')) return;
    this.due = true;
    setTimeout(() => {
      this.due = false;
      this.draw();
    }, 250);
  }

  draw() {
    const { following, found, ring, scroll } = this;
    // What is no longer kept moves the others up; whoever reads them has them stand.
    const kept = found ? found.findIndex((number) => number >= ring.first) : ring.first - this.top;
    const gone = kept < 0 ? found?.length ?? 0 : kept;
    found?.splice(0, gone);
    this.top = ring.first;
    const count = found ? found.length : ring.length;
    // Rounded: the same row measures a 64th of a pixel more or less by where it lies, which 50,000 times is 46 rows.
    const height = Math.round(this.rows.children[1]?.getBoundingClientRect().height || 17);
    const shown = Math.ceil(scroll.clientHeight / height) + 2;
    const begin = following ? Math.max(0, count - shown) : Math.min(Math.max(0, Math.floor(scroll.scrollTop / height) - gone), Math.max(0, count - shown));
    const end = Math.min(count, begin + shown);
    const rows = [];
    for (let row = begin; row < end; row += 1) {
      const { time, from, text, bytes, bad } = ring.get(found ? found[row] : ring.first + row);
      const cells = [new Date(time * 1000).toISOString().slice(11, 23), from, text, bytes];
      rows.push(make('tr', bad ? { class: 'bad' } : {}, ...cells.map((cell) => make('td', {}, cell))));
    }
    this.above.style.height = `${begin * height}px`;
    this.below.style.height = `${(count - end) * height}px`;
    this.rows.replaceChildren(this.above, ...rows, this.below);
    say(by('traffic-count'), found ? `${count} of the last ${ring.length}` : `${this.total} messages${this.total > ring.length ? `; the last ${ring.length} are kept` : ''}`);
    if (following) scroll.scrollTop = scroll.scrollHeight;
    else if (gone > 0) scroll.scrollTop -= gone * height;
    this.place = scroll.scrollTop;
  }

  /** @param {boolean} paused */
  pause(paused) {
    this.paused = paused;
    this.draw();
  }
}

/** Stands for the rows that are not in sight. */
const spacer = () => make('tr', { 'aria-hidden': 'true' });
