// @ts-check
// What follows from the state: nothing of it is kept, so that none of it can be wrong. Of devices: devices.js.

import { activeProfile } from '../plotting/curves.js';
import { areSameRamps } from '../model/design.js';
import { axesMessages, sortMessages } from '../model/messages.js';
import { areEqual } from '../model/equal.js';
import { methodOf } from '../model/methods.js';
import { inShownUnits } from '../model/told.js';
import { shownValue } from '../model/units.js';
import { SLIDE_GESTURE } from '../model/workbench.js';
import { FIRST_VIEW, remembering } from './state.js';

/** @typedef {import('../model/types.js').Design} Design */
/** @typedef {import('./state.js').State} State */
/** @typedef {import('./state.js').View} View */

// ---- what is worked on ----

/** @param {State} state */
export const machineOf = ({ history }) => history?.present ?? null;

/** The design in hand; null: none yet.
 * @param {State} state */
export function designOf(state) {
  const machine = machineOf(state);
  return machine && machine.axes[machine.active];
}

/** The id of the axis in hand; null: none yet.
 * @param {State} state */
export function axisOf(state) {
  const machine = machineOf(state);
  return machine && machine.ids[machine.active];
}

/** Whether a slider is under the hand: quick is then better than fine.
 * @param {State} state */
export const isSliding = ({ history }) => history?.gesture.startsWith(SLIDE_GESTURE) ?? false;

/** Whether what is in hand would be missed: no example as it came.
 * @param {State} state */
export function isOwnWork(state) {
  const machine = machineOf(state);
  const examples = [state.lastExample, ...state.examples.map(({ design }) => design)];
  return machine !== null && !examples.some((design) => areEqual([design], machine.axes));
}

// ---- other tabs ----

/** Whether what another tab has in hand is the design in hand, further on or as it is: they have an axis in common.
 * @param {State} state @param {import('./state.js').OtherTab} other */
export const isSameDesign = (state, { machine }) => machineOf(state)?.ids.some((id) => machine.ids.includes(id)) ?? false;

/** The tab whose change of the design in hand is offered; null: none.
 * @param {State} state */
export function offerOf(state) {
  const other = state.otherTabs.list.find(({ id }) => id === state.otherTabs.offered);
  return other && isSameDesign(state, other) && isOtherWork(machineOf(state), other.machine) ? other : null;
}

/** @typedef {import('../model/workbench.js').Machine | null} Work */
const isOtherWork = remembering(
  (/** @type {Work} */ own, /** @type {Work} */ other) =>
    !areEqual([own?.axes, own?.together], [other?.axes, other?.together]),
);

// ---- the answers of the axis in hand ----

/** The curves of the axis in hand, of its present design or an earlier one; null: none have come.
 * @param {State} state */
export const curvesOf = (state) => (state.answers.of === axisOf(state) ? state.answers.curves : null);

/** Why what is shown is not that of the present design.
 * @param {State} state @returns {import('../model/types.js').Staleness} */
export function stalenessOf(state) {
  const { about, staleness } = state.answers;
  return about !== axisOf(state) ? 'awaited' : staleness;
}

/** The curves that are shown: those of another axis only for as long as nothing is known of the axis in hand.
 * @param {State} state */
export const shownCurvesOf = (state) => (stalenessOf(state) === 'awaited' ? state.answers.curves : curvesOf(state));

// ---- the plots ----

/** Whether the plots show all axes: of one there are no others.
 * @param {State} state */
export const areAxesShown = (state) => state.areAllShown && (machineOf(state)?.axes.length ?? 0) > 1;

/** How the axis in hand was chosen to be looked at, whether it can be just now or not.
 * @param {State} state @returns {View} */
export const chosenViewOf = ({ history, views }) =>
  history ? (views[history.present.ids[history.present.active]] ?? FIRST_VIEW) : FIRST_VIEW;

/** How the axis in hand is looked at.
 * @param {State} state @returns {View} */
export function viewOf(state) {
  const { history, areAllShown, allZoom, tableView } = state;
  const view = chosenViewOf(state);
  const isMeasured = measuredOf(state) !== null || shownCaptureOf(state) !== null;
  return shownView(view, tableView, isMeasured, areAllShown && (history?.present.axes.length ?? 0) > 1, allZoom);
}

