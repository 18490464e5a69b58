// @ts-check
// What is around the virtual controller: its emergency stop and its switches, to be pressed and let go.

import { element, showText } from '../../ui/dom.js';
import { enable } from './section.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').DeviceInput} DeviceInput */

const NONE = 'None of its inputs is for anything: give them roles in its settings, and they can be pressed here.';
const HOW = 'A limit switch is pressed where its axis is, and let go 1,000 steps further on; until then there is none.';

/** @param {{press: (device: Device, input: DeviceInput, isPressed: boolean) => void}} handlers */
export function createSurroundings({ press }) {
  /** @type {Device | null} */
  let now = null;
  const line = element('div', { className: 'virtual-inputs' });
  const note = element('p', { className: 'reason' });
  const whole = element('details', { id: 'surroundings' }, element('summary', { textContent: 'Virtual switches of the virtual controller' }), line, note);
  /** @type {HTMLButtonElement[]} */
  let buttons = [];

  /** @param {number} at */
  function pressed(at) {
    const input = now?.inputs?.[at];
    if (now && input) press(now, input, !input.is_active);
  }

  return {
    element: whole,
    /** @param {import('./section.js').Context} context */
    show({ device, isVirtual, inTheWay, situation }) {
      now = device;
      const inputs = device?.inputs ?? [];
      whole.hidden = !isVirtual || !device?.inputs;
      showText(note, inputs.length === 0 ? NONE : HOW);
      if (buttons.length !== inputs.length) {
        buttons = inputs.map((_, at) => element('button', { className: 'button small', type: 'button', onclick: () => pressed(at) }));
        line.replaceChildren(...buttons);
      }
      inputs.forEach((input, at) => {
        const button = buttons[at];
        button.id = `press-${input.input}`;
        showText(button, `${input.is_active ? 'Release' : 'Press'} ${nameOf(input)} (${input.input})`);
        enable(button, inTheWay === '' && !situation.isBusy);
      });
    },
  };
}

/** @param {DeviceInput} input */
function nameOf({ role, axis, end }) {
  if (role === 'limit') return `the ${end} switch of axis ${axis}`;
  return role === 'emergency_stop' ? 'the emergency stop' : 'the driver’s fault';
}
