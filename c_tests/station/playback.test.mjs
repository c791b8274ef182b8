// Recordings play back in the views that robots have.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { GEOMETRY, PATIENCE, api, browser, open, says, start } from './browser.mjs';
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
  await page.waitForFunction(() => /** @type {any} */ (window).station.connection.robots.get('sim1')?.state.geometry, undefined, { timeout: PATIENCE });
  await page.setInputFiles('#playback-file', { name: 'session.txt', mimeType: 'text/plain', buffer: Buffer.from(recording()) });
  await says(page, '#playback-note', /^0\.0 of 4\.0 s/);
  await says(page, '#driver', /A recording/);
  await page.locator('#playback-time').fill('4');
  await says(page, '#state', /IDLE/);
  await says(page, '#where', /A127\.23.*B79\.13.*C127\.23/);
  await says(page, '#cartesian', /X 250\.0 {2}Y 400\.0 {2}Z 250\.0 mm/);
  assert.ok(await page.evaluate(() => /** @type {any} */ (window).station.scene.drawn().robot));
  await page.click('#tab-traffic');
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
