// Puts the parts together: which view is shown, and what flows where.
import { Calibration } from './calibrate.js';
import { cancelButton, onCancelKeys } from './cancel.js';
import { Connection } from './connection.js';
import { by, enable, input, make, number, options, say, select } from './dom.js';
import { Fleet } from './fleet.js';
import { Panel, headline } from './panel.js';
import { Playback } from './playback.js';
import { Plot } from './plot.js';
import { Recorded } from './recorded.js';
import { Traffic } from './traffic.js';

/** @typedef {import('./robot.js').Robot} Robot */
/** @typedef {import('./robot.js').Entry} Entry */

const connection = new Connection();
/** What the robot's view shows. @type {Robot | null} */
let shown = null;
const current = () => shown;

const plot = new Plot(by('plot-area'), by('plot-values'));
const traffic = new Traffic();
const panel = new Panel(current);
const fleet = new Fleet();
new Calibration(current);
const recorded = new Recorded();
const playback = new Playback(() => {
  recorded.reset();
  clear();
}, (entries) => {
  entries.forEach(showEntry);
  recorded.feed(entries);
});

const cancel = cancelButton('cancel', async () => (shown && shown !== recorded.robot ? shown.cancel() : cancelAll()));
const allCancel = cancelButton('cancel-all', cancelAll);

async function cancelAll() {
  const robots = [...connection.robots.values()];
  if (!robots.length) throw new Error('no robot is known');
  const outcomes = await Promise.allSettled(robots.map((robot) => robot.cancel()));
  const failed = outcomes.flatMap((outcome, at) => (outcome.status === 'rejected' ? [`${robots[at].name}: ${outcome.reason.message}`] : []));
  if (failed.length) throw new Error(failed.join('; '));
  return `Cancelled: all ${robots.length} controllers have confirmed`;
}

onCancelKeys(() => (by('fleet').hidden ? cancel : allCancel).press());

// Views

/** The geometry that the scene was built for. */
let built = '';
let spoken = '';

function clear() {
  plot.clear();
  traffic.clear();
  space?.scene.clearTrace();
}

/** What draws in three dimensions. @type {{ scene: import('./scene.js').MachineScene, paths: import('./path.js').PathPanel } | null} */
let space = null;
/** Why it can't. */
let noSpace = '';

/** @type {Promise<void> | undefined} */
let loading;

/** Loads that once a robot is shown: it is the largest part, and what the robot does is seen without it. */
async function loadSpace() {
  try {
    const [{ MachineScene }, { PathPanel }] = await Promise.all([import('./scene.js'), import('./path.js')]);
    const scene = new MachineScene(by('view'));
    space = { scene, paths: new PathPanel(current, scene) };
    space.paths.show(!by('path').hidden);
  } catch (error) {
    noSpace = `The machine can not be drawn here: ${error instanceof Error ? error.message : error}`;
    by('path').append(make('p', { class: 'bad' }, noSpace));
  }
  if (shown) render(shown);
}

/** @param {Robot | null} robot */
function show(robot) {
  if (robot === shown) return;
  shown?.watch(null);
  shown = robot;
  built = '';
  clear();
  cancel.clear();
  space?.paths.reset();
  by('robot').hidden = robot === null;
  by('playback').hidden = robot !== recorded.robot;
  if (robot === null) return;
  if (robot !== recorded.robot) robot.watch(showEntry);
  render(robot);
  panel.changeKind();
  loading ??= loadSpace();
}

function route() {
  const [, view, name] = location.hash.split('/');
  const only = connection.robots.size === 1 ? [...connection.robots.values()][0] : null;
  by('to-fleet').hidden = only !== null;
  let wanted = view === 'robot' && name ? connection.robots.get(decodeURIComponent(name)) ?? null : null;
  if (view === 'recording') wanted = recorded.robot;
  else if (view !== 'robot') wanted = only;
  show(wanted);
  by('fleet').hidden = wanted !== null;
  say(by('title'), wanted?.name ?? 'Station');
  document.title = wanted ? `${wanted.name} · Station` : 'Station';
  for (const [id, active] of /** @type {const} */ ([['to-fleet', wanted === null], ['to-playback', wanted === recorded.robot]])) {
    if (active) by(id).setAttribute('aria-current', 'page'); else by(id).removeAttribute('aria-current');
  }
  fleet.updateSoon(connection.robots.values());
}

let isDue = false;

/** A robot's state is another: shown soon, however many states come. @param {Robot} robot */
function update(robot) {
  fleet.updateSoon(connection.robots.values());
  if (robot !== shown || isDue) return;
  isDue = true;
  setTimeout(() => {
    isDue = false;
    if (shown) render(shown);
  }, 40);
}

/** Shows what a robot's state is now. @param {Robot} robot */
function render(robot) {
  const { state } = robot;
  showPlace(robot);
  panel.update();
  if (space) draw(robot, space);
  const word = `${robot.name}: ${headline(state)[0]}`;
  if (word !== spoken) say(by('announce'), word);
  spoken = word;
}

/** @param {Robot} robot @param {NonNullable<typeof space>} space */
function draw({ state, targetPose }, { scene, paths }) {
  const geometry = JSON.stringify([state.machine, state.lengths]);
  if (geometry !== built) {
    if (built !== '') paths.reset();
    built = geometry;
    scene.setMachine(state.machine, state.lengths);
  }
  scene.setStops(state.stops);
  scene.setPose(state.pose, targetPose);
  paths.update();
}

