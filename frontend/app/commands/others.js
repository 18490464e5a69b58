// @ts-check
// What other tabs of the browser keep: it is offered, and taken only when a person says so.

import { isSameDesign, offerOf } from '../selectors.js';
import { announce } from './told.js';

/** @typedef {import('../state.js').OtherTab} OtherTab */
/** @typedef {import('../state.js').OtherTabs} OtherTabs */
/** @typedef {import('../state.js').State} State */

const OFFERED = 'Another tab has changed this design: it can be opened here.';

/** @param {State} state @param {Partial<OtherTabs>} known @returns {State} */
const knowing = (state, known) => ({ ...state, otherTabs: { ...state.otherTabs, ...known } });

/** All of them, as they are kept.
 * @param {State} state @param {OtherTab[]} list @returns {State} */
export const othersCame = (state, list) => knowing(state, { list });

/** One of them has changed what it keeps: of the design in hand that is offered.
 * @param {State} state @param {OtherTab} other @returns {State} */
export function otherChanged(state, other) {
  const { list, offered, declined } = state.otherTabs;
  const isWanted = isSameDesign(state, other) && !declined.includes(other.id);
  const next = knowing(state, {
    list: [other, ...list.filter(({ id }) => id !== other.id)],
    offered: isWanted ? other.id : offered,
  });
  return offerOf(next) !== null && offerOf(state) === null ? announce(next, OFFERED) : next;
}

/** The other's changes are not wanted, and not offered again.
 * @param {State} state @param {string} id @returns {State} */
export const declineOther = (state, id) => knowing(state, { offered: null, declined: [...state.otherTabs.declined, id] });
