// @ts-check
// Whole documents that come from outside, an example, a file, a link: they take the place of what is in hand, which is
// kept to be had back. What can't be read changes nothing.

import { decodeLink, isLink } from './link.js';

/** @typedef {import('./documents.js').ReadDocument} ReadDocument */
/** @typedef {import('../model/workbench.js').Machine} Machine */
/** @typedef {import('../model/workbench.js').Work} Work */

/**
 * @param {object} desk
 * @param {() => Machine | null} desk.state what is in hand; null: nothing yet
 * @param {() => boolean} desk.isOwn whether it would be missed
 * @param {() => Machine | null} desk.aside what can be had back
 * @param {(machine: Machine) => void} desk.putAside
 * @param {(work: Work & {ids?: number[]}) => void} desk.put
 * @param {(text: string, hasFailed: boolean) => void} desk.tell
 */
export function createOpening({ state, isOwn, aside, putAside, put, tell }) {
  /** @param {Work & {ids?: number[]}} work */
  const replace = (work) => replacing(() => put(work));

  /** What takes the place of what is in hand, which is kept.
   * @param {() => void} act */
  function replacing(act) {
    const before = state();
    const isMissed = before !== null && isOwn();
    act();
    if (isMissed) putAside(before);
  }

  /** @param {ReadDocument} read @param {string} from such as "the link" @param {string[]} [remarks] what else there is to say */
  function open({ document, problem }, from, remarks = []) {
    if (document === null) {
      tell(`Nothing was opened from ${from}. ${problem}`, true);
      return;
    }
    replace(document);
    const names = document.axes.map((design) => design.name || 'unnamed').join(', ');
    tell([`Opened from ${from}: ${names}${remarks.length > 0 ? '.' : ''}`, ...remarks].join(' '), false);
  }

  return {
    replace,
    replacing,
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
      const replaced = aside();
      if (replaced !== null) replace(replaced);
    },
  };
}
