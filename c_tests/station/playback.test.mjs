// Recordings play back in the views that robots have.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { GEOMETRY, TIMEOUT, api, browser, inSpace, open, says, start, until } from './browser.mjs';
import { frame } from './controller.mjs';

/** @type {Awaited<ReturnType<typeof start>>} */
let server;
/** @type {import('playwright-core').Browser} */
let chromium;

before(async () => {
  server = await start(['--sim', '2', '--listen', '127.0.0.1:0']);
  await api(`${server.url}/api/robots/sim1/geometry`, 'PUT', GEOMETRY);
  chromium = await browser();
});
after(async () => {
  await chromium.close();
  await server.stop();
});

/** @param {number[]} at @param {number} state */
function report(at, state) {
  const data = Buffer.alloc(16);
  at.forEach((value, arm) => data.writeFloatLE(value, arm * 4));
  data[12] = state;
  return frame('s', data);
}

const hex = (/** @type {Buffer} */ bytes) => bytes.toString('hex').replace(/(..)(?=.)/g, '$1 ').toUpperCase();

/** A move to the pose of docs/kinematics.md, with garbage in the middle. */
function recording() {
  const lines = ['# deltarobot recording 1', '# started 2026-11-28T20:41:15.000000Z'];
  for (let step = 0; step <= 40; step += 1) {
    const part = step / 40;
    const at = [127.2294 * part, 79.1266 * part, 127.2294 * part];
    lines.push(`${(step / 10).toFixed(6)} < ${hex(report(at, step === 40 ? 0 : 2))}`);
    if (step === 20) lines.push('2.010000 > 3C 62 3E 21', `2.500000 > ${hex(frame('C'))}`);
  }
  return lines.join('\n') + '\n';
}

test('a recording is shown, dragged through and played', async () => {
  const { page, context, errors } = await open(chromium, `${server.url}/#/recording`);
  await page.waitForFunction(() => /** @type {any} */ (window).station.connection.robots.get('sim1')?.state.geometry, undefined, { timeout: TIMEOUT });
  await page.setInputFiles('#playback-file', { name: 'session.txt', mimeType: 'text/plain', buffer: Buffer.from(recording()) });
  await says(page, '#playback-note', /^0\.0 of 4\.0 s/);
  await says(page, '#driver', /A recording/);
  await page.locator('#playback-time').fill('4');
  await says(page, '#state', /IDLE/);
  await says(page, '#where', /A127\.23.*B79\.13.*C127\.23/);
  await says(page, '#cartesian', /X 250\.0 {2}Y 400\.0 {2}Z 250\.0 mm/);
  await inSpace(page);
  await page.click('#tab-traffic');
  await page.fill('#traffic-filter', '3c 62');
  await says(page, '#traffic-rows', /3C 62 3E 21/);
  assert.ok(await page.locator('#traffic-rows tr.bad').count() > 0);
  assert.equal(await page.evaluate(() => /** @type {any} */ (window).station.plot.times.length), 41);

  await page.locator('#playback-time').fill('1');
  await says(page, '#state', /MOVING/);
  await says(page, '#where', /A31\.81/);
  assert.equal(await page.evaluate(() => /** @type {any} */ (window).station.plot.times.length), 11);
  await page.selectOption('#playback-speed', '20');
  await page.click('#playback-play');
  await says(page, '#playback-note', /^4\.0 of 4\.0 s/);
  await says(page, '#state', /IDLE/);

  await page.setInputFiles('#playback-file', { name: 'none.txt', mimeType: 'text/plain', buffer: Buffer.from('nothing\n') });
  await says(page, '#playback-note', /^none\.txt: .+/);
  assert.deepEqual(errors, []);
  await context.close();
});

test('the last 50,000 messages are kept, and read with a scroll bar', async () => {
  const { page, context, errors } = await open(chromium, `${server.url}/#/recording`);
  const lines = Array.from({ length: 60_000 }, (_, at) => `${(at / 100).toFixed(2)} > 24 43 00 A1 3A`);
  const text = ['# deltarobot recording 1', '# started 2026-11-28T20:00:00.000000Z', ...lines].join('\n') + '\n';
  await page.setInputFiles('#playback-file', { name: 'long.txt', mimeType: 'text/plain', buffer: Buffer.from(text) });
  await says(page, '#playback-note', /^0\.0 of 600\.0 s/);
  await page.locator('#playback-time').fill('600');
  await page.click('#tab-traffic');
  await says(page, '#traffic-count', /^60000 messages; the last 50000 are kept/);
  await says(page, '#traffic-rows', /20:09:59\.990host/);
  assert.ok(await page.locator('#traffic-rows tr').count() < 60);
  await page.focus('#traffic-scroll');
  await page.keyboard.press('Home');
  await says(page, '#traffic-rows', /^20:01:40\.000host/);
  await page.keyboard.press('PageDown');
  await says(page, '#traffic-rows', /^20:01:40\.0[1-9]0host/);
  // Were the list's height to change while it is read, End would miss the end.
  const height = () => page.evaluate(() => document.querySelector('#traffic-scroll')?.scrollHeight);
  const atFirst = await height();
  await page.evaluate(() => { const scroll = document.querySelector('#traffic-scroll'); if (scroll) scroll.scrollTop = scroll.scrollHeight / 2; });
  await says(page, '#traffic-rows', /^20:05:(49|50)\./);
  assert.equal(await height(), atFirst);
  await page.keyboard.press('End');
  await says(page, '#traffic-rows', /20:09:59\.990host/);
  await page.fill('#traffic-filter', 'no such');
  await says(page, '#traffic-count', /^0 of the last 50000/);
  await page.fill('#traffic-filter', '24 43');
  await says(page, '#traffic-count', /^50000 of the last 50000/);
  assert.deepEqual(errors, []);
  await context.close();
});

