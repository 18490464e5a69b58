// @ts-check
// From the server's answers to curves: what is drawn over which axis, and what the cursor reads.

import { REFERENCE } from '../model/methods.js';
import { shownValue, STEPS_AND_SECONDS, unitWord } from '../model/units.js';

/** @typedef {import('../model/types.js').Answer} Answer */
/** @typedef {import('../model/types.js').MethodName} MethodName */
/** @typedef {import('../model/types.js').Profile} Profile */
/** @typedef {import('../model/types.js').ErrorPart} ErrorPart */
/** @typedef {'step' | 'time' | 'position'} PlotAxis */

/** @typedef {object} Curve
 * @property {number[]} step
 * @property {number[]} x           in the unit of the axis
 * @property {number[]} ticks
 * @property {number[]} speed       [steps/s]
 * @property {number[]} shownSpeed  in the unit chosen
 * @property {number[]} delay_us
 * @property {number[]} time_s
 * @property {{step: number[], x: number[], percent: number[]}} error  against the reference
 * @property {number[] | null} acceleration                implied, in the unit chosen, at each step of the error
 * @property {Record<ErrorPart, number[]> | null} parts     of the error, in per cent of the reference's interval
 * @property {{acceleration: number[], jerk: number[]} | null} motion  as planned, in the unit chosen */

/** @typedef {object} MethodReading
 * @property {MethodName} method
 * @property {number} ticks
 * @property {number} delay_us
 * @property {number} speed      [steps/s]
 * @property {number} shownSpeed in the unit chosen
 * @property {number} percent    error against the reference; NaN: not known
 * @property {number} acceleration  as planned, in the unit chosen; NaN: not known
 * @property {number} jerk       the same
 * @property {boolean} isExact   the step was computed, or lies on a plateau; false: between two computed ones */
/** @typedef {{step: number, time_s: number, x: number, methods: MethodReading[]}} Reading */

// So much more room a move that runs is given, once it goes on, or faster, than there was room for: not anew at each sample.
const REACH_GROWS_BY = 1.25;

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
 * @param {Answer} answer @param {PlotAxis} against */
export function axisScale(answer, against) {
  const { full_steps_per_rev, microsteps, travel_per_rev, travel_unit } = answer.design.axis;
  if (against === 'position') {
    const units = unitsOf(answer);
    // Counted in steps it would be the axis of steps again: then it is in the unit that the axis travels in.
    if (units.length !== 'steps') {
      const factor = shownValue(units, answer.design, 'length', 1);
      return { factor, title: `position, ${unitWord(units, answer.design, 'length')}` };
    }
    return {
      factor: Number(travel_per_rev) / (Number(full_steps_per_rev) * Number(microsteps)),
      title: `position, ${travel_unit}`,
    };
  }
  if (against === 'time') {
    const duration = activeProfile(answer).summary.duration_s;
    return duration < 10 ? { factor: 1000, title: 'time, ms' } : { factor: 1, title: 'time, s' };
  }
  return { factor: 1, title: 'step' };
}

/** The units that an answer is shown in.
 * @param {Answer} answer */
export function unitsOf(answer) {
  return answer.units ?? STEPS_AND_SECONDS;
}

/** @param {Answer} answer @returns {Profile} */
export function activeProfile(answer) {
  return /** @type {Profile} */ (answer.profiles[answer.design.method.name]);
}

/** @param {Answer} answer @param {MethodName} method @param {PlotAxis} against @returns {Curve | null} */
export function curveOf(answer, method, against) {
  const profile = answer.profiles[method];
  if (!profile) return null;
  const { factor } = axisScale(answer, against);
  const along = against === 'step' ? profile.step : against === 'time' ? profile.time_s : profile.position_steps;
  const x = factor === 1 ? along : along.map((value) => value * factor);
  const frequency = Number(answer.design.timer.frequency_hz);
  const perStep = shownValue(unitsOf(answer), answer.design, 'speed', 1);
  const speed = profile.speed_steps_per_s;
  return {
    step: profile.step,
    x,
    ticks: profile.intervals_ticks,
    speed,
    shownSpeed: perStep === 1 ? speed : speed.map((value) => value * perStep),
    time_s: profile.time_s,
    delay_us: profile.intervals_ticks.map((ticks) => (ticks / frequency) * 1e6),
    ...errorsOf(answer, method, x),
  };
}

/** @param {Answer} answer @param {MethodName} method @param {number[]} x of each step of the method's profile
 * @returns {Pick<Curve, 'error' | 'acceleration' | 'parts' | 'motion'>} */
