// A telephone: everything with a finger, by the touch events that Chromium gets from a screen.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { GEOMETRY, api, browser, inSpace, open, picture, says, standsAt, start } from './browser.mjs';

test('home, jog, draw, run and cancel with a finger', async () => {
  const server = await start(['--sim', '1', '--listen', '127.0.0.1:0']);
  await api(`${server.url}/api/robots/sim1/geometry`, 'PUT', GEOMETRY);
  const chromium = await browser();
  try {
    const { page, context, errors } = await open(chromium, server.url, { viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 });
    const tools = await context.newCDPSession(page);
    /** @param {'touchStart' | 'touchMove' | 'touchEnd' | 'touchCancel'} type @param {{ x: number, y: number }[]} touchPoints */
    const touch = (type, touchPoints) => tools.send('Input.dispatchTouchEvent', { type, touchPoints });

    await says(page, '#state', /IDLE/);
    await page.tap('#drive');
    await says(page, '#driver', /^You drive/);
    await page.tap('#home');
    await standsAt(page, ['0.00', '0.00', '0.00']);
    for (const [at, value] of ['127.23', '79.13', '127.23'].entries()) await page.fill(`#target-${at}`, value);
    await page.tap('#move-go');
    await standsAt(page, ['127.23', '79.13', '127.23']);
    // Two quick taps are two steps, as far as the first has ended; neither zooms.
    await page.tap('#jog button:has-text("A+")');
    await standsAt(page, ['129.73', '79.13', '127.23']);
    await page.tap('#jog button:has-text("A−")');
    await standsAt(page, ['127.23', '79.13', '127.23']);
    assert.equal(await page.evaluate(() => visualViewport?.scale), 1);

    await inSpace(page);
    await page.tap('#tab-path');
    await page.tap('#path-here');
    await page.tap('#path-draw');
    await page.locator('#view').scrollIntoViewIfNeeded();
    const scrolled = await page.evaluate(() => document.querySelector('#robot')?.scrollTop);
    const { x, y } = await page.evaluate(() => /** @type {any} */ (window).station.scene.drawn().robot.tool);
    const stroke = async (/** @type {'touchEnd' | 'touchCancel'} */ end) => {
      await touch('touchStart', [{ x: x - 20, y }]);
      for (let step = 0; step <= 10; step += 1) await touch('touchMove', [{ x: x - 20 + 4 * step, y: y + 8 * Math.sin(step / 2) }]);
      await touch(end, []);
    };
    // What the system takes over (a gesture from the edge) is no path.
    await stroke('touchCancel');
    assert.doesNotMatch(String(await page.textContent('#path-note')), /^drawn/);
    await stroke('touchEnd');
    await says(page, '#path-note', /^drawn: \d+ targets, \d+ mm, all within reach/);
    assert.equal(await page.evaluate(() => document.querySelector('#robot')?.scrollTop), scrolled);
    await page.tap('#path-run');
    await says(page, '#path-progress-text', /^finished: (\d+) of \1, error/);
    await picture(page, 'station-narrow');

    // So far away that it moves for as long as a slow browser may need to see it.
    await api(`${server.url}/api/robots/sim1/geometry`, 'PUT', { ...GEOMETRY, arms: GEOMETRY.arms.map((arm) => ({ ...arm, max: 9000 })) });
    await says(page, '#move-note', /C 0 to 9000/);
    for (const at of [0, 1, 2]) await page.fill(`#target-${at}`, '9000');
    await page.tap('#move-go[aria-disabled=false]');
    await says(page, '#state', /MOVING/);
    await page.tap('#cancel');
    await says(page, '#cancel-note', /controller has confirmed/);
    await says(page, '#state', /IDLE/);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    assert.ok(Number(await page.textContent('#where tr:nth-child(1) td')) < 8900);
    assert.deepEqual(errors, []);
  } finally {
    await chromium.close();
    await server.stop();
  }
});
