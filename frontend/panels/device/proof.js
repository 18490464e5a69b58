// @ts-check
// Whether what was pushed is stored, of a controller that shows it only by its next start: and to have it start for that.

import { element, showText } from '../../ui/dom.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { enable } from './section.js';

/** @typedef {import('../../model/types.js').Device} Device */

const QUESTION = 'This restarts the controller: it forgets where it is. Home it, or set its zero again, before you move it.';

/** @param {{prove: (device: Device) => void}} handlers */
export function createProof(handlers) {
  /** @type {Device | null} */
  let now = null;
  const told = element('p', { className: 'reason', id: 'proof' });
  const ask = element('button', {
    className: 'button small',
    id: 'prove',
    type: 'button',
    textContent: 'Restart and prove now',
    onclick: () => dialog.open(restart),
  });
  const restart = element('button', {
    className: 'button primary',
    id: 'prove-restart',
    type: 'button',
    textContent: 'Restart it',
    onclick() {
      dialog.close();
      if (now) handlers.prove(now);
    },
  });
  const dialog = createDialog(
    { id: 'prove-dialog', title: 'Restart and prove' },
    element('p', { textContent: QUESTION }),
    dialogFoot(() => dialog.close(), restart),
  );
  const line = element('div', { className: 'line' }, ask);

  return {
    element: element('div', { id: 'proving' }, told, line),
    /** @param {import('./section.js').Context} context */
    show({ device, inTheWay, notAtRest, situation }) {
      now = device;
      showText(told, device === null ? '' : proofText(device));
      told.hidden = told.textContent === '';
      line.hidden = device === null || device.unproven.length === 0;
      const isFree = inTheWay === '' && notAtRest === '' && !situation.isBusy;
      enable(ask, isFree);
      enable(restart, isFree && !line.hidden);
    },
  };
}

/** What isn't as it was written the device's message tells.
 * @param {Device} device */
function proofText({ unproven, proof }) {
  const open = unproven.filter((name) => !proof?.not_kept.includes(name));
  if (open.length > 0) return `Whether ${open.join(', ')} ${open.length > 1 ? 'are' : 'is'} stored is seen when the controller next starts.`;
  return proof !== null && proof.not_kept.length === 0 ? proof.words : '';
}
