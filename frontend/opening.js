// @ts-check
// Whole documents that come from outside, an example, a file, a link: they take the place of what is in hand, which is
// kept to be had back. What can't be read changes nothing.

import { decodeLink, isLink } from './link.js';
import { memory } from './memory.js';

/** @typedef {import('./documents.js').Reading} Reading */
/** @typedef {import('./workbench.js').State} State */
/** @typedef {import('./workbench.js').Work} Work */

/**
 * @param {object} desk
 * @param {() => State | null} desk.state what is in hand; null: nothing yet
 * @param {() => boolean} desk.isOwn whether it would be missed
 * @param {(work: Work) => void} desk.put
 * @param {(text: string, hasFailed: boolean) => void} desk.say
 */
export function createOpening({ state, isOwn, put, say }) {
  /** @param {Work} work */
  function replace(work) {
    const before = state();
    if (before !== null && isOwn()) memory.keepReplaced(before);
    put(work);
  }

  /** @param {Reading} reading @param {string} from such as "the link" */
  function open({ document, problem }, from) {
    if (document === null) {
      say(`Nothing was opened from ${from}. ${problem}`, true);
      return;
    }
    replace(document);
    const names = document.axes.map((design) => design.name || 'unnamed').join(', ');
    say(`Opened from ${from}: ${names}`, false);
  }

  return {
    replace,
    open,
    /** Open what the address carries, if anything, and take it out of the address: it is kept elsewhere from now on. */
    async openAddress() {
      const { hash, pathname, search } = location;
      if (!isLink(hash)) return;
      history.replaceState(null, '', pathname + search);
      open(await decodeLink(hash), 'the link');
    },
    /** What was replaced comes back, and what it comes back for is kept in its place. */
    goBack() {
      const replaced = memory.replaced();
      if (replaced !== null) replace(replaced);
    },
  };
}
