// @ts-check
// Whether the guide is shown by itself: on a first visit, until it is closed. What is kept says so ever after.

import { memory } from '../../documents/memory.js';
import { openGuide } from '../commands/guide.js';
import { whenChanged } from '../state.js';

/** To be called once what was kept from the last time, and what is in the address, has been opened.
 * @param {import('../state.js').Store} store */
export function guideFirstVisit({ state, dispatch, subscribe }) {
  const isUnderWay = memory.isGuideOpen();
  // Who has work here already, or comes by a link, came for that.
  if (isUnderWay ?? state().history === null) dispatch(openGuide);
  if (state().guide.isOpen) memory.keepGuideOpen(true);
  subscribe(whenChanged(({ guide }) => [guide.isOpen], memory.keepGuideOpen, state()));
}
