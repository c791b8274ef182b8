// The first second: what the robot does, where it is and who drives is shown without three.js, and also where that can't run.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { GEOMETRY, api, browser, drive, home, inSpace, open, says, start } from './browser.mjs';

/** @type {Awaited<ReturnType<typeof start>>} */
let server;

before(async () => {
  server = await start(['--sim', '1', '--listen', '127.0.0.1:0']);
  await api(`${server.url}/api/robots/sim1/geometry`, 'PUT', GEOMETRY);
  await api(`${server.url}/api/robots/sim1/lease`, 'POST', { client: 'anna', seconds: 60 });
});
after(() => server.stop());

test('state, place and driver are shown before three.js is there', async (context) => {
  const chromium = await browser();
  try {
    const held = await chromium.newContext();
    const page = await held.newPage();
    /** @type {() => void} */
    let release = () => {};
    const released = new Promise((resolve) => { release = () => resolve(undefined); });
    await page.route('**/vendor/three.js', async (route) => {
      await released;
      await route.continue();
    });
    const began = Date.now();
    await page.goto(server.url);
    await says(page, '#state', /IDLE/);
    context.diagnostic(`shown ${Date.now() - began} ms after the address was given`);
    await says(page, '#where', /A\?clearB\?clearC\?clear/);
    await says(page, '#driver', /^anna drives: you watch/);
    await page.click('#drive');
    await home(page);
    await says(page, '#where', /A0\.00PRESSED/);
    await page.keyboard.press('Escape');
    await says(page, '#cancel-note', /controller has confirmed/);
    assert.equal(await page.evaluate(() => /** @type {any} */ (window).station.scene), undefined);
    release();
    await inSpace(page);
    await page.click('#drive');
    await says(page, '#driver', /^Nobody/);
  } finally {
    await chromium.close();
  }
});

test('a browser without WebGL has all but the drawing', async () => {
  const chromium = await browser(['--disable-3d-apis']);
  try {
    const { page, errors } = await open(chromium, server.url);
    await says(page, '#view-note', /can not be drawn here/);
    await drive(page);
    await home(page);
    await says(page, '#bars', /A0\.00B0\.00C0\.00/);
    assert.ok(await page.locator('#bars').isVisible());
    await page.click('#tab-path');
    await says(page, '#path', /can not be drawn here/);
    assert.deepEqual(errors.filter((error) => !/WebGL/.test(error)), []);
  } finally {
    await chromium.close();
  }
});
