// `deltarobot ui`, as a person starts it.
import assert from 'node:assert/strict';
import { once } from 'node:events';
import { existsSync, mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { Controller } from './controller.mjs';
import { TIMEOUT, PROGRAM, browser, open, says, start, until } from './browser.mjs';

const UI = process.env.DELTAROBOT_UI ?? PROGRAM.replace(/-serve$/, '-ui');

test('opens the page of one robot in the browser, and ends when told', async () => {
  const directory = mkdtempSync(join(tmpdir(), 'station-'));
  const [stand_in, opened, geometry] = ['browser', 'opened', 'geometry.toml'].map((name) => join(directory, name));
  writeFileSync(stand_in, '#!/bin/sh\nprintf "%s\\n" "$@" >"$OPENED.new" && mv "$OPENED.new" "$OPENED"\n', { mode: 0o755 });
  writeFileSync(geometry, readFileSync(new URL('../../examples/geometry.toml', import.meta.url)));
  const controller = new Controller();
  await controller.plug();
  const chromium = await browser();
  const ui = await start([controller.url, '--geometry', geometry], UI, { BROWSER: stand_in, OPENED: opened });
  try {
    await until(() => existsSync(opened));
    const url = readFileSync(opened, 'utf8').trim();
    assert.equal(url, ui.url);
    assert.match(url, /^http:\/\/127\.0\.0\.1:\d+$/);
    const { page, errors } = await open(chromium, url);
    await says(page, '#state', /IDLE/);
    // One robot: there is no overview to go to. Its geometry is what the file says.
    assert.ok(await page.locator('#to-fleet').isHidden());
    await page.waitForFunction(() => /** @type {any} */ (window).station.robot()?.state.machine, undefined, { timeout: TIMEOUT });
    const ended = once(ui.child, 'exit');
    ui.child.kill('SIGINT');
    assert.deepEqual(await ended, [0, null]);
    await says(page, '#connection', /No connection to the server/);
    assert.deepEqual(errors, []);
  } finally {
    await ui.stop();
    await chromium.close();
    controller.unplug();
  }
});

test('a browser that can not be started is said, and the page is there', async () => {
  const ui = await start(['--sim'], UI, { BROWSER: '/nowhere/browser' });
  try {
    assert.equal((await fetch(ui.url)).status, 200);
  } finally {
    await ui.stop();
  }
});