/** Records of two robots, one of which moves, by a server that ends by this signal. @param {NodeJS.Signals} signal */
async function record(signal) {
  const directory = mkdtempSync(join(tmpdir(), 'station-'));
  const config = join(directory, 'serve.toml');
  writeFileSync(config, `listen = "127.0.0.1:0"\nsimulated = 2\n[record]\ndirectory = "${directory}"\n`);
  const recording = await start(['--config', config]);
  const file = () => readFileSync(join(directory, String(readdirSync(directory).find((name) => name.endsWith('.mcap')))));
  try {
    const robot = `${recording.url}/api/robots/sim1`;
    await until(async () => (await api(robot, 'GET')).link === 'up');
    const { lease } = await api(`${robot}/lease`, 'POST', { client: 'test', seconds: 60 });
    for (const [what, body] of /** @type {const} */ ([['home', {}], ['move', { displacements: [127.2294, 79.1266, 127.2294] }]])) {
      await api(`${robot}/${what}`, 'POST', { ...body, wait: true }, { 'Deltarobot-Lease': lease });
    }
    // Chunks end each second.
    await until(() => /"event":"ended"[^}]*"kind":"move"/.test(file().toString('latin1')));
  } finally {
    await recording.stop(signal);
  }
  return file();
}

test('records of serve, also of one that was killed, play back', async () => {
  const { page, context, errors } = await open(chromium, `${server.url}/#/recording`);
  await page.waitForFunction(() => /** @type {any} */ (window).station.connection.robots.get('sim1')?.state.geometry, undefined, { timeout: TIMEOUT });
  /** @param {string} name @param {Buffer} buffer */
  const load = (name, buffer) => page.setInputFiles('#playback-file', { name, mimeType: 'application/octet-stream', buffer });
  const choose = async (/** @type {string} */ robot) => {
    await page.selectOption('#playback-robot', robot);
    await says(page, '#playback-note', /^0\.0 of/);
  };
  const toEnd = async () => page.locator('#playback-time').fill(String(await page.getAttribute('#playback-time', 'max')));

  const whole = await record('SIGTERM');
  await load('whole.mcap', whole);
  await says(page, '#playback-note', /^0\.0 of [\d.]+ s, /);
  await says(page, '#playback-robots', /sim1sim2/);
  await choose('sim1');
  await toEnd();
  await says(page, '#where', /A127\.23.*B79\.13.*C127\.23/);
  await says(page, '#cartesian', /X 250\.0 {2}Y 400\.0 {2}Z 250\.0 mm/);
  await inSpace(page);
  assert.equal(await page.textContent('#playback-warning'), '');
  await page.click('#tab-traffic');
  await page.fill('#traffic-filter', 'move');
  await says(page, '#traffic-rows', /hostMOVE.*24 4D 0C/);
  const events = await page.evaluate(() => /** @type {any} */ (window).station.plot.events.map((/** @type {any} */ event) => event.text));
  for (const event of ['link up', 'test drives', 'home finished', 'move finished']) assert.ok(events.includes(event), `${event}: ${events}`);
  await choose('sim2');
  await toEnd();
  await says(page, '#state-note', /position unknown/);

  // Killed, then cut off somewhere in its last chunk, as a disk may leave it.
  const killed = await record('SIGKILL');
  await load('killed.mcap', killed.subarray(0, killed.length - 7));
  await says(page, '#playback-warning', /was not ended: what is there up to its last chunk is shown/);
  await choose('sim1');
  await toEnd();
  await says(page, '#where', /A\d+\.\d+.*B\d+/);

  // A fault in the middle: what is before is shown.
  const damaged = Buffer.from(whole);
  damaged[Math.floor(damaged.length * 0.6)] ^= 0x10;
  await load('damaged.mcap', damaged);
  await says(page, '#playback-warning', /up to a fault alone, and that is shown: .*CRC/i);

  // Compressed ones of others are refused with what helps.
  const chunk = whole.indexOf(Buffer.from([6]), 8 + 9 + whole.readUIntLE(9, 6));
  const compressed = Buffer.concat([whole.subarray(0, chunk + 37), Buffer.from('\x04\0\0\0zstd', 'latin1'), whole.subarray(chunk + 41)]);
  compressed.writeUInt32LE(whole.readUInt32LE(chunk + 1) + 4, chunk + 1);
  await load('zstd.mcap', compressed);
  await says(page, '#playback-note', /^zstd\.mcap: .*compression zstd.*mcap compress --compression none/);
  await load('none.mcap', Buffer.from([0x89, 0, 1, 2, 3, 4, 5, 6, 7, 8]));
  await says(page, '#playback-note', /^none\.mcap: .+/);
  assert.deepEqual(errors, []);
  await context.close();
});
