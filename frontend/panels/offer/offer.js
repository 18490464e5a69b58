// @ts-check
// The offer of what another tab has made of the design in hand: nothing is taken unless a person says so.

import { declineOther } from '../../app/commands/others.js';
import { offerOf } from '../../app/selectors.js';
import { whenChanged } from '../../app/state.js';
import { element, icon } from '../../ui/dom.js';

/** @typedef {import('../../app/state.js').OtherTab} OtherTab */

/**
 * @param {HTMLElement} root
 * @param {import('../../app/state.js').Dispatch} dispatch
 * @param {{openWork: (work: OtherTab['machine']) => void}} act
 */
export function createOffer(root, dispatch, act) {
  /** @param {OtherTab} other */
  function bar({ id, machine }) {
    const open = element('button', { className: 'button', id: 'offer-open', type: 'button', textContent: 'Open it here' });
    open.title = 'Takes the place of yours here; undo brings yours back';
    open.onclick = () => act.openWork(machine);
    const decline = element('button', { className: 'button quiet', id: 'offer-decline', type: 'button', textContent: 'Keep mine' });
    decline.title = 'Not offered again; it stays in the other tab, and in the menu';
    decline.onclick = () => dispatch(declineOther, id);
    return [icon('copy'), element('span', { textContent: 'Another tab has changed this design.' }), open, decline];
  }

  return {
    show: whenChanged(
      (state) => [offerOf(state)],
      (other) => {
        root.hidden = other === null;
        root.replaceChildren(...(other === null ? [] : bar(other)));
      },
    ),
  };
}
