// The page itself: what is served, what is shown of hostile texts, accessibility, sizes of screens, and memory.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { get } from 'node:http';
import { after, before, test } from 'node:test';
import { GEOMETRY, TIMEOUT, api, browser, drive, home, move, open, picture, says, standsAt, start } from './browser.mjs';
import { Controller } from './controller.mjs';

/** How long the test of memory takes, in seconds: DP_STATION_MEMORY=600 is the long one. */
const MEMORY_SECONDS = Number(process.env.DP_STATION_MEMORY ?? 20);

/** @type {Awaited<ReturnType<typeof start>>} */
let server;
/** @type {import('playwright-core').Browser} */
let chromium;
const controller = new Controller();

before(async () => {
  await controller.plug();
  server = await start([`cell=${controller.url}`, '--sim', '2', '--listen', '127.0.0.1:0']);
  for (const name of ['cell', 'sim1']) await api(`${server.url}/api/robots/${name}/geometry`, 'PUT', GEOMETRY);
  chromium = await browser();
});
after(async () => {
  await chromium.close();
  await server.stop();
  controller.unplug();
});

/** @param {string} path @param {Record<string, string>} [headers] @returns {Promise<{ status: number, headers: import('node:http').IncomingHttpHeaders, size: number }>} */
function fetched(path, headers = {}) {
  return new Promise((resolve, reject) => get(server.url + path, { headers }, (response) => {
    let size = 0;
    response.on('data', (data) => { size += data.length; });
    response.on('end', () => resolve({ status: response.statusCode ?? 0, headers: response.headers, size }));
  }).on('error', reject));
}