/** The machine, or bars where no pose is known, unless one draws on a plane. @param {Robot} robot */
function showPlace({ state }) {
  const drawn = noSpace === '' && state.machine !== null && (state.pose !== null || !by('path').hidden);
  by('view').hidden = !drawn;
  by('bars').hidden = drawn;
  const why = noSpace ? noSpace : state.machine === null ? 'The geometry of this robot is not set: only displacements can be shown.'
    : state.displacements === null ? 'The position is unknown: no pose is shown.'
      : state.pose === null ? 'No pose has these displacements.' : '';
  say(by('view-note'), state.stale && why === '' ? 'No connection: this is where it was last.' : why);
  if (by('bars').hidden) return;
  const bars = by('bars');
  if (!bars.children.length) {
    bars.append(...['A', 'B', 'C'].map((arm, at) => make('div', { class: 'bar', 'data-arm': String(at) }, make('span', { class: 'arm' }, arm), make('div', { class: 'track' }, make('i')), make('span'))));
  }
  [...bars.children].forEach((bar, arm) => {
    const value = state.displacements?.[arm];
    const [low, high] = state.limits?.[arm] ?? [0, Math.max(100, value ?? 0)];
    const part = value == null ? 0 : Math.min(Math.max((value - low) / (high - low), 0), 1);
    const fill = bar.querySelector('i');
    if (fill) fill.style.height = `${part * 100}%`;
    say(bar.children[2], value == null ? 'unknown' : number(value));
  });
  bars.setAttribute('aria-label', `Displacements: ${['A', 'B', 'C'].map((arm, at) => `${arm} ${number(state.displacements?.[at])}`).join(', ')}`);
}

/** @param {Entry} entry */
function showEntry(entry) {
  if (entry.displacements !== undefined) plot.add(entry.time, entry.displacements ?? [null, null, null]);
  if (entry.event) plot.addEvent(entry.time, entry.event);
  if (entry.pose) space?.paths.addReached(entry.pose);
  if (entry.traffic) traffic.add(entry.traffic);
}

// The page's own controls

const tabs = ['plot', 'traffic', 'path'];
/** @param {string} name */
function openTab(name) {
  for (const tab of tabs) {
    by(`tab-${tab}`).setAttribute('aria-selected', String(tab === name));
    by(`tab-${tab}`).tabIndex = tab === name ? 0 : -1;
    by(tab).hidden = tab !== name;
  }
  if (shown) showPlace(shown);
  space?.paths.show(name === 'path');
  plot.draw();
  traffic.draw();
}
tabs.forEach((tab, at) => {
  by(`tab-${tab}`).addEventListener('click', () => openTab(tab));
  by(`tab-${tab}`).addEventListener('keydown', ({ key }) => {
    const step = { ArrowRight: 1, ArrowLeft: tabs.length - 1 }[key];
    if (step === undefined) return;
    const next = tabs[(at + step) % tabs.length];
    openTab(next);
    by(`tab-${next}`).focus();
  });
});

/** @param {string} id @param {{ pause: (paused: boolean) => void }} view */
function pauseButton(id, view) {
  by(id).addEventListener('click', () => {
    const paused = by(id).getAttribute('aria-pressed') !== 'true';
    by(id).setAttribute('aria-pressed', String(paused));
    view.pause(paused);
  });
}
pauseButton('plot-pause', plot);
pauseButton('traffic-pause', traffic);
by('plot-all').addEventListener('click', () => plot.showAll());
by('plot-csv').addEventListener('click', () => plot.saveCsv());
by('plot-png').addEventListener('click', () => plot.savePng());
by('view-reset').addEventListener('click', () => space?.scene.resetView());
by('trace-clear').addEventListener('click', () => space?.scene.clearTrace());

select('theme').value = localStorage.getItem('theme') ?? '';
function theme() {
  const { value } = select('theme');
  if (value) document.documentElement.dataset.theme = value; else delete document.documentElement.dataset.theme;
  localStorage.setItem('theme', value);
  document.dispatchEvent(new Event('themechange'));
}
select('theme').addEventListener('change', theme);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => document.dispatchEvent(new Event('themechange')));
theme();

input('playback-file').addEventListener('change', async () => {
  const file = input('playback-file').files?.[0];
  if (!file) return;
  say(by('playback-warning'), '');
  try {
    say(by('playback-note'), `${file.name}: being read…`);
    const warning = await recorded.read(file);
    options('playback-robot', [...recorded.stories.keys()].sort());
    by('playback-robots').hidden = recorded.stories.size < 2;
    await openStory();
    say(by('playback-warning'), warning);
  } catch (error) {
    say(by('playback-note'), `${file.name}: ${error instanceof Error ? error.message : error}`);
  }
  enable(by('playback-play'), playback.entries.length > 0);
});

/** Plays one robot of a recording, by the geometry of the robot of that name, or of the first that has one. */
async function openStory() {
  const name = select('playback-robot').value;
  say(by('playback-note'), 'Being read…');
  const able = [...connection.robots.values()].filter((robot) => robot.state.geometry);
  const like = able.find((robot) => robot.name === name) ?? able[0];
  playback.open(await recorded.story(name, like?.state ?? null));
}
select('playback-robot').addEventListener('change', () => openStory().catch((error) => say(by('playback-note'), error.message)));

recorded.robot.changed = update;
connection.onRobots = route;
connection.onUpdate = update;
connection.onRefused = (text) => panel.noteMove(text, true);
connection.onLink = (text, bad) => {
  say(by('connection'), text);
  by('connection').toggleAttribute('data-bad', bad);
};
window.addEventListener('hashchange', route);
route();
connection.open();

// For the tests, and for whoever looks for an error.
/** @type {any} */ (window).station = { plot, traffic, connection, robot: current, get scene() { return space?.scene; }, get paths() { return space?.paths; } };
