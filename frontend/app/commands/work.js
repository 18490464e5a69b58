// @ts-check
// What is done to the designs, with a history that takes it back.

import { MOST_ROWS, withChanges, withMethod, withTable, withTablePlayed, withValue } from '../../model/design.js';
import { withMeasured } from '../../model/measured.js';
import { withMechanism } from '../../model/mechanisms.js';
import { methodOf } from '../../model/methods.js';
import { withMotor, withoutMotor } from '../../model/motors.js';
import { withPreset } from '../../model/presets.js';
import { USUAL_SHAPE, withPlan, withShape } from '../../model/shapes.js';
import {
  gestureEnded,
  GUIDE_GESTURE,
  historyOf,
  idsOf,
  movedTogether,
  pinnedTo,
  redone,
  replaced,
  undone,
  withAxis,
  withAxisInPlace,
  withAxisInHand,
  withoutAxis,
} from '../../model/workbench.js';
import { changed, edited, editedInHand } from '../editing.js';
import { axisOf, chosenViewOf, designOf } from '../selectors.js';
import { tell } from './told.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').MethodName} MethodName */
/** @typedef {import('../state.js').State} State */

/** The first that is worked on: kept from the last time, in the address, or an example.
 * @param {State} state @param {Parameters<typeof historyOf>[0]} machine @returns {State} */
export const begin = (state, machine) => ({ ...state, history: historyOf(machine, state.firstId) });

/** All axes at once take the place of those in hand: a file, a link, an example. They are looked at as those were.
 * @param {State} state @param {import('../../model/workbench.js').Work & {ids?: number[]}} work @returns {State} */
export function open(state, work) {
  const before = state.history;
  const history = before === null ? historyOf(work, state.firstId) : replaced(before, work);
  const view = { ...chosenViewOf(state), zoom: null, range: null };
  // Of axes that can't come back none is kept: documents are opened for as long as the page is.
  const known = Array.from(idsOf(history), (id) => /** @type {const} */ ([id, state.views[id]])).filter(([, of]) => of);
  const views = Object.fromEntries([...known, ...history.present.ids.map((id) => [id, view])]);
  return { ...state, history, views, areAllShown: false, allZoom: null, row: -1, opened: state.opened + 1 };
}

/** @param {State} state @param {string} path such as "ramp.slew_speed_steps_per_s" @param {unknown} value
 * @param {string} [gesture] changes in a row with the same one are undone together
 * @param {number} [at_ms] when, for gestures of steps @returns {State} */
export const setValue = (state, path, value, gesture, at_ms) =>
  editedInHand(state, (design) => withValue(design, path, value), gesture, at_ms);

/** Several values at once, as one change.
 * @param {State} state @param {import('../../model/types.js').Remedy['changes']} changes @param {string} [gesture]
 * @param {number} [at_ms] @returns {State} */
export const setValues = (state, changes, gesture, at_ms) => editedInHand(state, (design) => withChanges(design, changes), gesture, at_ms);

/** What would be accepted, or what a controller has, is done, as one step of the history; the axis it is for comes in hand.
 * @param {State} state @param {number} axis its id
 * @param {Pick<import('../../model/types.js').Remedy, 'changes'>} remedy with paths of a design @returns {State} */
export function mend(state, axis, { changes }) {
  return edited(choose(state, axis), axis, (design) => withChanges(design, changes));
}

/** @param {State} state @param {string} name @returns {State} */
export const setName = (state, name) => editedInHand(state, (design) => ({ ...design, name }), 'name');

/** @param {State} state @param {MethodName} name @returns {State} */
export const setMethod = (state, name) => editedInHand(state, (design) => withMethod(design, methodOf(name).name));

/** @param {State} state @param {string} name @returns {State} */
export const setShape = (state, name) => editedInHand(state, (design) => withShape(design, name));

/** @param {State} state @param {string} plan for moves too short for the slew speed @returns {State} */
export const setPlan = (state, plan) => editedInHand(state, (design) => withPlan(design, plan));

