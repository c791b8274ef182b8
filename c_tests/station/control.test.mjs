// A person drives: home, move, jog, cancel, by mouse and by keyboard; and two people, one driver.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Controller } from './controller.mjs';
import { GEOMETRY, TIMEOUT, api, browser, drive, home, inSpace, move, open, says, standsAt, start } from './browser.mjs';

/** @type {Awaited<ReturnType<typeof start>>} */
let server;
/** @type {import('playwright-core').Browser} */
let chromium;

before(async () => {
  server = await start(['--sim', '2', '--listen', '127.0.0.1:0']);
  chromium = await browser();
});
after(async () => {
  await chromium.close();
  await server.stop();
});

test('home, move, jog and cancel by mouse', async () => {
  const { page, context, errors } = await open(chromium, `${server.url}/#/robot/sim1`);
  await says(page, '#state', /IDLE/);
  await says(page, '#view-note', /geometry of this robot is not set/);
  await says(page, '#state-note', /position unknown/);
  assert.equal(await page.getAttribute('#home', 'aria-disabled'), 'true');
  await drive(page);
  await home(page);
  await says(page, '#where', /A0\.00PRESSED.*B0\.00PRESSED.*C0\.00PRESSED/);

  // Checked as one types.
  await page.fill('#target-0', 'ten');
  await says(page, '#move-note', /A: not a number/);
  assert.equal(await page.getAttribute('#target-0', 'aria-invalid'), 'true');
  assert.equal(await page.getAttribute('#move-go', 'aria-disabled'), 'true');
  await move(page, [10, '7,5', 12.5]);
  await standsAt(page, ['10.00', '7.50', '12.50']);
  await says(page, '#where', /A10\.00clear/);

  await page.click('#jog button:has-text("B+")');
  await standsAt(page, ['10.00', '10.00', '12.50']);
  await page.selectOption('#jog-arm-step', '5');
  await page.click('#jog button:has-text("A−")');
  await standsAt(page, ['5.00', '10.00', '12.50']);

  await move(page, [4000, 4000, 4000]);
  await says(page, '#state', /MOVING/);
  await page.click('#cancel');
  await says(page, '#cancel-note', /Cancelled: the controller has confirmed/);
  await says(page, '#state', /IDLE/);
  assert.ok(Number(await page.textContent('#where tr:nth-child(1) td')) < 3900);
  await page.click('#drive');
  await says(page, '#driver', /Nobody drives/);
  assert.deepEqual(errors, []);
  await context.close();
});

test('the same by keyboard', async () => {
  const { page, context, errors } = await open(chromium, `${server.url}/#/robot/sim2`);
  await says(page, '#state', /IDLE/);
  await page.focus('#drive');
  await page.keyboard.press('Enter');
  await says(page, '#driver', /^You drive/);
  await page.focus('#home');
  await page.keyboard.press('Enter');
  await standsAt(page, ['0.00', '0.00', '0.00']);
  await page.focus('#target-0');
  for (const value of ['20', '21', '22']) {
    await page.keyboard.type(value);
    await page.keyboard.press('Tab');
  }
  await page.focus('#target-2');
  await page.keyboard.press('Enter');
  await standsAt(page, ['20.00', '21.00', '22.00']);
  await page.focus('#jog button[aria-disabled=false]');
  await page.keyboard.press('q');
  await standsAt(page, ['22.50', '21.00', '22.00']);
  await page.focus('#jog button[aria-disabled=false]');
  await page.keyboard.press('d');
  await standsAt(page, ['22.50', '21.00', '19.50']);

  // Space in a field is a space; outside it cancels, even where a button has the focus, and presses nothing.
  for (const [key, place] of [['Escape', '#target-0'], ['Escape', '#tab-plot'], [' ', '#drive'], [' ', 'body']]) {
    await move(page, [5000, 5000, 5000]);
    await says(page, '#state', /MOVING/);
    if (place === 'body') await page.evaluate(() => /** @type {HTMLElement} */ (document.activeElement).blur()); else await page.focus(place);
    await page.keyboard.press(key);
    await says(page, '#cancel-note', /controller has confirmed/);
    await says(page, '#state', /IDLE/);
    await says(page, '#driver', /^You drive/);
  }
  await move(page, [6000, 6000, 6000]);
  await says(page, '#state', /MOVING/);
  await page.fill('#target-0', '');
  await page.focus('#target-0');
  await page.keyboard.press(' ');
  assert.equal(await page.inputValue('#target-0'), ' ');
  assert.equal(await page.textContent('#state'), 'MOVING');
  await page.keyboard.press('Escape');
  await says(page, '#state', /IDLE/);
  assert.deepEqual(errors, []);
  await context.close();
});

