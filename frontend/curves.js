// @ts-check
// From the server's answers to curves: what is drawn over which axis, and what the cursor reads.

import { REFERENCE } from './methods.js';

/** @typedef {import('./types.js').Answer} Answer */
/** @typedef {import('./types.js').MethodName} MethodName */
/** @typedef {import('./types.js').Profile} Profile */
/** @typedef {'step' | 'time' | 'position'} AxisName */

/** @typedef {object} Curve
 * @property {number[]} step
 * @property {number[]} x           in the unit of the axis
 * @property {number[]} ticks
 * @property {number[]} speed       [steps/s]
 * @property {number[]} delay_us
 * @property {number[]} time_s
 * @property {{step: number[], x: number[], percent: number[]}} error  against the reference */

/** @typedef {object} MethodReading
 * @property {MethodName} method
 * @property {number} ticks
 * @property {number} delay_us
 * @property {number} speed      [steps/s]
 * @property {number} percent    error against the reference; NaN: not known
 * @property {boolean} isExact   the step was computed, or lies on a plateau; false: between two computed ones */
/** @typedef {{step: number, time_s: number, x: number, methods: MethodReading[]}} Reading */

/** Index of the first element that is not less than `value`; the length if none is.
 * @param {number[]} ascending @param {number} value */
function lowerBound(ascending, value) {
  let low = 0;
  let high = ascending.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (ascending[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The value at `at` on the line through (from, to) points, held beyond the ends.
 * @param {number[]} from ascending @param {number[]} to @param {number} at */
export function interpolate(from, to, at) {
  const after = lowerBound(from, at);
  if (after >= from.length) return to[to.length - 1];
  if (after === 0 || from[after] === at) return to[after];
  const share = (at - from[after - 1]) / (from[after] - from[after - 1]);
  return to[after - 1] + share * (to[after] - to[after - 1]);
}

/** How steps become axis units: the factor of each axis and its title.
 * @param {Answer} answer @param {AxisName} axis */
export function axisScale(answer, axis) {
  const { full_steps_per_rev, microsteps, travel_per_rev, travel_unit } = answer.design.axis;
  if (axis === 'position') {
    return {
      factor: Number(travel_per_rev) / (Number(full_steps_per_rev) * Number(microsteps)),
      title: `position, ${travel_unit}`,
    };
  }
  if (axis === 'time') {
    const duration = activeProfile(answer).summary.duration_s;
    return duration < 10 ? { factor: 1000, title: 'time, ms' } : { factor: 1, title: 'time, s' };
  }
  return { factor: 1, title: 'step' };
}

/** @param {Answer} answer @returns {Profile} */
export function activeProfile(answer) {
  return /** @type {Profile} */ (answer.profiles[answer.design.method.name]);
}

/** @param {Answer} answer @param {MethodName} method @param {AxisName} axis @returns {Curve | null} */
export function curveOf(answer, method, axis) {
  const profile = answer.profiles[method];
  if (!profile) return null;
  const { factor } = axisScale(answer, axis);
  const along = axis === 'step' ? profile.step : axis === 'time' ? profile.time_s : profile.position_steps;
  const x = factor === 1 ? along : along.map((value) => value * factor);
  const frequency = Number(answer.design.timer.frequency_hz);
  const curve = answer.errors[method];
  const error =
    method === REFERENCE
      ? { step: [profile.step[0], profile.step[profile.step.length - 1]], x: [x[0], x[x.length - 1]], percent: [0, 0] }
      : {
          step: curve?.step ?? [],
          x: curve?.step.map((step) => interpolate(profile.step, x, step)) ?? [],
          percent: curve?.relative_error.map((fraction) => fraction * 100) ?? [],
        };
  return {
    step: profile.step,
    x,
    ticks: profile.intervals_ticks,
    speed: profile.speed_steps_per_s,
    time_s: profile.time_s,
    delay_us: profile.intervals_ticks.map((ticks) => (ticks / frequency) * 1e6),
    error,
  };
}

/** What all curves say at the step of `lead` nearest to a place on the axis.
 * @param {Partial<Record<MethodName, Curve>>} curves @param {MethodName} lead @param {number} x
 * @returns {Reading | null} */
export function readingAt(curves, lead, x) {
  const curve = curves[lead];
  if (!curve || curve.step.length === 0) return null;
  const index = nearest(curve.x, x);
  const step = curve.step[index];
  const methods = Object.entries(curves).map(([name, other]) => {
    const at = lowerBound(other.step, step);
    return {
      method: /** @type {MethodName} */ (name),
      ticks: interpolate(other.step, other.ticks, step),
      delay_us: interpolate(other.step, other.delay_us, step),
      speed: interpolate(other.step, other.speed, step),
      percent: other.error.step.length === 0 ? NaN : interpolate(other.error.step, other.error.percent, step),
      isExact: other.step[at] === step || other.ticks[at] === other.ticks[at - 1],
    };
  });
  return { step, time_s: curve.time_s[index], x: curve.x[index], methods };
}

/** Index of the value nearest to `x`, in values that rise or fall all along (a move backward falls).
 * @param {number[]} values @param {number} x */
function nearest(values, x) {
  const falls = values[values.length - 1] < values[0];
  let low = 0;
  let high = values.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (values[middle] < x !== falls) low = middle;
    else high = middle;
  }
  return Math.abs(values[low] - x) <= Math.abs(values[high] - x) ? low : high;
}

/** The step of the plotted move that a move of any length is at: its ramps count from its own ends.
 * @param {Profile} profile @param {number} done steps since the move began @param {number} remaining steps */
export function plottedStep(profile, done, remaining) {
  const { steps, accelerate_steps, decelerate_steps } = profile.summary;
  if (done + remaining === steps || done <= accelerate_steps) return Math.min(done, steps);
  if (remaining <= decelerate_steps) return Math.max(steps - remaining, accelerate_steps);
  const slew = Math.max(1, done + remaining - accelerate_steps - decelerate_steps);
  const share = (done - accelerate_steps) / slew;
  return Math.round(accelerate_steps + share * Math.max(0, steps - accelerate_steps - decelerate_steps));
}