const shownView = remembering(
  (
    /** @type {View} */ chosen,
    /** @type {import('./state.js').TableView | null} */ tableView,
    /** @type {boolean} */ isMeasured,
    /** @type {boolean} */ areAll,
    /** @type {[number, number] | null} */ allZoom,
  ) => {
    const view = { ...chosen, ...tableView };
    // There is no deviation without a measured move.
    const third = view.third === 'deviation' && !isMeasured ? /** @type {const} */ ('error') : view.third;
    return { ...view, third, zoom: areAll ? allZoom : view.zoom };
  },
);

/** The measured move that lies over the plots: one of the axis in hand, or of one that nobody knows.
 * @param {State} state @returns {import('../model/types.js').Measured | null} */
export function measuredOf(state) {
  const { measured } = state.devices;
  return measured !== null && (measured.of.axis === null || measured.of.axis === axisOf(state)) ? measured.move : null;
}

/** Whether that move followed the ramp that is plotted, as far as the page knows.
 * @param {State} state */
export function isMeasuredOfDesign(state) {
  // What is refused is not plotted either.
  if (stalenessOf(state) === 'refused') return true;
  const [made, present] = [state.devices.measured?.of.design ?? null, designOf(state)];
  return made !== null && present !== null && areSameRamps([{ ...made, move: present.move }], [present]);
}

/** The moves of all axes as the plots show them; null: those of one axis are shown.
 * @param {State} state @returns {import('../plotting/curves.js').AxisMove[] | null} */
export const axisMovesOf = (state) => (areAxesShown(state) ? axisMoves(state.answers.allAxes, state.units) : null);

const axisMoves = remembering(
  (/** @type {import('./state.js').AllAxes | null} */ all, /** @type {import('../model/units.js').Units} */ units) =>
    all?.planned?.axes.map(({ name, pulses }, colour) => ({
      label: `${colour} ${name}`,
      colour,
      time_s: pulses.time_s,
      speed: pulses.speed_steps_per_s.map((speed) => shownValue(units, all.axes[colour], 'speed', speed)),
      delay_us: pulses.speed_steps_per_s.map((speed) => 1e6 / speed),
    })) ?? null,
);

/** Why what is known of all axes is not of the designs in hand; null: it is, or they are not shown.
 * @param {State} state @returns {import('../model/types.js').Staleness} */
export function axesStalenessOf(state) {
  const { allAxes, axesStaleness } = state.answers;
  const machine = machineOf(state);
  if (!areAxesShown(state) || allAxes === null || machine === null) return null;
  if (allAxes.axes === machine.axes && allAxes.together === machine.together) return null;
  // An axis more or less is no slider's: the plans show it at once.
  return allAxes.axes.length === machine.axes.length ? axesStaleness : (axesStaleness ?? 'awaited');
}

/** Why what is plotted is not of what is in hand, be it one axis or all.
 * @param {State} state */
export const plottedStalenessOf = (state) => (axisMovesOf(state) === null ? stalenessOf(state) : axesStalenessOf(state));

/** What the controller in view plays of the design in hand, or of an earlier one; null: what is planned, nobody knows, or it is
 * not to be seen.
 * @param {State} state @returns {import('../model/types.js').OwnRamp | null} */
export const shownOwnRampOf = (state) => (state.isOwnShown && !areAxesShown(state) ? (state.answers.ownRamp?.ramp ?? null) : null);

/** The curves of the pinned design; null: none is, or the server refuses it.
 * @param {State} state */
export function pinnedOf(state) {
  const { pinned } = state.answers;
  return pinned !== null && pinned.design === machineOf(state)?.kept ? pinned.curves : null;
}

/** What is known of what the motor of the axis in hand does; null: the design has none, or nothing has come. It may be of an earlier
 * design: while a slider moves, what is shown follows it. Of another axis it never is: what is proposed would go to the wrong one.
 * @param {State} state */
export function motorOf(state) {
  const { motor } = state.answers;
  return designOf(state)?.motor === undefined || motor?.of !== axisOf(state) ? null : motor;
}

// ---- what was captured ----

/** The axis that the capture is of: the one it was opened for, while there is such a one.
 * @param {State} state */
function captureAxisOf(state) {
  const { capture } = state;
  if (capture === null) return null;
  return machineOf(state)?.ids.includes(capture.axis) ? capture.axis : axisOf(state);
}

