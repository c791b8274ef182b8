// Jog pads: one press, one step, by the arms' displacements or along the machine's axes.
import { by, enable, make, options, select, usable } from './dom.js';

/** Key, where it goes, and its name on the pad. @type {[string, 'arms' | 'axes', number, number, string][]} */
const PADS = [
  ['q', 'arms', 0, 1, 'A+'], ['w', 'arms', 1, 1, 'B+'], ['e', 'arms', 2, 1, 'C+'],
  ['ArrowRight', 'axes', 0, 1, 'X+'], ['ArrowUp', 'axes', 1, 1, 'Y+'], ['PageUp', 'axes', 2, 1, 'Z+'],
  ['a', 'arms', 0, -1, 'A−'], ['s', 'arms', 1, -1, 'B−'], ['d', 'arms', 2, -1, 'C−'],
  ['ArrowLeft', 'axes', 0, -1, 'X−'], ['ArrowDown', 'axes', 1, -1, 'Y−'], ['PageDown', 'axes', 2, -1, 'Z−'],
];

export class Jog {
  /** @param {(kind: 'arms' | 'axes', index: number, step: number) => void} act */
  constructor(act) {
    const group = by('jog');
    options('jog-arm-step', ['0.1', '0.5', '1', '2.5', '5', '10']);
    options('jog-axis-step', ['0.0001', '0.001', '0.005', '0.01', '0.05'], ['0.1 mm', '1 mm', '5 mm', '10 mm', '50 mm']);
    select('jog-arm-step').value = '2.5';
    select('jog-axis-step').value = '0.005';
    this.buttons = PADS.map(([key, kind, index, sign, name]) => {
      const button = make('button', { type: 'button', 'data-kind': kind, 'data-arm': kind === 'arms' ? String(index) : '', 'aria-keyshortcuts': key,
        'aria-label': `${kind === 'arms' ? 'Arm' : 'Axis'} ${name[0]} ${sign > 0 ? 'plus' : 'minus'}` }, name);
      button.addEventListener('click', () => {
        if (!usable(button)) return;
        act(kind, index, sign * Number(select(kind === 'arms' ? 'jog-arm-step' : 'jog-axis-step').value));
      });
      group.append(button);
      return button;
    });
    group.addEventListener('keydown', (event) => {
      const pad = PADS.findIndex(([key]) => key.toLowerCase() === event.key.toLowerCase());
      // A key that is held down must not pile up steps.
      if (pad < 0 || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      if (!event.repeat) this.buttons[pad].click();
    });
  }

  /** @param {string} armsWhyNot empty when it may jog @param {string} axesWhyNot */
  enable(armsWhyNot, axesWhyNot) {
    for (const button of this.buttons) {
      const why = button.dataset.kind === 'arms' ? armsWhyNot : axesWhyNot;
      enable(button, why === '', why);
    }
  }
}
