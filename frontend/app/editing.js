// @ts-check
// How commands change designs: an axis has another one, and the history knows.

import { withDesign } from '../model/workbench.js';
import { axisOf, machineOf } from './selectors.js';

/** @typedef {import('../model/types.js').Design} Design */
/** @typedef {import('../model/workbench.js').History} History */
/** @typedef {import('./state.js').State} State */

/** @type {Pick<import('../model/workbench.js').Machine, 'axes' | 'ids'>} */
const NOTHING = { axes: [], ids: [] };

/** A row is selected in the table of the axis in hand: another one's has others.
 * @param {State} state @param {(history: History) => History} change @returns {State} */
export function changed(state, change) {
  if (state.history === null) return state;
  const history = change(state.history);
  if (history === state.history) return state;
  const next = { ...state, history };
  return axisOf(next) === axisOf(state) ? next : { ...next, row: -1 };
}

/** An axis has another design.
 * @param {State} state @param {number} axis its id @param {(design: Design) => Design} change @param {string} [gesture]
 * @param {number} [at_ms] @returns {State} */
export function edited(state, axis, change, gesture, at_ms) {
  const { axes, ids } = machineOf(state) ?? NOTHING;
  const before = axes[ids.indexOf(axis)];
  if (before === undefined) return state;
  const design = change(before);
  const next = changed(state, (history) => withDesign(history, axis, design, gesture, at_ms));
  const { name } = design.method;
  // A method that is chosen is shown; it may be hidden again.
  return name === before.method.name || next.shown.includes(name) ? next : { ...next, shown: [...next.shown, name] };
}

/** The axis in hand has another design.
 * @param {State} state @param {(design: Design) => Design} change @param {string} [gesture] @param {number} [at_ms] */
export function editedInHand(state, change, gesture, at_ms) {
  const axis = axisOf(state);
  return axis === null ? state : edited(state, axis, change, gesture, at_ms);
}
