// @ts-check
// What follows from the state of what is in the library.

import { areEqual } from '../model/equal.js';
import { axisOf, designOf, machineOf } from './selectors.js';

/** @typedef {import('../model/library.js').Link} Link */
/** @typedef {import('./state.js').State} State */

/** Which revision the axis in hand began with; null: none.
 * @param {State} state @returns {Link | null} */
export const linkOf = (state) => state.library.links[axisOf(state) ?? -1] ?? null;

/** Whether the axis in hand is as that revision is.
 * @param {State} state */
export function isAsLinked(state) {
  const known = linkOf(state);
  return known !== null && areEqual(known.design, designOf(state));
}

/** Whether all that is in hand is as the library has it.
 * @param {State} state */
export function isAllKept(state) {
  const machine = machineOf(state);
  return machine !== null && machine.axes.every((design, place) => areEqual(state.library.links[machine.ids[place]]?.design ?? null, design));
}

/** Whether this page may write to the library: on a shared server only who operates.
 * @param {State} state */
export const mayKeep = ({ devices }) => devices.role === 'operate';

/** What is laid beside the design in hand, as far as its curves are known. Of all axes nothing is.
 * @param {State} state */
export const besideOf = (state) => (machineOf(state) === null ? NOTHING : state.library.beside);

/** @type {State['library']['beside']} */
const NOTHING = [];
