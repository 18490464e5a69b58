// @ts-check
// A captured move over the axis of the plots: its steps where the plan has them, and marks where something is wrong.

import { activeProfile, along, interpolate, measuredOver, unitsOf } from './curves.js';
import { formatFigures, formatFixed } from '../model/numbers.js';
import { shownValue } from '../model/units.js';

/** @typedef {import('../model/types.js').Answer} Answer */
/** @typedef {import('../model/types.js').MarkedSteps} MarkedSteps */
/** @typedef {import('./curves.js').PlotAxis} PlotAxis */
/** @typedef {NonNullable<import('../model/types.js').Captured['move']>} CapturedSteps */
/** @typedef {{move: CapturedSteps, isStale: boolean}} ShownCapture  isStale: it is of an earlier design */
/** @typedef {'missing' | 'extra' | 'short'} MarkName */
/** @typedef {{x: number[], velocity: number[], delay: number[]}} Marks  each where the plan is then */
/** @typedef {import('./frame.js').Measured & {isStale: boolean, marks: Record<MarkName, Marks>}} CapturedCurve */

const NOISE_US = 0.001;
/** More of them are marked in the plots. */
const MOST_NAMED = 5;
/** The signs of what is marked, as Plotly calls them and as they are written; and among which steps those are counted.
 * @type {Record<MarkName, {symbol: string, sign: string, word: string, among: string}>} */
export const MARKS = {
  missing: { symbol: 'x-thin-open', sign: '×', word: 'missing', among: 'planned' },
  extra: { symbol: 'cross-thin-open', sign: '+', word: 'extra', among: 'measured' },
  short: { symbol: 'triangle-down', sign: '▼', word: 'too short', among: 'measured' },
};

/** Which steps are marked: the first few by their numbers, among the planned or the measured ones.
 * @param {MarkName} mark @param {MarkedSteps} marked */
export function markedStepsText(mark, { count, step }) {
  const named = step.slice(0, MOST_NAMED).map((one) => formatFixed(one));
  const more = count > named.length ? ' …' : '';
  return `${MARKS[mark].among} step${count === 1 ? '' : 's'} ${named.join(', ')}${more}`;
}

/** How much later than planned, in words. No analyser tells parts of a nanosecond: that is the noise of arithmetic.
 * @param {number} us */
export const deviationText = (us) => (Math.abs(us) < NOISE_US ? '0 µs' : `${formatFigures(us, 3)} µs`);

/** What the plots show of a captured move: its steps under the numbers that the plan has for them.
 * @param {CapturedSteps} move @returns {import('../model/types.js').Measured} */
export function measuredIn({ step, time_s: time, speed_steps_per_s: speed, interval_us: interval, deviation }) {
  const planned = deviation?.planned_step ?? step;
  const used = planned.flatMap((number, index) => (number > 0 ? [index] : []));
  // A wait that an extra pulse ends is no step's.
  const cut = new Set(deviation?.extra.step.map((number) => number - 1));
  const of = (/** @type {(number | null)[]} */ values) => used.map((index) => values[index] ?? NaN);
  const whole = (/** @type {(number | null)[]} */ values) => used.map((index) => (cut.has(step[index]) ? NaN : (values[index] ?? NaN)));
  return {
    step: of(planned),
    time_s: of(time),
    speed_steps_per_s: whole(speed),
    delay_us: whole(interval),
    deviation_us: of(deviation?.deviation_us ?? []),
    length: null,
  };
}

/** @param {Answer} answer @param {PlotAxis} against @param {ShownCapture} shown @returns {CapturedCurve} */
export function capturedOver(answer, against, { move, isStale }) {
  const { deviation, short_pulses: short } = move;
  const measured = measuredOver(answer, against, measuredIn(move));
  return {
    ...measured,
    isStale,
    marks: {
      missing: marksOver(answer, against, deviation?.missing),
      extra: marksOver(answer, against, deviation?.extra),
      short: marksOver(answer, against, short),
    },
  };
}

/** Marks have their place by their time: a step that was not planned has no number among the planned ones.
 * @param {Answer} answer @param {PlotAxis} against @param {MarkedSteps | null | undefined} marked @returns {Marks} */
function marksOver(answer, against, marked) {
  const { step, time_s, speed_steps_per_s } = activeProfile(answer);
  const perStep = shownValue(unitsOf(answer), answer.design, 'speed', 1);
  const isThere = (/** @type {number} */ at) => answer.range === null || (at >= time_s[0] && at <= time_s[time_s.length - 1]);
  const times = (marked?.time_s ?? []).filter(isThere);
  const speeds = times.map((at) => interpolate(time_s, speed_steps_per_s, at));
  return {
    x: along(answer, against, times.map((at) => interpolate(time_s, step, at)), times),
    velocity: speeds.map((speed) => speed * perStep),
    delay: speeds.map((speed) => 1e6 / speed),
  };
}
