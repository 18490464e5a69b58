// @ts-check
// One question to the server: the design's move by each method shown, with the errors against the exact ramp.

import { api, Refusal, UNPROCESSABLE } from './api.js';
import { textOf } from '../model/messages.js';
import { REFERENCE } from '../model/methods.js';

/** @typedef {import('../model/types.js').Answer} Answer */
/** @typedef {import('../model/types.js').Design} Design */
/** @typedef {import('../model/types.js').MethodName} MethodName */

/** What is wanted beside the curves themselves.
 * @typedef {object} Details
 * @property {[number, number] | null} range  first and last step of the part that is looked at; null: the whole move
 * @property {boolean} acceleration           the acceleration that is implied by the delays
 * @property {boolean} parts                  where the error comes from
 * @property {boolean} motion                 the planned acceleration and jerk
 * @property {boolean} isMoving               a slider moves: quick is better than fine */

/** @type {Details} */
export const NO_DETAILS = { range: null, acceleration: false, parts: false, motion: false, isMoving: false };

// As many points as a wide screen has pixels: more can't be seen.
const MAX_POINTS = 2000;
// While a slider moves: one for each two pixels, since the next curves come before these are looked at closely.
const MOVING_POINTS = 400;
// How far a controller's segments may move an interval when the error's parts are shown [ticks].
export const SEGMENT_BOUND_TICKS = 1;

/**
 * Compute a design with its own method and the others shown.
 * Throws Refusal when the design itself is refused, or its own method can't compute it; ServerGone when nobody answers.
 * @param {Design} design
 * @param {MethodName[]} methods without double entries, the design's own among them
 * @param {Details} [details]
 * @param {AbortSignal} [ended]  what ends the question
 * @returns {Promise<Answer>}
 */
export async function calculate(design, methods, details = NO_DETAILS, ended = undefined) {
  const range = rangeWithin(details.range, Math.abs(Number(design.move.steps)));
  const ask = details.isMoving ? api.movingCurves : api.curves;
  const wanted = {
    design,
    methods,
    reference: REFERENCE,
    max_points: details.isMoving ? MOVING_POINTS : MAX_POINTS,
    ...(range && { first_step: range[0], last_step: range[1] }),
    acceleration: details.acceleration,
    parts: details.parts,
    motion: details.motion,
    segment_bound_ticks: details.parts ? SEGMENT_BOUND_TICKS : null,
  };
  const drawn = await ask(wanted, ended);
  // Without the design's own move there is nothing to sum up, push or hold the others against.
  const own = drawn.failures.find(({ method }) => method === design.method.name);
  if (own) throw new Refusal(UNPROCESSABLE, own.errors);
  return answerFrom(design, range, drawn);
}

/** A range that a shorter move still has; null when nothing is left of it, or all of the move.
 * @param {[number, number] | null} range @param {number} steps */
export function rangeWithin(range, steps) {
  if (range === null || !(range[0] < steps)) return null;
  const [first, last] = [Math.max(1, range[0]), Math.min(steps, range[1])];
  return first === 1 && last === steps ? null : /** @type {[number, number]} */ ([first, last]);
}

/** @param {Design} design @param {[number, number] | null} range @param {import('../model/types.js').DrawnCurves} drawn
 * @returns {Answer} */
export function answerFrom(design, range, drawn) {
  /** @type {Answer} */
  const answer = { design, range, profiles: {}, errors: {}, failures: {} };
  for (const { method, step, intervals_ticks, start_ticks, phases, summary, warnings, ...errors } of drawn.methods) {
    answer.profiles[method] = {
      step,
      intervals_ticks,
      time_s: start_ticks.map((ticks) => ticks / drawn.timer_hz),
      position_steps: drawn.direction === 1 ? step : step.map((each) => -each),
      speed_steps_per_s: intervals_ticks.map((ticks) => drawn.timer_hz / ticks),
      phases,
      summary,
      warnings,
    };
    answer.errors[method] = { method, step, ...errors };
  }
  for (const { method, errors } of drawn.failures) {
    answer.failures[method] = textOf(errors);
  }
  return answer;
}
