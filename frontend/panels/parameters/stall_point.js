// @ts-check
// Where the motor was seen to stall: noted and taken away by a button; its two numbers are rows of the group.

import { isOpen } from '../../model/motor_fields.js';
import { element, showMessage } from '../../ui/dom.js';

/** @typedef {import('../../model/types.js').Design} Design */

const STALLED = 'motor.stalled';
/** @typedef {(name: import('../../model/measured.js').Measured, value: unknown, gesture?: string) => void} OnMeasured */
const NOTE = 'Note where it stalled';

/** @param {OnMeasured} onMeasured @param {HTMLElement} first of the rows of its numbers */
export function createStallPoint(onMeasured, first) {
  let isThere = false;
  const button = element('button', { className: 'button small', id: 'stall-point', type: 'button', textContent: NOTE, onclick: toggle });
  const box = element('div', { className: 'messages' });

  /** Its numbers are to be typed: none that was made up could pass for a measured one. */
  function toggle() {
    onMeasured('stalled', isThere ? undefined : { rpm: '', torque_nm: '' });
    if (isThere) first.querySelector('input')?.focus();
  }

  return {
    element: element('div', { className: 'motor-measure' }, button, box),
    /** @param {Design} design */
    show(design) {
      isThere = !isOpen(design.motor?.stalled);
      button.textContent = isThere ? 'Forget the stall point' : NOTE;
    },
    /** @param {import('../../model/messages.js').Messages['fields']} messages */
    showMessage: (messages) => showMessage(button, box, messages.get(STALLED)),
  };
}
