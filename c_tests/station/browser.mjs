// What all tests of the station need: the program with its robots, a browser, and how to wait for what a person sees.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { createInterface } from 'node:readline';
import { chromium } from 'playwright-core';

export const PROGRAM = process.env.DELTAROBOT_SERVE ?? '../../target/debug/deltarobot-serve';
/** What has not come by then won't come, however slow the machine. */
export const TIMEOUT = 120_000;

/** The robot of docs/kinematics.md, with displacements in millimetres. */
export const GEOMETRY = {
  joints: [[0.12, 0, 0.10], [0.38, 0, 0.25], [0.12, 0, 0.40]], edge: 0.15, offset: 0.08,
  arms: [0, 1, 2].map(() => ({ scale: 0.001, offset: 0.3, min: 0, max: 300 })),
};

/**
 * Starts a program and waits for the address it prints.
 * @param {string[]} words
 */
export async function start(words, program = PROGRAM, env = {}) {
  const child = spawn(program, words, { stdio: ['ignore', 'pipe', 'inherit'], env: { ...process.env, ...env } });
  const lines = createInterface({ input: child.stdout });
  const url = await new Promise((resolve, reject) => {
    lines.on('line', (line) => { if (line.startsWith('http://')) resolve(line); });
    child.on('exit', (code) => reject(new Error(`${program} has ended with ${code}`)));
    child.on('error', reject);
  });
  return {
    url: String(url),
    child,
    async stop(signal = 'SIGTERM') {
      if (child.exitCode !== null) return;
      child.kill(/** @type {NodeJS.Signals} */ (signal));
      await once(child, 'exit');
    },
  };
}

/** Waits until that is so. @param {() => boolean | Promise<boolean>} isSo */
export async function until(isSo) {
  for (const began = Date.now(); !(await isSo()); await new Promise((resolve) => setTimeout(resolve, 50))) assert.ok(Date.now() < began + TIMEOUT);
}

/** @param {string} url @param {string} method @param {unknown} [body] @param {Record<string, string>} [headers] */
export async function api(url, method, body, headers = {}) {
  const response = await fetch(url, { method, headers: { 'Content-Type': 'application/json', ...headers }, body: body === undefined ? undefined : JSON.stringify(body) });
  const text = await response.text();
  assert.ok(response.ok, `${method} ${url}: ${response.status} ${text}`);
  return text ? JSON.parse(text) : null;
}

/** @param {string[]} [more] words of its command line */
export async function browser(more = []) {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', ...more],
  });
}

/**
 * A page of its own, with its own storage, that fails the test when a script of it fails.
 * @param {import('playwright-core').Browser} browser
 * @param {string} url
 * @param {import('playwright-core').BrowserContextOptions} [options]
 */
export async function open(browser, url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  context.setDefaultTimeout(TIMEOUT);
  const page = await context.newPage();
  /** @type {string[]} */
  const errors = [];
  page.on('pageerror', (error) => errors.push(String(error)));
  page.on('console', (message) => {
    // What the network refuses is part of some tests; what the policy of the page refuses never is.
    if (message.type() === 'error' && !/Failed to load resource|WebSocket connection/.test(message.text())) errors.push(message.text());
  });
  await page.goto(url);
  return { page, context, errors };
}

/** Waits until an element says so. @param {import('playwright-core').Page} page @param {string} selector @param {RegExp} text */
export async function says(page, selector, text) {
  const element = page.locator(selector);
  try {
    await page.waitForFunction(([selector, source, flags]) => new RegExp(source, flags).test(document.querySelector(selector)?.textContent ?? ''),
      [selector, text.source, text.flags], { timeout: TIMEOUT });
  } catch {
    assert.fail(`${selector} says "${await element.textContent()}" instead of ${text}`);
  }
}

/** Waits until three.js is there, which is loaded when all else is shown. @param {import('playwright-core').Page} page */
export async function inSpace(page) {
  await page.waitForFunction(() => /** @type {any} */ (window).station?.scene?.drawn().robot, undefined, { timeout: TIMEOUT });
}

/** @param {import('playwright-core').Page} page */
export async function drive(page) {
  await page.click('#drive');
  await says(page, '#driver', /^You drive/);
}

/** @param {import('playwright-core').Page} page */
export async function home(page) {
  await page.click('#home');
  await says(page, '#state', /IDLE/);
  await page.waitForFunction(() => [...document.querySelectorAll('#where td:nth-child(2)')].every((cell) => cell.textContent === '0.00'), undefined, { timeout: TIMEOUT });
}

/** @param {import('playwright-core').Page} page @param {(number | string)[]} target */
export async function move(page, target) {
  for (const [at, value] of target.entries()) await page.fill(`#target-${at}`, String(value));
  await page.click('#move-go[aria-disabled=false]');
}

/** @param {import('playwright-core').Page} page @param {string[]} target as it is shown */
export async function standsAt(page, target) {
  await page.waitForFunction((target) => {
    const cells = [...document.querySelectorAll('#where td:nth-child(2)')].map((cell) => cell.textContent);
    return target.every((value, arm) => cells[arm] === value) && document.querySelector('#state')?.textContent === 'IDLE';
  }, target, { timeout: TIMEOUT });
}

/** Takes a picture: one of docs/images where DP_STATION_PICTURES=1. @param {import('playwright-core').Page} page @param {string} name */
export async function picture(page, name) {
  const path = new URL(`../../docs/images/${name}.png`, import.meta.url).pathname;
  const bytes = await page.screenshot({ scale: 'css', ...(process.env.DP_STATION_PICTURES === '1' ? { path } : {}) });
  assert.ok(bytes.length > 10_000, `${name} is empty`);
}
