// Paths: drawn with the mouse, loaded from each format, refused by line, run to the end, paused, cancelled.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { GEOMETRY, api, browser, drive, home, inSpace, move, open, picture, says, standsAt, start } from './browser.mjs';

/** @type {Awaited<ReturnType<typeof start>>} */
let server;
/** @type {import('playwright-core').Browser} */
let chromium;
/** @type {import('playwright-core').Page} */
let page;
/** @type {string[]} */
let errors;

before(async () => {
  server = await start(['--sim', '2', '--listen', '127.0.0.1:0']);
  await api(`${server.url}/api/robots/sim1/geometry`, 'PUT', GEOMETRY);
  chromium = await browser();
  ({ page, errors } = await open(chromium, `${server.url}/#/robot/sim1`));
  await says(page, '#state', /IDLE/);
  await drive(page);
  await home(page);
  await move(page, [127.23, 79.13, 127.23]);
  await standsAt(page, ['127.23', '79.13', '127.23']);
  await inSpace(page);
  await page.click('#tab-path');
});
after(async () => {
  assert.deepEqual(errors, []);
  await chromium.close();
  await server.stop();
});

const drawn = () => page.evaluate(() => /** @type {any} */ (window).station.paths.drawn());

/** @param {string} name @param {string} text */
async function load(name, text) {
  await page.setInputFiles('#path-file', { name, mimeType: 'text/plain', buffer: Buffer.from(text) });
}

/** Runs what is loaded, and waits until it is at its end. @param {number} [busy] seconds for which the page does nothing meanwhile */
async function run(busy = 0) {
  await page.click('#path-run');
  await page.evaluate((seconds) => { for (const end = performance.now() + seconds * 1000; performance.now() < end;); }, busy);
  await says(page, '#path-progress-text', /^finished: (\d+) of \1, error \d+\.\d+ mm on average, \d+\.\d+ mm at most/);
  const [, mean, most] = /error ([\d.]+) mm on average, ([\d.]+)/.exec(String(await page.textContent('#path-progress-text'))) ?? [];
  // The simulated robot stands where it was told to.
  assert.ok(Number(mean) <= 0.05 && Number(most) <= 0.05, `${mean} ${most}`);
  assert.ok((await drawn()).reached > 2);
}

test('drawn with the mouse, run to the end', async () => {
  await page.click('#path-here');
  await page.click('#path-draw');
  const middle = await page.evaluate(() => /** @type {any} */ (window).station.scene.drawn().robot.tool);
  await page.mouse.move(middle.x - 20, middle.y);
  await page.mouse.down();
  for (let step = 0; step <= 20; step += 1) await page.mouse.move(middle.x - 20 + 2 * step, middle.y + 8 * Math.sin(step / 3));
  await page.mouse.up();
  await says(page, '#path-note', /^drawn: \d+ targets, \d+ mm, all within reach/);
  assert.ok((await drawn()).wanted >= 1);
  await run();
});

test('each format is loaded and run', async () => {
  await page.fill('#path-x', '250');
  await page.fill('#path-y', '400');
  await page.fill('#path-z', '250');
  await load('square.csv', 'x,y,z\n0,0,0\n0.02,0,0\n0.02,0.02,0\n0,0.02,0\n0,0,0\n');
  await says(page, '#path-note', /^square\.csv: \d+ targets, 80 mm, all within reach/);
  await run(4);
  await load('part.gcode', 'G21 G90\nG0 X0 Y0\nG1 X10\nG2 X10 Y10 I0 J5\nG91\nG1 X-10\nG3 X0 Y-10 R5\n');
  await says(page, '#path-note', /^part\.gcode: \d+ targets, \d+ mm, all within reach/);
  await run();
  await load('star.svg', '<svg xmlns="http://www.w3.org/2000/svg" width="30mm" height="30mm" viewBox="0 0 30 30"><path d="M2 2 L20 4 C 25 10 20 20 10 18 Z"/></svg>');
  await says(page, '#path-note', /^star\.svg: \d+ targets, \d+ mm, all within reach/);
  await run();
});