function errorsOf(answer, method, x) {
  const errors = answer.errors[method];
  if (!errors) return { error: { step: [], x: [], percent: [] }, acceleration: null, parts: null, motion: null };
  const { step, relative_error, implied_acceleration_steps_per_s2, parts, motion } = errors;
  const { intervals_ticks } = /** @type {Profile} */ (answer.profiles[method]);
  const perStep = shownValue(unitsOf(answer), answer.design, 'acceleration', 1);
  const jerkUnit = shownValue(unitsOf(answer), answer.design, 'jerk', 1);
  const inPercent = (/** @type {number[]} */ ticks) =>
    ticks.map((part, i) => ((part * (1 + relative_error[i])) / intervals_ticks[i]) * 100);
  return {
    // The reference is the line that the others are held against, without the rounding of its own delays.
    error:
      method === REFERENCE && !parts
        ? { step: [step[0], step[step.length - 1]], x: [x[0], x[x.length - 1]], percent: [0, 0] }
        : { step, x, percent: relative_error.map((fraction) => fraction * 100) },
    acceleration: implied_acceleration_steps_per_s2?.map((value) => value * perStep) ?? null,
    parts: parts
      ? {
          method: inPercent(parts.method),
          arithmetic: inPercent(parts.arithmetic),
          rounding: inPercent(parts.rounding),
          compression: inPercent(parts.compression),
        }
      : null,
    motion: motion
      ? {
          acceleration: motion.acceleration_steps_per_s2.map((value) => value * perStep),
          jerk: motion.jerk_steps_per_s3.map((value) => value * jerkUnit),
        }
      : null,
  };
}

/** The curves that there are, each with its method.
 * @param {Partial<Record<MethodName, Curve>>} curves @returns {[MethodName, Curve][]} */
export function entriesOf(curves) {
  return Object.entries(/** @type {Record<MethodName, Curve>} */ (curves));
}

/** What all curves say at the step of `lead` nearest to a place on the axis.
 * @param {Partial<Record<MethodName, Curve>>} curves @param {MethodName} lead @param {number} x
 * @returns {Reading | null} */
export function readingAt(curves, lead, x) {
  const curve = curves[lead];
  if (!curve || curve.step.length === 0) return null;
  const index = nearest(curve.x, x);
  const step = curve.step[index];
  const methods = entriesOf(curves).map(([method, other]) => {
    const at = lowerBound(other.step, step);
    return {
      method,
      ticks: interpolate(other.step, other.ticks, step),
      delay_us: interpolate(other.step, other.delay_us, step),
      speed: interpolate(other.step, other.speed, step),
      shownSpeed: interpolate(other.step, other.shownSpeed, step),
      percent: other.error.step.length === 0 ? NaN : interpolate(other.error.step, other.error.percent, step),
      acceleration: other.motion ? interpolate(other.step, other.motion.acceleration, step) : NaN,
      jerk: other.motion ? interpolate(other.step, other.motion.jerk, step) : NaN,
      isExact: other.step[at] === step || other.ticks[at] === other.ticks[at - 1],
    };
  });
  return { step, time_s: curve.time_s[index], x: curve.x[index], methods };
}

/** What was measured of the step nearest to a place on the axis.
 * @typedef {{delay_us: number, shownSpeed: number, deviation_us: number}} MeasuredReading */

/** @param {import('./frame.js').Measured} measured @param {number} x
 * @returns {MeasuredReading | null} null: nothing was measured there */
