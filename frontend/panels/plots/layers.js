// @ts-check
// What is drawn of a state: the curves of the methods, and what lies beside them over the same axis.

import { isMoveOfPlotted, runningMoveOf, samplesOf } from '../../app/devices.js';
import { axisMovesOf, measuredOf, pinnedOf, shownCaptureOf, shownOwnRampOf } from '../../app/selectors.js';
import { besideOf } from '../../app/library.js';
import { METHODS } from '../../model/methods.js';
import { capturedOver } from '../../plotting/captured.js';
import { curveOf, liveOver, measuredOver, ownOver } from '../../plotting/curves.js';

/** @typedef {import('../../model/types.js').Answer} Answer */
/** @typedef {import('../../model/types.js').MethodName} MethodName */
/** @typedef {import('../../plotting/curves.js').Curve} Curve */
/** @typedef {import('../../plotting/frame.js').Scene} Scene */
/** @typedef {import('../../app/state.js').State} State */

/** @typedef {Partial<Record<MethodName, Curve>>} Curves */
/** @typedef {Pick<Scene, 'pinned' | 'beside' | 'own' | 'axes' | 'measured' | 'captured' | 'live'>} Extras */

/** The curves of the methods that are shown, and of that which is chosen.
 * @param {Answer} answer @param {ReadonlySet<MethodName>} shown @param {Scene['against']} against @returns {Curves} */
export function curvesOver(answer, shown, against) {
  /** @type {Curves} */
  const curves = {};
  for (const { name } of METHODS) {
    const curve = shown.has(name) || name === answer.design.method.name ? curveOf(answer, name, against) : null;
    if (curve) curves[name] = curve;
  }
  return curves;
}

/** What is beside them.
 * @param {State} state @param {Answer} answer @param {Scene['against']} against @returns {Extras} */
export function extrasOver(state, answer, against) {
  const [pinned, axes, measured, own] = [pinnedOf(state), axisMovesOf(state), measuredOf(state), shownOwnRampOf(state)];
  const [live, captured] = [restingSamplesOf(state), shownCaptureOf(state)];
  return {
    pinned: pinned && curveOf({ ...pinned, units: state.units }, pinned.design.method.name, against),
    beside: besideOf(state).map(({ curves }) => curves && curveOf({ ...curves, units: state.units }, curves.design.method.name, against)),
    axes: axes && axes.map(({ time_s, speed, delay_us, ...one }) => ({ ...one, x: time_s, velocity: speed, delay: delay_us })),
    own: own && ownOver(answer, against, own),
    measured: measured && measuredOver(answer, against, measured),
    captured: captured && capturedOver(answer, against, captured),
    live: live && liveOver(answer, against, asMade(state, live)),
  };
}

/** A move of another ramp than the plotted one lies at the steps that it made: it has no ends in common with that.
 * @param {State} state @param {import('../../model/types.js').Samples} samples */
export const asMade = (state, samples) => (isMoveOfPlotted(state) ? samples : { ...samples, length: null });

/** What was told of a move while it ran, once it rests; of one that was traced step by step that says nothing more. A move
 * that runs is drawn by the overlay: for each sample anew.
 * @param {State} state */
export const restingSamplesOf = (state) => (runningMoveOf(state) === null && measuredOf(state) === null ? samplesOf(state) : null);