/** @param {State} state @param {import('../../model/motors.js').MotorPreset | null} preset null: nothing is known of it any more
 * @returns {State} */
export const setMotor = (state, preset) =>
  editedInHand(state, (design) => (preset === null ? withoutMotor(design, USUAL_SHAPE) : withMotor(design, preset)));

/** @param {State} state @param {import('../../model/measured.js').Measured} name @param {unknown} value undefined: forgotten
 * @param {string} [gesture] @returns {State} */
export const setMeasured = (state, name, value, gesture) => editedInHand(state, (design) => withMeasured(design, name, value), gesture);

/** @param {State} state @param {string} name of what the motor moves something with; '': its shaft alone @returns {State} */
export const setMechanism = (state, name) => editedInHand(state, (design) => withMechanism(design, name));

/** @param {State} state @param {import('../../model/presets.js').Part} part
 * @param {import('../../model/presets.js').Preset} preset @returns {State} */
export const setPreset = (state, part, preset) => editedInHand(state, (design) => withPreset(design, part, preset));

/** @param {State} state @param {import('../../model/design.js').Rows} rows @param {string} [unit] of its delays; as it is
 * @param {string} [gesture] @param {number | null} [axis] whose table it is; the one in hand
 * @param {boolean} [asMethod] whether it becomes the method as well @returns {State} */
export function setTable(state, rows, unit, gesture, axis = axisOf(state), asMethod = false) {
  if (axis === null) return state;
  if (rows.length > MOST_ROWS) return tell(state, tooManyRows(rows.length), true);
  const changed = (/** @type {Design} */ design) => {
    const tabled = withTable(design, rows, unit ?? design.table?.interval_unit ?? 'us');
    return asMethod ? withTablePlayed(tabled) : tabled;
  };
  return edited(state, axis, changed, gesture);
}

/** @param {number} count */
function tooManyRows(count) {
  const [found, most] = [count, MOST_ROWS].map((number) => number.toLocaleString('en-US'));
  return `The table stays as it is: it would have ${found} rows; allowed: at most ${most}.`;
}

/** What comes next is another change: a field is left, a slider let go. A step of the guide ends by itself.
 * @param {State} state @returns {State} */
export const endGesture = (state) =>
  changed(state, (history) => (history.gesture.startsWith(GUIDE_GESTURE) ? history : gestureEnded(history)));

/** @param {State} state @returns {State} */
export const undo = (state) => changed(state, undone);

/** @param {State} state @returns {State} */
export const redo = (state) => changed(state, redone);

/** An axis in the place of the one in hand, looked at as that was.
 * @param {State} state @param {Design} design @returns {State} */
export const openInPlace = (state, design) => withNewAxis(state, (history) => withAxisInPlace(history, design));

/** @param {State} state @param {Design} [design] alike the one in hand without one @returns {State} */
export const addAxis = (state, design) => withNewAxis(state, (history) => withAxis(history, design));

/** @param {State} state @param {Parameters<typeof changed>[1]} change after which the new axis is in hand @returns {State} */
function withNewAxis(state, change) {
  const view = { ...chosenViewOf(state), zoom: null, range: null };
  const next = changed(state, change);
  const added = axisOf(next);
  return next === state || added === null ? next : { ...next, views: { ...next.views, [added]: view } };
}

/** @param {State} state @param {number} axis its id @returns {State} */
export const removeAxis = (state, axis) => changed(state, (history) => withoutAxis(history, axis));

/** @param {State} state @param {number} axis its id @returns {State} */
export const choose = (state, axis) => changed(state, (history) => withAxisInHand(history, axis));

/** @param {State} state @param {import('../../model/workbench.js').Together} together @returns {State} */
export const setTogether = (state, together) => changed(state, (history) => movedTogether(history, together));

/** The design in hand is pinned, to compare the next ones with.
 * @param {State} state @returns {State} */
export const pin = (state) => changed(state, (history) => pinnedTo(history, designOf(state)));

/** @param {State} state @returns {State} */
export const unpin = (state) => changed(state, (history) => pinnedTo(history, null));
