// Displacements over time, with events: a bounded history, drawn at most some times a second.
import uPlot from './vendor/uplot.js';
import { number, save } from './dom.js';

const KEPT = 36_000;
const LINES = [{ stroke: '--a', dash: [] }, { stroke: '--b', dash: [8, 4] }, { stroke: '--c', dash: [2, 3] }];

export class Plot {
  /** @param {HTMLElement} area @param {HTMLElement} values where the numbers under the cursor are shown */
  constructor(area, values) {
    this.area = area;
    this.values = values;
    this.clear();
    this.paused = false;
    this.zoomed = false;
    this.due = false;
    new ResizeObserver(() => this.resize()).observe(area);
    document.addEventListener('themechange', () => this.build());
    this.build();
  }

  clear() {
    /** @type {number[]} */
    this.times = [];
    /** @type {(number | null)[][]} */
    this.lines = [[], [], []];
    /** @type {{ time: number, text: string }[]} */
    this.events = [];
    this.draw();
  }

  build() {
    this.chart?.destroy();
    const style = getComputedStyle(document.documentElement);
    const color = (/** @type {string} */ name) => {
      // light-dark() is resolved only as the value of a property that is a colour.
      this.area.style.color = style.getPropertyValue(name);
      const resolved = getComputedStyle(this.area).color;
      this.area.style.color = '';
      return resolved;
    };
    const axis = { stroke: color('--text'), grid: { stroke: color('--edge'), width: 1 }, ticks: { stroke: color('--edge') } };
    const eventColor = color('--soft');
    this.chart = new uPlot({
      width: this.area.clientWidth || 400,
      height: Math.max(this.area.clientHeight, 100),
      legend: { show: false },
      scales: { x: { time: true } },
      axes: [axis, { ...axis, size: 54 }],
      series: [{}, ...LINES.map(({ stroke, dash }, arm) => ({ label: 'ABC'[arm], stroke: color(stroke), dash, width: 1.6, spanGaps: false }))],
      hooks: {
        setCursor: [(chart) => this.showValues(chart.cursor.idx)],
        setSelect: [() => { this.zoomed = true; }],
        draw: [(chart) => this.drawEvents(chart, eventColor)],
      },
    }, [this.times, ...this.lines], this.area);
    this.chart.over.addEventListener('dblclick', () => this.showAll());
  }

  resize() {
    if (this.area.clientWidth) this.chart?.setSize({ width: this.area.clientWidth, height: Math.max(this.area.clientHeight, 100) });
  }

  /** @param {number} time in seconds @param {(number | null)[]} displacements */
  add(time, displacements) {
    if (this.times.length >= KEPT) [this.times, ...this.lines].forEach((list) => list.splice(0, KEPT / 10));
    // uPlot wants ascending times; a clock that is set back must not stop the plot.
    this.times.push(Math.max(time, this.times.at(-1) ?? time));
    displacements.forEach((value, arm) => this.lines[arm].push(value));
    this.draw();
  }

  /** @param {number} time @param {string} text */
  addEvent(time, text) {
    this.events.push({ time, text });
    if (this.events.length > 500) this.events.splice(0, 50);
    this.draw();
  }

  draw() {
    if (this.due || this.paused) return;
    this.due = true;
    setTimeout(() => {
      this.due = false;
      // A hidden plot has no size, and catches up when it is shown.
      if (!this.paused && this.area.clientWidth) this.chart?.setData([this.times, ...this.lines], !this.zoomed);
      if (this.zoomed) this.chart?.redraw();
    }, 100);
  }

  /** @param {boolean} paused */
  pause(paused) {
    this.paused = paused;
    this.draw();
  }

  showAll() {
    this.zoomed = false;
    this.chart?.setData([this.times, ...this.lines], true);
  }

  /** @param {number | null | undefined} index */
  showValues(index) {
    const time = this.times[index ?? -1];
    this.values.textContent = time === undefined ? '' : `${new Date(time * 1000).toLocaleTimeString()}  `
      + this.lines.map((line, arm) => `${'ABC'[arm]} ${number(line[index ?? 0])}`).join('  ');
  }

  /** @param {uPlot} chart @param {string} color */
  drawEvents({ ctx, bbox, scales, valToPos }, color) {
    ctx.save();
    ctx.fillStyle = ctx.strokeStyle = color;
    ctx.font = `${11 * devicePixelRatio}px sans-serif`;
    let free = -Infinity;
    for (const { time, text } of this.events) {
      if (time < (scales.x.min ?? 0) || time > (scales.x.max ?? 0)) continue;
      const x = valToPos(time, 'x', true);
      ctx.fillRect(x, bbox.top, 1, bbox.height);
      if (x < free) continue;
      const shown = text.slice(0, 40);
      ctx.fillText(shown, x + 3, bbox.top + 11 * devicePixelRatio);
      free = x + 6 + ctx.measureText(shown).width;
    }
    ctx.restore();
  }

  /** All that is kept, as a table: events have lines of their own. */
  csv() {
    const quoted = (/** @type {string} */ text) => `"${text.replaceAll('"', '""')}"`;
    const rows = this.times.map((time, index) => ({ time, line: this.lines.map((line) => line[index] ?? '').join(',') + ',' }));
    // A spreadsheet takes a cell that begins with one of these for a formula.
    const events = this.events.map(({ time, text }) => ({ time, line: `,,,${quoted(text.replace(/^[=+\-@\t\r]/, "'$&"))}` }));
    const sorted = [...rows, ...events].sort((a, b) => a.time - b.time);
    return ['time,A,B,C,event', ...sorted.map(({ time, line }) => `${new Date(time * 1000).toISOString()},${line}`)].join('\r\n') + '\r\n';
  }

  saveCsv() {
    save('displacements.csv', new Blob([this.csv()], { type: 'text/csv' }));
  }

  savePng() {
    this.chart?.ctx.canvas.toBlob((blob) => { if (blob) save('displacements.png', blob); });
  }
}
