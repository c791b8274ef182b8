// The last messages, in memory that is taken once: their texts stand in one buffer, the newest over the oldest.

/** @typedef {import('./traffic.js').Entry} Entry */

const SEPARATOR = '\0';

export class Ring {
  /** @param {number} kept messages at most @param {number} size of all of their texts, in bytes */
  constructor(kept, size) {
    this.kept = kept;
    this.times = new Float64Array(kept);
    this.begins = new Uint32Array(kept);
    this.ends = new Uint32Array(kept);
    this.bad = new Uint8Array(kept);
    this.buffer = new Uint8Array(size);
    /** Messages are numbered as they come: the oldest that is kept, and the one that comes next. */
    this.first = 0;
    this.next = 0;
    this.encoder = new TextEncoder();
    this.decoder = new TextDecoder();
  }

  clear() {
    this.first = this.next = 0;
  }

  get length() {
    return this.next - this.first;
  }

  /** @param {Entry} entry */
  add({ time, from, text, bytes, bad }) {
    const words = this.encoder.encode([from, text, bytes].join(SEPARATOR)).subarray(0, this.buffer.length >> 4);
    let begin = this.length ? this.ends[(this.next - 1) % this.kept] : 0;
    if (begin + words.length > this.buffer.length) {
      // The oldest ones are between here and the end, which stays empty.
      this.drop((from) => from >= begin);
      begin = 0;
    }
    const end = begin + words.length;
    this.drop((from, to) => this.length === this.kept || (from < end && to > begin));
    this.buffer.set(words, begin);
    const slot = this.next % this.kept;
    [this.times[slot], this.begins[slot], this.ends[slot], this.bad[slot]] = [time, begin, end, bad ? 1 : 0];
    this.next += 1;
  }

  /** @param {(from: number, to: number) => boolean} isInTheWay of the oldest one */
  drop(isInTheWay) {
    while (this.length && isInTheWay(this.begins[this.first % this.kept], this.ends[this.first % this.kept])) this.first += 1;
  }

  /** @param {number} number of one that is kept @returns {Entry} */
  get(number) {
    const slot = number % this.kept;
    const [from = '', text = '', bytes = ''] = this.decoder.decode(this.buffer.subarray(this.begins[slot], this.ends[slot])).split(SEPARATOR);
    return { time: this.times[slot], from, text, bytes, bad: this.bad[slot] === 1 };
  }
}