test('files: compressed, tagged, guarded by a policy, small', async () => {
  const { page, context, errors } = await open(chromium, `${server.url}/#/robot/sim1`);
  await page.waitForFunction(() => /** @type {any} */ (window).station?.scene, undefined, { timeout: TIMEOUT });
  const paths = await page.evaluate(() => performance.getEntriesByType('resource').map((entry) => new URL(entry.name).pathname).filter((path) => !path.startsWith('/api/')));
  assert.ok(paths.length > 10, String(paths));
  let total = 0;
  // MCAP's reader is loaded for a recording alone.
  for (const path of ['/', '/mcap.js', '/vendor/mcap.js', ...paths]) {
    const answer = await fetched(path, { 'Accept-Encoding': 'gzip' });
    assert.equal(answer.status, 200, path);
    assert.match(String(answer.headers['content-security-policy']), /default-src 'none'; script-src 'self'; style-src 'self';/);
    assert.equal(answer.headers['x-content-type-options'], 'nosniff');
    total += answer.size;
    const again = await fetched(path, { 'If-None-Match': String(answer.headers.etag) });
    assert.deepEqual([again.status, again.size], [304, 0], path);
  }
  assert.ok(total < 700_000, `${total} bytes`);
  assert.equal((await fetched('/nothing.js')).status, 404);
  assert.equal((await fetched('/vendor.sh')).status, 404);
  const html = await (await fetch(server.url)).text();
  assert.doesNotMatch(html, /<script(?! type="module" src)|<style| style=| on\w+=|https?:\/\//);
  assert.deepEqual(errors, []);
  await context.close();
});

test('hostile names and messages are shown as text', async () => {
  const evil = '<img src=x onerror="window.hit=1"><script>hit=1</script>';
  const { page, context, errors } = await open(chromium, `${server.url}/#/robot/cell`);
  await says(page, '#state', /IDLE/);
  await page.click('#tab-traffic');
  await api(`${server.url}/api/robots/cell/lease`, 'POST', { client: evil, seconds: 60 });
  await says(page, '#driver', /^<img src=x onerror="window\.hit=1"><script>hit=1<\/script> drives: you watch$/);
  controller.send(Buffer.from(`${evil}\r\n`));
  await page.fill('#traffic-filter', '3C 69 6D 67');
  await says(page, '#traffic-rows', /3C 69 6D 67/);
  assert.ok(await page.locator('#traffic-rows tr.bad').count() > 0);
  await says(page, '#health', /Garbage\d{2,} bytes/);
  await page.goto(`${server.url}/#/robot/${encodeURIComponent(evil)}`);
  await says(page, '#fleet-note', /3 robots/);
  await api(`${server.url}/api/robots/cell/lease`, 'POST', { client: 'nobody', seconds: 1, force: true });
  assert.equal(await page.evaluate(() => document.querySelectorAll('img, script:not([src])').length + (/** @type {any} */ (window).hit ?? 0)), 0);
  assert.deepEqual(errors, []);
  await context.close();
});

test('the overview: what needs a person first', async () => {
  const { page, context, errors } = await open(chromium, server.url);
  await says(page, '#fleet-note', /3 robots, none needs a person/);
  controller.state = 'error';
  controller.report();
  await says(page, '#tiles li:first-child', /cell.*ERROR.*Needs a person: controller in error/);
  await says(page, '#fleet-note', /1 needs a person/);
  await picture(page, 'station-overview');
  controller.state = 'idle';
  controller.report();
  await says(page, '#tiles li:first-child', /On an end stop|Needs homing/);
  await page.keyboard.press('Escape');
  await says(page, '#cancel-all-note', /all 3 controllers have confirmed/);
  await page.click('#tiles a:has-text("sim2")');
  await says(page, '#title', /^sim2$/);
  await says(page, '#state', /IDLE/);
  assert.deepEqual(errors, []);
  await context.close();
});

test('accessible, in light and dark, narrow and wide', async () => {
  const axe = readFileSync(new URL('node_modules/axe-core/axe.min.js', import.meta.url), 'utf8');
  for (const [colorScheme, width, height] of /** @type {const} */ ([['light', 1280, 800], ['dark', 1280, 800], ['dark', 360, 740], ['light', 3840, 2160]])) {
    const { page, context } = await open(chromium, `${server.url}/#/robot/sim1`, { colorScheme, viewport: { width, height }, bypassCSP: true });
    await says(page, '#state', /IDLE/);
    for (const place of ['plot', 'traffic', 'path', 'recording', 'fleet', 'calibrate']) {
      if (place === 'fleet') await page.goto(`${server.url}/#/`);
      else if (place === 'recording') await page.goto(`${server.url}/#/recording`);
      else if (place === 'calibrate') {
        await page.goto(`${server.url}/#/robot/sim1`);
        await page.click('#calibrate-open');
      } else await page.click(`#tab-${place}`);
      await page.evaluate(axe);
      const { violations } = await page.evaluate(() => /** @type {any} */ (window).axe.run());
      const serious = violations.filter((/** @type {any} */ it) => ['serious', 'critical'].includes(it.impact))
        .map((/** @type {any} */ it) => `${place} ${colorScheme} ${width}: ${it.id}: ${it.nodes.map((/** @type {any} */ node) => `${node.target} ${node.failureSummary}`).slice(0, 4).join('; ')}`);
      assert.deepEqual(serious, []);
      // Nothing is wider than the screen, and Cancel is on it.
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${place} at ${width}`);
      if (place !== 'calibrate') {
        const box = await page.locator(place === 'fleet' ? '#cancel-all' : '#cancel').boundingBox();
        assert.ok(box && box.y >= 0 && box.y + box.height <= height && box.height >= 56, JSON.stringify(box));
      }
    }
    await context.close();
  }
});

test('the layout at 1280 by 800, and its picture', async () => {
  const { page, context, errors } = await open(chromium, `${server.url}/#/robot/cell`);
  await says(page, '#state', /IDLE/);
  await says(page, '#move-note', /^controller units: A 0 to 300, B 0 to 300, C 0 to 300$/);
  await drive(page);
  await home(page);
  for (const target of [[127.2, 79.1, 127.2], [140, 60, 100]]) {
    await move(page, target);
    await says(page, '#state', /MOVING/);
    await controller.glide(target, 30);
    controller.state = 'idle';
    controller.report();
    await standsAt(page, target.map((value) => value.toFixed(2)));
  }
  await move(page, [100, 120, 150]);
  await says(page, '#state', /MOVING/);
  await controller.glide([120, 90, 125], 10);
  await page.waitForFunction(() => /** @type {any} */ (window).station.scene?.drawn().ghost, undefined, { timeout: TIMEOUT });
  await picture(page, 'station');
  const box = async (/** @type {string} */ selector) => {
    const found = await page.locator(selector).boundingBox();
    assert.ok(found, selector);
    return found;
  };
  const [machine, dock, column, cancel] = [await box('#machine'), await box('#dock'), await box('#controls'), await box('#cancel')];
  assert.deepEqual([column.width, machine.width, dock.width, machine.x], [360, 920, 920, 0]);
  assert.ok(Math.abs(dock.y - machine.y - machine.height) < 2 && dock.y + dock.height <= 801);
  assert.ok(cancel.y + cancel.height > 780 && cancel.width > 330);
  // All of the column is seen without scrolling.
  assert.ok(await page.evaluate(() => { const part = document.querySelector('#controls-scroll'); return part && part.scrollHeight <= part.clientHeight; }));
  await page.keyboard.press('Escape');
  await says(page, '#state', /IDLE/);

  // What the plot has, as files.
  for (const [button, name, begins] of [['#plot-csv', 'displacements.csv', 'time,A,B,C,event'], ['#plot-png', 'displacements.png', '\x89PNG']]) {
    const [download] = await Promise.all([page.waitForEvent('download'), page.click(button)]);
    assert.equal(download.suggestedFilename(), name);
    const text = readFileSync(await download.path(), 'latin1');
    assert.ok(text.startsWith(begins));
    if (name.endsWith('csv')) assert.match(text, /Z,140,60,100,\r\n/);
  }
  // Dragging zooms, and a button shows all again.
  const span = () => page.evaluate(() => { const { min, max } = /** @type {any} */ (window).station.plot.chart.scales.x; return max - min; });
  const plot = await box('#plot-area .u-over');
  const all = await span();
  await page.mouse.move(plot.x + plot.width * 0.4, plot.y + 20);
  await page.mouse.down();
  await page.mouse.move(plot.x + plot.width * 0.6, plot.y + 30, { steps: 5 });
  await page.mouse.up();
  const part = await span();
  assert.ok(part > all * 0.15 && part < all * 0.4, `${part} of ${all}`);
  await page.click('#plot-all');
  await page.waitForFunction((all) => { const { min, max } = /** @type {any} */ (window).station.plot.chart.scales.x; return max - min >= all; }, all, { timeout: TIMEOUT });
  await page.click('#plot-pause');
  assert.equal(await page.getAttribute('#plot-pause', 'aria-pressed'), 'true');
  assert.deepEqual(errors, []);
  await context.close();
});

test(`a hundred reports a second for ${MEMORY_SECONDS} s take no more and more memory`, async (memory) => {
  const { page, context, errors } = await open(chromium, `${server.url}/#/robot/cell`);
  await says(page, '#state', /IDLE/);
  const tools = await context.newCDPSession(page);
  const used = async () => {
    await tools.send('HeapProfiler.collectGarbage');
    return (await tools.send('Runtime.getHeapUsage')).usedSize / 1e6;
  };
  const flood = controller.flood(100);
  const received = () => page.evaluate(() => /** @type {any} */ (window).station.traffic.total);
  /** @param {number} count */
  const until = (count) => page.waitForFunction((count) => /** @type {any} */ (window).station.traffic.total >= count, count, { timeout: 10 * TIMEOUT });
  await until(300);
  const [before, from] = [await used(), await received()];
  await until(from + MEMORY_SECONDS * 100);
  const after = await used();
  flood.stop();
  memory.diagnostic(`from ${before.toFixed(1)} to ${after.toFixed(1)} MB`);
  assert.ok(after - before < 20, `from ${before} to ${after} MB`);
  assert.deepEqual(errors, []);
  await context.close();
});
