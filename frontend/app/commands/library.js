// @ts-check
// What the page knows of the library: which revision each axis began with, and which are laid beside the design in hand.

import { idsOf } from '../../model/workbench.js';

/** @typedef {import('../../model/library.js').Link} Link */
/** @typedef {import('../../model/types.js').Answer} Answer */
/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../state.js').State} State */

/** So many lines more can still be told from each other. */
const MOST_LAID_BESIDE = 4;

/** @param {State} state @param {Partial<import('../state.js').OfLibrary>} known @returns {State} */
const knowing = (state, known) => ({ ...state, library: { ...state.library, ...known } });

/** An axis is a revision of the library from now on. Of axes that can't come back none is kept.
 * @param {State} state @param {number} axis its id @param {Link} link @returns {State} */
export function link(state, axis, link) {
  const ids = state.history ? idsOf(state.history) : new Set();
  const links = Object.entries({ ...state.library.links, [axis]: link }).filter(([id]) => ids.has(Number(id)));
  return knowing(state, { links: Object.fromEntries(links) });
}

/** The newest of a design is known anew: who saves next, saves a change of that.
 * @param {State} state @param {number} axis its id @param {Partial<Link>} known @returns {State} */
export function relink(state, axis, known) {
  const before = state.library.links[axis];
  return before === undefined ? state : knowing(state, { links: { ...state.library.links, [axis]: { ...before, ...known } } });
}

/** A revision is laid beside the design in hand, in the place of the first of those that are there when these are as many as can
 * be told from each other.
 * @param {State} state @param {{key: string, label: string, design: Design}} wanted @returns {State} */
export function layBeside(state, wanted) {
  const { beside } = state.library;
  if (beside.some(({ key }) => key === wanted.key)) return state;
  return knowing(state, { beside: [...beside, { ...wanted, curves: null }].slice(-MOST_LAID_BESIDE) });
}

/** @param {State} state @param {string} key @returns {State} */
export const takeAway = (state, key) => knowing(state, { beside: state.library.beside.filter((one) => one.key !== key) });

/** The curves of what is laid beside; null: the server refuses it.
 * @param {State} state @param {Record<string, Answer | null>} curves by key @returns {State} */
export function besideCame(state, curves) {
  return knowing(state, { beside: state.library.beside.map((one) => (one.key in curves ? { ...one, curves: curves[one.key] } : one)) });
}
