// Servers that demand a token: the page asks for it, and keeps it for the session.
import assert from 'node:assert/strict';
import { mkdtempSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { TIMEOUT, browser, drive, home, open, says, start } from './browser.mjs';

const [DRIVE, WATCH] = ['drive-0123456789abcdef', 'watch~0123456789.abcdef'];

test('a token is asked for, kept, and sent with everything', async () => {
  const directory = mkdtempSync(join(tmpdir(), 'station-'));
  const files = [DRIVE, WATCH].map((token) => {
    const path = join(directory, token);
    writeFileSync(path, `${token}\n`, { mode: 0o600 });
    return path;
  });
  const server = await start(['--sim', '1', '--listen', '127.0.0.1:0', '--token-file', files[0], '--watch-token-file', files[1]]);
  const chromium = await browser();
  try {
    const url = server.url;
    const { page, context, errors } = await open(chromium, url);
    await page.waitForSelector('#token-value', { timeout: TIMEOUT });
    // Without a robot there is nothing to cancel, and Escape does not shut the question away.
    await page.keyboard.press('Escape');
    await says(page, '#cancel-all-note', /NOT CONFIRMED: no robot is known/);
    await page.waitForSelector('#token-value:focus', { timeout: TIMEOUT });
    await page.keyboard.type('short');
    await page.keyboard.press('Enter');
    await says(page, '#token-note', /16 to 256/);
    await page.fill('#token-value', 'a-wrong-one-of-16-letters');
    await page.keyboard.press('Enter');
    await says(page, '#token-note', /does not know this token/);
    await page.fill('#token-value', DRIVE);
    await page.keyboard.press('Enter');
    await says(page, '#state', /IDLE/);
    // By HTTP and by both WebSockets.
    await drive(page);
    await home(page);
    await page.click('#tab-traffic');
    await says(page, '#traffic-count', /[1-9]\d* messages/);
    assert.ok(!page.url().includes(DRIVE));
    await page.reload();
    await says(page, '#state', /IDLE/);
    await context.close();

    // Who may only watch, may cancel too.
    const watcher = await open(chromium, url);
    await watcher.page.fill('#token-value', WATCH);
    await watcher.page.keyboard.press('Enter');
    await says(watcher.page, '#state', /IDLE/);
    await watcher.page.click('#drive');
    await says(watcher.page, '#move-note', /for watching and cancelling alone/);
    await watcher.page.keyboard.press('Escape');
    await says(watcher.page, '#cancel-note', /controller has confirmed/);
    assert.deepEqual([...errors, ...watcher.errors], []);
  } finally {
    await chromium.close();
    await server.stop();
  }
});