export function measuredReadingAt({ x: places, velocity, delay, deviation }, x) {
  const ends = [places[0], places[places.length - 1]];
  if (places.length === 0 || x < Math.min(...ends) || x > Math.max(...ends)) return null;
  const index = nearest(places, x);
  return { delay_us: delay[index], shownSpeed: velocity[index], deviation_us: deviation[index] };
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

/** The step of the plotted move that a move of any length is at: its ramps count from its own ends. NaN: the plotted move is
 * too short to have such a step.
 * @param {Profile} profile @param {number} done steps since the move began @param {number} remaining steps */
export function plottedStep(profile, done, remaining) {
  const { steps, accelerate_steps, decelerate_steps } = profile.summary;
  if (done + remaining === steps || done <= accelerate_steps) return Math.min(done, steps);
  if (remaining <= decelerate_steps) return Math.max(steps - remaining, accelerate_steps);
  if (steps <= accelerate_steps + decelerate_steps && done + remaining > steps) return NaN;
  const slew = Math.max(1, done + remaining - accelerate_steps - decelerate_steps);
  const share = (done - accelerate_steps) / slew;
  return Math.round(accelerate_steps + share * Math.max(0, steps - accelerate_steps - decelerate_steps));
}

/** @typedef {{label: string, colour: number, time_s: number[], speed: number[], delay_us: number[]}} AxisMove
 *   one of several axes; `speed` in the unit it is shown in, `colour` from 0 */
/** @typedef {{x: number, axes: {label: string, colour: number, velocity: number, delay: number}[]}} AxesReading */

/** What all axes do at a time; an axis that has arrived does nothing.
 * @param {import('./frame.js').AxisCurve[]} axes @param {number} x [s] @returns {AxesReading} */
export function axesReadingAt(axes, x) {
  return {
    x,
    axes: axes.map((axis) => {
      const isMoving = x >= axis.x[0] && x <= axis.x[axis.x.length - 1];
      const at = (/** @type {number[]} */ values) => (isMoving ? interpolate(axis.x, values, x) : NaN);
      return {
        label: axis.label,
        colour: axis.colour,
        velocity: isMoving ? at(axis.velocity) : 0,
        delay: at(axis.delay),
      };
    }),
  };
}

/** The steps of a move that was measured, with how each lies against its plan.
 * @typedef {object} MeasuredMove
 * @property {number[]} step               counted from 1
 * @property {number[]} time_s
 * @property {number[]} speed_steps_per_s
 * @property {number[]} delay_us
 * @property {number[]} deviation_us
 * @property {number | null} length        steps from rest to rest; null: not known */

/** A measured move over the axis of the plots.
 * @param {Answer} answer @param {PlotAxis} against @param {MeasuredMove} move @returns {import('./frame.js').Measured} */
export function measuredOver(answer, against, move) {
  const perStep = shownValue(unitsOf(answer), answer.design, 'speed', 1);
  const { x, broken } = placed(answer, against, plotted(answer, move.step, move.length), move.time_s);
  return {
    x,
    velocity: broken(move.speed_steps_per_s.map((speed) => speed * perStep)),
    delay: broken(move.delay_us),
    deviation: broken(move.deviation_us),
  };
}

/** What a controller plays itself, over the axis of the plots.
 * @param {Answer} answer @param {PlotAxis} against @param {import('../model/types.js').OwnRamp} own
 * @returns {import('./frame.js').OwnCurve} */
export function ownOver(answer, against, { step, start_s, speed_steps_per_s, intervals_us, relative_error }) {
  const perStep = shownValue(unitsOf(answer), answer.design, 'speed', 1);
  return {
    x: along(answer, against, step, start_s),
    velocity: speed_steps_per_s.map((speed) => speed * perStep),
    delay: intervals_us,
    error: relative_error.map((error) => 100 * error),
  };
}

/** A move that runs, over the axis of the plots.
 * @param {Answer} answer @param {PlotAxis} against
 * @param {import('../model/types.js').Samples} samples since its start [s, steps, steps/s] */
export function liveOver(answer, against, { time_s, position, speed, length }) {
  const perStep = shownValue(unitsOf(answer), answer.design, 'speed', 1);
  const { x, broken } = placed(answer, against, plotted(answer, position.map(Math.abs), length), time_s);
  return { x, velocity: broken(speed.map((each) => Math.abs(each) * perStep)) };
}

/** How far along the axis a move that runs goes, and how fast it gets: to its end, as far as that is known, or else ever further. A half
 * of there and back keeps the room of those before it.
 * @param {Answer} answer @param {PlotAxis} against @param {import('../model/types.js').Samples} samples since its start
 * @returns {{x: number, velocity: number}} */
export function reachOver(answer, against, { time_s, speed, length, earlier = { seconds: 0, speed: 0 } }) {
  const { duration_s, peak_speed_steps_per_s } = activeProfile(answer).summary;
  const end = grown(duration_s, Math.max(earlier.seconds, time_s.at(-1) ?? 0));
  const fastest = grown(peak_speed_steps_per_s, Math.max(earlier.speed, ...speed.map(Math.abs)));
  const [x] = along(answer, against, [length ?? 0], [end]);
  return { x, velocity: shownValue(unitsOf(answer), answer.design, 'speed', fastest) };
}

/** @param {number} most as planned @param {number} needed */
const grown = (most, needed) => (needed <= most ? most : most * REACH_GROWS_BY ** Math.ceil(Math.log(needed / most) / Math.log(REACH_GROWS_BY)));

/** Steps of a move of another length at the steps of the plotted one that they stand for.
 * @param {Answer} answer @param {number[]} steps @param {number | null} length null: not known; they stay */
function plotted(answer, steps, length) {
  if (length === null) return steps;
  const profile = activeProfile(answer);
  return steps.map((step) => plottedStep(profile, step, Math.max(0, length - step)));
}

/** Places on the axis, which never go back, and what breaks a line where the plotted move has no place for it.
 * @param {Answer} answer @param {PlotAxis} against @param {number[]} steps @param {number[]} times */
function placed(answer, against, steps, times) {
  const found = along(answer, against, steps, times);
  let last = 0;
  const x = found.map((place) => (last = Number.isNaN(place) ? last : place));
  return { x, broken: (/** @type {number[]} */ values) => values.map((value, i) => (Number.isNaN(found[i]) ? NaN : value)) };
}

/** Steps and times as places on the axis.
 * @param {Answer} answer @param {PlotAxis} against @param {number[]} steps @param {number[]} times */
export function along(answer, against, steps, times) {
  const { factor } = axisScale(answer, against);
  const direction = against === 'position' ? Math.sign(Number(answer.design.move.steps)) : 1;
  return (against === 'time' ? times : steps).map((value) => value * factor * direction);
}
