// @ts-check
// How things are looked at: nothing of it is a part of a design, or undone.

import { areAxesShown, axisOf, chosenViewOf, viewOf } from '../selectors.js';
import { closeGuide } from './guide.js';

/** @typedef {import('../state.js').State} State */
/** @typedef {import('../state.js').View} View */

/** @param {State} state @param {Partial<View>} wanted @returns {State} */
function looked(state, wanted) {
  const axis = axisOf(state);
  if (axis === null) return state;
  return { ...state, views: { ...state.views, [axis]: { ...chosenViewOf(state), ...wanted } } };
}

/** Look at the axis in hand otherwise; along another axis or at another part of the move all of it is shown.
 * @param {State} state @param {Partial<Omit<View, 'zoom' | 'range'>>} wanted @returns {State} */
export function look(state, wanted) {
  const isElsewhere = 'against' in wanted || 'part' in wanted;
  // Who chooses while the table has its view goes on from that one, and keeps it.
  const chosen = { ...state.tableView, ...wanted };
  return looked({ ...state, tableView: null }, isElsewhere ? { ...chosen, zoom: null } : chosen);
}

/** @param {State} state @param {[number, number] | null} zoom null: all @returns {State} */
export function zoomTo(state, zoom) {
  if (viewOf(state).zoom === zoom) return state;
  if (areAxesShown(state)) return { ...state, allZoom: zoom };
  return state.tableView ? { ...state, tableView: { ...state.tableView, zoom } } : looked(state, { zoom });
}

/** Finer points are wanted for a part of the move.
 * @param {State} state @param {[number, number] | null} range first and last step; null: the whole move
 * @returns {State} */
export const wantPoints = (state, range) => looked(state, { range });

/** Show what the controller in view plays itself, or hide it.
 * @param {State} state @returns {State} */
export const switchOwn = (state) => ({ ...state, isOwnShown: !state.isOwnShown });

/** Show what a machine without a port plays itself, in the place of what the controller in view does; null: that again.
 * @param {State} state @param {State['ownMachine']} ownMachine @returns {State} */
export const drawMachine = (state, ownMachine) => ({ ...state, ownMachine, isOwnShown: true });

/** @param {State} state @param {boolean} areAllShown @returns {State} */
export const showAll = (state, areAllShown) => ({ ...state, areAllShown, allZoom: null });

/** @param {State} state @param {import('../../model/types.js').MethodName} name @returns {State} */
export function switchMethod(state, name) {
  const { shown } = state;
  return { ...state, shown: shown.includes(name) ? shown.filter((one) => one !== name) : [...shown, name] };
}

/** @param {State} state @param {import('../../model/units.js').Units} units @returns {State} */
export function setUnits(state, units) {
  // A zoom along the position would be in other units.
  const views = Object.entries(state.views).map(([axis, view]) => [
    axis,
    view.against === 'position' ? { ...view, zoom: null } : view,
  ]);
  return { ...state, units, views: Object.fromEntries(views) };
}

/** @param {State} state @param {import('../state.js').Theme} theme @returns {State} */
export const setTheme = (state, theme) => (state.theme === theme ? state : { ...state, theme });

/** @type {import('../state.js').TableView} */
const ROWS_IN_SIGHT = { only: 'delay', against: 'step', part: 'start', zoom: null };

/** The guide gives way to the panel. Where one plot at a time has room, the tab of the table shows the plot with its rows,
 * and every other tab what was shown before.
 * @param {State} state @param {import('../state.js').Tab} tab @param {boolean} isNarrow @returns {State} */
export function chooseTab(state, tab, isNarrow) {
  return { ...closeGuide(state), tab, tableView: tab === 'table' && isNarrow ? ROWS_IN_SIGHT : null };
}

/** @param {State} state @param {import('../../plotting/curves.js').Reading | null} reading @returns {State} */
export const read = (state, reading) => (state.reading === reading ? state : { ...state, reading });

/** What the motor is told in flight.
 * @param {State} state @param {import('../../model/flight.js').Told[]} told @returns {State} */
export const tellInFlight = (state, told) => ({ ...state, inFlight: told });

/** @param {State} state @param {number} row of the table; -1: none @returns {State} */
export const selectRow = (state, row) => (state.row === row ? state : { ...state, row });