test('bad files are refused with the line', async () => {
  for (const [name, text, said] of /** @type {const} */ ([
    ['a.csv', '0,0,0\n0,zwei,0\n', /line 2: `zwei` is not a number/],
    ['a.gcode', 'G0 X0\nG1 X1\nM104 S200\n', /line 3: /],
    ['a.gcode', 'G90\nG28\n', /line 2: G28 is none of/],
    ['a.svg', '<svg>\n<path d="M0 0 L"/>\n', /^a\.svg: (?!being checked)/],
    ['a.doc', 'x', /has to end in \.csv, \.svg or \.gcode/],
    ['a.csv', '', /there are no points/],
  ])) {
    await load(name, text);
    await says(page, '#path-note', said);
    assert.equal(await page.getAttribute('#path-note', 'class'), 'bad');
    assert.equal(await page.getAttribute('#path-run', 'aria-disabled'), 'true');
  }
});

test('what is out of reach is shown with the reason, and not run', async () => {
  await load('far.csv', '0,0,0\n0.9,0,0\n');
  await says(page, '#path-note', /far\.csv: 1 part is out of reach/);
  await says(page, '#path-problems', /lines? \d+ to 2: D[ABC] would have to be [\d.]+, at most 300 is possible/);
  // Nothing is said of the run before it.
  assert.equal(await page.textContent('#path-progress-text'), '');
  const { wanted, unreachable } = await drawn();
  assert.ok(wanted >= 1 && unreachable >= 1, `${wanted} ${unreachable}`);
  assert.equal(await page.getAttribute('#path-run', 'aria-disabled'), 'true');
  await picture(page, 'station-unreachable');
});

test('pause, resume and cancel', async () => {
  // Minutes long, so that it runs for as long as a slow browser may need to see it.
  const zigzag = Array.from({ length: 200 }, (_, at) => `${at % 2 ? 0.05 : 0},0,${at / 10_000}`).join('\n');
  await load('zigzag.csv', zigzag);
  await says(page, '#path-note', /all within reach/);
  await page.click('#path-run');
  await says(page, '#path-progress-text', /^running: ([3-9]|\d\d+) of \d+, \d+ s left/);
  await page.click('#path-pause');
  await says(page, '#path-progress-text', /^paused: \d+ of/);
  await says(page, '#state', /IDLE/);
  // Whoever comes now, sees that at once: nothing more is said about it before it goes on.
  const late = await open(chromium, server.url);
  await says(late.page, '#tiles', /sim1[^]*Its path is paused/);
  await late.page.click('#tiles a:has-text("sim1")');
  await says(late.page, '#state-note', /^path paused: \d+ of \d+/);
  await late.page.click('#tab-path');
  await says(late.page, '#path-progress-text', /^paused: \d+ of/);
  assert.deepEqual(late.errors, []);
  await late.context.close();
  await page.click('#path-resume');
  await says(page, '#path-progress-text', /^running: \d+ of/);
  await page.keyboard.press('Escape');
  await says(page, '#cancel-note', /controller has confirmed/);
  await says(page, '#path-progress-text', /^cancelled: \d+ of/);
  await says(page, '#state', /IDLE/);
  // Cancel ends one that is paused too.
  await page.click('#path-run');
  await says(page, '#path-progress-text', /^running: ([2-9]|\d\d+) of/);
  await page.click('#path-pause');
  await says(page, '#path-progress-text', /^paused/);
  await page.keyboard.press('Escape');
  await says(page, '#path-progress-text', /^cancelled: \d+ of/);
});

test('without a geometry there is nothing to draw on', async () => {
  await page.goto(`${server.url}/#/robot/sim2`);
  await says(page, '#title', /sim2/);
  await page.click('#path-draw');
  await says(page, '#path-note', /needs the geometry/);
});