test('two browsers, one driver; everybody may cancel', async () => {
  const anna = await open(chromium, `${server.url}/#/robot/sim1`);
  const bert = await open(chromium, `${server.url}/#/robot/sim1`);
  await drive(anna.page);
  await says(bert.page, '#driver', /^station [0-9a-f]{4} drives: you watch/);
  assert.equal(await bert.page.getAttribute('#move-go', 'aria-disabled'), 'true');
  await home(anna.page);
  await move(anna.page, [3000, 3000, 3000]);
  await says(bert.page, '#state', /MOVING/);
  await says(bert.page, '#state-note', /move to 3000\.00 3000\.00 3000\.00, by station/);
  await bert.page.keyboard.press('Escape');
  await says(bert.page, '#cancel-note', /controller has confirmed/);
  await says(anna.page, '#state', /IDLE/);
  await says(anna.page, '#driver', /^You drive/);

  assert.equal(await bert.page.textContent('#drive'), 'Take over');
  await bert.page.click('#drive');
  await says(bert.page, '#driver', /^You drive/);
  await says(anna.page, '#driver', /drives: you watch/);
  // A driver whose page is gone drives no longer, and what moves is cancelled.
  await move(bert.page, [3000, 3000, 3000]);
  await says(anna.page, '#state', /MOVING/);
  await bert.context.close();
  await says(anna.page, '#driver', /Nobody drives/);
  await says(anna.page, '#state', /IDLE/);
  assert.deepEqual(anna.errors, []);
  await anna.context.close();
});

test('cancel while a thousand messages a second come in; unplugged and plugged', async () => {
  const controller = new Controller();
  await controller.plug();
  const own = await start([`cell=${controller.url}`, '--listen', '127.0.0.1:0']);
  // The only robot is shown at once.
  const { page, context, errors } = await open(chromium, own.url);
  await says(page, '#state', /IDLE/);
  await page.click('#tab-traffic');
  const flood = controller.flood(1000);
  await drive(page);
  for (let round = 0; round < 3; round += 1) {
    await move(page, [100, 100, 100]);
    await says(page, '#state', /MOVING/);
    await page.keyboard.press('Escape');
    await says(page, '#cancel-note', /controller has confirmed/);
    await says(page, '#state', /IDLE/);
    assert.equal(controller.state, 'idle');
  }
  assert.ok(flood.sent > 1000, `${flood.sent} reports`);
  flood.stop();

  // A page that is slow may have skipped what was sent in the flood; so it is sent until it is seen.
  await page.fill('#traffic-filter', 'cancel!');
  await page.focus('#tab-traffic');
  const rows = async () => String(await page.textContent('#traffic-rows'));
  for (let tries = 0; tries < 20 && !/CANCEL!24 43 00 A1 3A/.test(await rows()); tries += 1) {
    await page.keyboard.press('Escape');
    await page.waitForTimeout(1000);
  }
  assert.match(await rows(), /CANCEL!24 43 00 A1 3A/);

  controller.unplug();
  await says(page, '#state', /NO CONNECTION/);
  await says(page, '#view-note', /geometry|No connection/);
  // Cancel can't be confirmed, and is not shown as if it had been.
  await page.click('#cancel');
  await says(page, '#cancel-note', /NOT CONFIRMED/);
  await controller.plug();
  await says(page, '#state', /IDLE/);
  await page.keyboard.press('Escape');
  await says(page, '#cancel-note', /controller has confirmed/);

  // The server gone: nothing is shown as if it were known.
  await own.stop();
  await says(page, '#connection', /No connection to the server/);
  await says(page, '#state', /NO CONNECTION/);
  await page.keyboard.press('Escape');
  await says(page, '#cancel-note', /NOT CONFIRMED: the server can not be reached/);
  controller.unplug();
  assert.deepEqual(errors, []);
  await context.close();
});

