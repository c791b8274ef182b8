// Cancel: works from anywhere, without the lease, and counts as done only when the controller has said so.
import { by, say } from './dom.js';

/** Whether a key goes into the text or the choice of a field. @param {EventTarget | null} target */
function isField(target) {
  return target instanceof HTMLInputElement || target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement
    || (target instanceof HTMLElement && target.isContentEditable);
}

/** @param {() => void} act for Escape anywhere, and Space outside of fields */
export function onCancelKeys(act) {
  let spaceDown = false;
  window.addEventListener('keydown', (event) => {
    spaceDown = event.key === ' ' && !isField(event.target);
    if (event.key !== 'Escape' && !spaceDown) return;
    // Space would press the button that has the focus besides.
    if (spaceDown) event.preventDefault();
    if (!event.repeat) act();
  }, { capture: true });
  window.addEventListener('keyup', (event) => {
    if (event.key === ' ' && spaceDown) event.preventDefault();
  }, { capture: true });
}

/**
 * A button that cancels and says how that went.
 * @param {string} id of the button; what is said goes into `id-note`
 * @param {() => Promise<string>} act ends when the controllers have answered, with what to say
 */
export function cancelButton(id, act) {
  const note = by(`${id}-note`);
  let latest = 0;
  const press = async () => {
    latest += 1;
    const mine = latest;
    note.className = '';
    say(note, 'Cancel sent: waiting for the controller…');
    try {
      const said = await act();
      if (mine === latest) say(note, said);
    } catch (error) {
      if (mine !== latest) return;
      note.className = 'bad';
      say(note, `NOT CONFIRMED: ${error instanceof Error ? error.message : error}. Press again.`);
    }
  };
  by(id).addEventListener('click', press);
  return { press, clear: () => { latest += 1; say(note, ''); } };
}