/** The design that a captured file is to be held against, as it is sent: only of a sound one there is a plan.
 * @param {State} state @returns {string | null} null: there is none now */
export function comparedDesignOf(state) {
  const { curves, of, staleness } = state.answers;
  return curves === null || staleness !== null || of !== captureAxisOf(state) ? null : comparedDesign(curves.design);
}

// The address that it is a part of has no room for a table that nobody plays.
const comparedDesign = remembering((/** @type {Design} */ design) =>
  JSON.stringify({ ...design, name: '', table: methodOf(design.method.name).plays_table ? design.table : null }),
);

/** What was captured, as far as the plots show it; null: nothing.
 * @param {State} state @returns {import('../plotting/captured.js').ShownCapture | null} */
export function shownCaptureOf(state) {
  const { capture } = state;
  if (!capture?.answer?.move || captureAxisOf(state) !== axisOf(state) || areAxesShown(state)) return null;
  return shownCapture(capture.answer.move, isCaptureStale(state));
}

const shownCapture = remembering(
  (/** @type {NonNullable<import('../model/types.js').Captured['move']>} */ move, /** @type {boolean} */ isStale) => ({ move, isStale }),
);

/** Whether what was found is not what is asked for now.
 * @param {State} state */
export const isCaptureStale = (state) =>
  state.capture !== null && (state.capture.stage !== 'answered' || state.capture.of !== comparedDesignOf(state));

// ---- what is said ----

/** Whether what is plotted is the present design, and sound.
 * @param {State} state */
export const isDesignValid = (state) => stalenessOf(state) === null && curvesOf(state) !== null;

/** What the server says of the design, by the places that show it.
 * @param {State} state */
export function messagesOf(state) {
  const staleness = stalenessOf(state);
  const axis = axisOf(state);
  return sorted(
    staleness === 'awaited' ? NO_REJECTIONS : state.answers.rejections,
    staleness === null ? curvesOf(state) : null,
    axis === null ? undefined : state.answers.refused[axis],
    state.units,
    designOf(state),
  );
}

/** @type {import('../model/types.js').Rejection[]} */
const NO_REJECTIONS = [];

const sorted = remembering(
  (
    /** @type {import('../model/types.js').Rejection[]} */ rejections,
    /** @type {import('../model/types.js').Answer | null} */ curves,
    /** @type {import('../model/types.js').Design | undefined} */ refused,
    /** @type {import('../model/units.js').Units} */ units,
    /** @type {Design | null} */ inHand,
  ) => {
    const asked = refused ?? inHand;
    const refusals = rejections.map(inShownUnits(units, asked === null ? [] : [asked]));
    const warnings = curves ? activeProfile(curves).warnings.map(inShownUnits(units, [curves.design])) : [];
    return sortMessages(refusals, warnings, refused);
  },
);

/** What is wrong with all axes is told unless it is told of the one in hand.
 * @type {Set<import('../model/types.js').Staleness>} */
const ALL_ARE_TOLD = new Set([null, 'awaited']);
/** Nobody may ever tell that these are over. */
const CLOSABLE = new Set(['ended']);

/** What is shown above the figures, the most urgent first.
 * @param {State} state */
export const summaryMessagesOf = (state) =>
  summaryMessages(
    state.told.urgent,
    messagesOf(state),
    areAxesShown(state) && ALL_ARE_TOLD.has(stalenessOf(state)) && axesStalenessOf(state) === null ? state.answers.allAxes : null,
    state.units,
  );

const summaryMessages = remembering(
  (
    /** @type {Record<string, string>} */ urgent,
    /** @type {import('../model/messages.js').Messages} */ { others },
    /** @type {import('./state.js').AllAxes | null} */ allAxes,
    /** @type {import('../model/units.js').Units} */ units,
  ) => {
    const shown = inShownUnits(units, allAxes?.axes ?? []);
    const warnings = [...(allAxes?.planned?.limits ?? []), ...(allAxes?.planned?.warnings ?? [])];
    return [
      ...Object.entries(urgent).map(([about, text]) => ({ text, isWarning: false, about: CLOSABLE.has(about) ? about : undefined })),
      ...others,
      ...axesMessages((allAxes?.rejections ?? []).map(shown), false),
      ...axesMessages(warnings.map(shown), true),
    ];
  },
);