test('a pose of the facts page stands where it should', async () => {
  const { page, context, errors } = await open(chromium, `${server.url}/#/robot/sim2`);
  await says(page, '#state', /IDLE/);
  // Set by the dialog, as a person would.
  await page.click('#calibrate-open');
  const values = { a1: [0.12, 0, 0.10], a2: [0.38, 0, 0.25], a3: [0.12, 0, 0.40] };
  for (const [point, at] of Object.entries(values)) for (const [axis, value] of at.entries()) await page.fill(`#cal-${point}${'xyz'[axis]}`, String(value));
  await page.fill('#cal-d_b1b3', '0.15');
  await page.fill('#cal-d_e', '0.08');
  for (const arm of [0, 1, 2]) for (const [what, value] of /** @type {const} */ ([['scale', '0.001'], ['offset', '0.3'], ['min', '0'], ['max', '300']])) await page.fill(`#cal-${what}${arm}`, value);
  await page.click('#calibrate button[type=submit]');
  await page.waitForFunction(() => !(/** @type {HTMLDialogElement} */ (document.querySelector('#calibrate')).open), undefined, { timeout: TIMEOUT });
  assert.deepEqual((await api(`${server.url}/api/robots/sim2`, 'GET')).geometry.joints, GEOMETRY.joints);

  await drive(page);
  await home(page);
  await page.selectOption('#move-kind', 'axes');
  await page.fill('#target-0', '0.25');
  await page.fill('#target-1', '0.4');
  await page.fill('#target-2', '0.25');
  await page.click('#move-go');
  // .4272294 .3791266 .4272294 of docs/kinematics.md
  await standsAt(page, ['127.23', '79.13', '127.23']);
  await says(page, '#cartesian', /X 250\.0 {2}Y 400\.0 {2}Z 250\.0 mm/);
  await inSpace(page);
  const drawn = await page.evaluate(() => {
    const { scene } = /** @type {any} */ (window).station;
    const { camera, parent } = scene;
    camera.updateMatrixWorld();
    // By hand: the camera's matrices, column by column, on the pose.
    const times = (/** @type {number[]} */ matrix, /** @type {number[]} */ vector) => [0, 1, 2, 3].map((row) => vector.reduce((sum, value, column) => sum + matrix[column * 4 + row] * value, 0));
    const [x, y, , w] = times(camera.projectionMatrix.elements, times(camera.matrixWorldInverse.elements, [0.25, 0.4, 0.25, 1]));
    const box = parent.getBoundingClientRect();
    return { ...scene.drawn(), expected: { x: box.left + (x / w + 1) / 2 * box.width, y: box.top + (1 - y / w) / 2 * box.height }, box: box.toJSON() };
  });
  for (const axis of /** @type {const} */ (['x', 'y'])) assert.ok(Math.abs(drawn.robot.tool[axis] - drawn.expected[axis]) < 0.5, JSON.stringify(drawn));
  assert.ok(drawn.robot.tool.x > 0 && drawn.robot.tool.x < drawn.box.right && drawn.robot.tool.y < drawn.box.bottom);
  // And there is something in its colour on the screen.
  const pixel = await page.evaluate(async ({ x, y }) => {
    const { scene } = /** @type {any} */ (window).station;
    scene.renderer.render(scene.scene, scene.camera);
    const canvas = document.createElement('canvas');
    const source = scene.renderer.domElement;
    [canvas.width, canvas.height] = [source.width, source.height];
    const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
    context.drawImage(source, 0, 0);
    const box = scene.parent.getBoundingClientRect();
    return [...context.getImageData((x - box.left) * source.width / box.width, (y - box.top) * source.height / box.height, 1, 1).data];
  }, drawn.robot.tool);
  assert.ok(pixel[0] > pixel[2] + 60, `the tool is orange, not ${pixel}`);

  await page.click('#jog button:has-text("Y+")');
  await says(page, '#cartesian', /X 250\.0 {2}Y 405\.0 {2}Z 250\.0 mm/);
  for (const [key, place] of /** @type {const} */ ([['ArrowLeft', 'X 245.0  Y 405.0  Z 250.0 mm'], ['ArrowDown', 'X 245.0  Y 400.0  Z 250.0 mm'], ['PageUp', 'X 245.0  Y 400.0  Z 255.0 mm']])) {
    await page.waitForSelector('#jog button[aria-disabled=false]:has-text("X+")');
    await page.focus('#jog button');
    await page.keyboard.press(key);
    await says(page, '#cartesian', new RegExp(`^${place}$`));
  }
  // A target is checked against the limits that the geometry has.
  await page.selectOption('#move-kind', 'arms');
  await page.fill('#target-1', '301');
  await says(page, '#move-note', /B: from 0 to 300/);
  assert.deepEqual(errors, []);
  await context.close();
});

