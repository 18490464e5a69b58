// @ts-check
// What isn't proven yet of what was pushed, to a controller that shows it only by its next start: and to have it start for that.

import { SET_POSITION, shownState } from '../../devices/state_words.js';
import { element, showText } from '../../ui/dom.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { enable } from './section.js';

/** @typedef {import('../../model/types.js').Device} Device */

/** On the button, as the title of what it asks, and where that is answered. */
const RESTART = 'Restart and prove now';
const QUESTION = `This restarts the controller: it forgets where it is. ${SET_POSITION}`;

/** @param {{prove: (device: Device) => void}} handlers */
export function createProof(handlers) {
  /** @type {Device | null} */
  let now = null;
  const told = element('p', { className: 'reason', id: 'proof' });
  const ask = element('button', {
    className: 'button small',
    id: 'prove',
    type: 'button',
    textContent: RESTART,
    onclick: () => dialog.open(restart),
  });
  const restart = element('button', {
    className: 'button primary',
    id: 'prove-restart',
    type: 'button',
    textContent: RESTART,
    onclick() {
      dialog.close();
      if (now) handlers.prove(now);
    },
  });
  const dialog = createDialog(
    { id: 'prove-dialog', title: RESTART },
    element('p', { textContent: QUESTION }),
    dialogFoot(() => dialog.close(), restart),
  );
  const line = element('div', { className: 'line' }, ask);

  return {
    element: element('div', { id: 'proving' }, told, line),
    /** @param {import('./section.js').Context} context */
    show({ device, inTheWay, notAtRest, situation }) {
      now = device;
      const restarts = shownState(device) === 'restarting';
      showText(told, restarts ? '' : (device?.unproven_words ?? ''));
      told.hidden = told.textContent === '';
      // What isn't as it was written stays so, however often it starts.
      line.hidden = told.hidden;
      const isFree = inTheWay === '' && notAtRest === '' && !situation.isBusy;
      enable(ask, isFree);
      enable(restart, isFree && !line.hidden);
    },
  };
}
