// MCAP records (docs/program.md): states, messages and events of each robot in them. Whatever else is in a file is skipped.
import McapStreamReader from './vendor/mcap.js';
import { endText } from './robot.js';

/** @typedef {import('./recorded.js').Story} Story */
/** @typedef {import('./kinematics.js').Vec} Vec */
/** @typedef {{ link: string, note: string, story: Story }} Line */

const ARMS = ['A', 'B', 'C'];
const text = (/** @type {unknown} */ value) => (typeof value === 'string' ? value : '');

/** @param {any} value @returns {Vec | null} */
const vec = (value) => (Array.isArray(value) && value.length === 3 && value.every(Number.isFinite) ? /** @type {Vec} */ (value) : null);

/** What an event is in words, or nothing. @param {any} event */
function eventText({ event, link, error, operation, driver, run }) {
  if (event === 'link') return `link ${text(link)}${error ? `: ${text(error)}` : ''}`;
  if (event === 'ended') return endText(operation ?? {});
  if (event === 'driver') return driver ? `${text(driver.client)} drives` : 'nobody drives';
  if (event === 'path') return run?.state === 'running' ? '' : `path ${text(run?.state)}`;
  return text(event);
}

/** What each channel's messages add. @type {Record<string, (line: Line, time: number, json: any) => void>} */
const CHANNELS = {
  state({ link, note, story }, time, { state, position, stops }) {
    const word = text(state).toLowerCase();
    story.push({ time, state: {
      link, linkNote: note, state: word === 'unknown' || word === '' ? null : word, stale: link !== 'connected', displacements: vec(position),
      stops: ARMS.map((arm) => Array.isArray(stops) && stops.includes(arm)),
    } });
  },
  messages({ story }, time, json) {
    story.push({ time, traffic: { time, from: text(json.from), text: text(json.text), bytes: text(json.bytes ?? json.garbage), bad: 'garbage' in json } });
  },
  events(line, time, json) {
    if (json.event === 'link') [line.link, line.note] = [json.link === 'up' ? 'connected' : text(json.link), text(json.error)];
    const event = eventText(json);
    if (event) line.story.push({ time, event });
  },
};

/**
 * Reads a file as far as that goes: one that was cut off ends with its last chunk.
 * @param {Blob} file
 * @returns {Promise<{ stories: Map<string, Story>, warning: string }>} what happened to each robot, and what could not be read
 */
export async function readMcap(file) {
  /** @type {Map<string, Line>} */
  const lines = new Map();
  /** @type {Map<number, { line: Line, add: (typeof CHANNELS)[string] }>} */
  const channels = new Map();
  const reader = new McapStreamReader();
  const decoder = new TextDecoder();

  /** @param {NonNullable<ReturnType<typeof reader.nextRecord>>} record */
  function take(record) {
    if (record.type === 'Channel') {
      const [name, kind] = [record.metadata.get('robot'), record.topic.slice(record.topic.lastIndexOf('/') + 1)];
      if (name === undefined || !Object.hasOwn(CHANNELS, kind) || record.messageEncoding !== 'json') return;
      const line = lines.get(name) ?? { link: 'connected', note: '', story: [] };
      lines.set(name, line);
      channels.set(record.id, { line, add: CHANNELS[kind] });
    } else if (record.type === 'Message') {
      const channel = channels.get(record.channelId);
      const json = channel && JSON.parse(decoder.decode(record.data));
      if (json) channel.add(channel.line, Number(record.logTime) / 1e9, json);
    }
  }

  let warning = '';
  const input = file.stream().getReader();
  try {
    for (let part; (part = await input.read()).value;) {
      reader.append(part.value);
      for (let record; (record = reader.nextRecord());) take(record);
    }
    if (!reader.done()) warning = 'It was not ended: what is there up to its last chunk is shown.';
  } catch (error) {
    const why = error instanceof Error ? error.message : String(error);
    const hint = why.startsWith('Unsupported compression') ? ' (`mcap compress --compression none` makes a file that is not compressed)' : '';
    warning = `It can be read up to a fault alone, and that is shown: ${why}${hint}.`;
  }
  for (const { story } of lines.values()) story.sort((one, other) => one.time - other.time);
  const told = [...lines].filter(([, { story }]) => story.length > 0);
  return { stories: new Map(told.map(([name, { story }]) => [name, story])), warning };
}