test('scale and offset are computed from known poses', async () => {
  const { page, context, errors } = await open(chromium, `${server.url}/#/robot/sim1`);
  await says(page, '#state', /IDLE/);
  await drive(page);
  await home(page);
  const poses = [[0.25, 0.4, 0.25], [0.27, 0.43, 0.22], [0.22, 0.38, 0.28]];
  const { displacements } = await api(`${server.url}/api/kinematics/inverse`, 'POST', { geometry: GEOMETRY, poses });
  const close = () => page.click('#calibrate button:has-text("Close")');
  const note = '#calibrate [role=status]';
  for (const [at, pose] of poses.entries()) {
    const target = displacements[at].map((/** @type {number} */ value) => value.toFixed(2));
    await move(page, target);
    await standsAt(page, target);
    await page.click('#calibrate-open');
    if (at === 0) {
      for (const [point, joint] of GEOMETRY.joints.entries()) for (const [axis, value] of joint.entries()) await page.fill(`#cal-a${point + 1}${'xyz'[axis]}`, String(value));
      await page.fill('#cal-d_b1b3', String(GEOMETRY.edge));
      await page.fill('#cal-d_e', String(GEOMETRY.offset));
    }
    for (const [axis, value] of pose.entries()) await page.fill(`#cal-p${'xyz'[axis]}`, String(value));
    await page.click('#calibrate button:has-text("Add known pose")');
    if (at === 0) {
      await page.click('#calibrate button:has-text("Compute")');
      await says(page, note, /two known poses are needed/);
    }
    if (at < 2) await close();
  }
  await page.click('#calibrate button:has-text("Compute")');
  await says(page, note, /^Computed from 3 poses; the largest error of a leg is 0\.0\d mm/);
  for (const arm of [0, 1, 2]) {
    assert.ok(Math.abs(Number(await page.inputValue(`#cal-scale${arm}`)) - 0.001) < 2e-6);
    assert.ok(Math.abs(Number(await page.inputValue(`#cal-offset${arm}`)) - 0.3) < 1e-4);
  }
  await page.click('#calibrate button[type=submit]');
  await says(page, '#cartesian', /X (219\.9|220\.\d) {2}Y (379\.9|380\.\d) {2}Z (279\.9|280\.\d) mm/);
  await page.click('#drive');
  assert.deepEqual(errors, []);
  await context.close();
});
