// @ts-check
// What the rotor does with each damping, as a table.

import { formatFigures, formatFixed } from './numbers.js';

const MS_PER_S = 1000;
const DEGREES_PER_FULL_STEP = 90;
/** So long the server watches the rotor after the last interval [periods of its natural frequency]. */
const WATCHED_PERIODS = 12;
const ALMOST = 0.99;

/** The rows of the table, a text for each damping.
 * @param {Pick<import('./types.js').MotorAnswer, 'runs' | 'natural_frequency_hz'>} answer @returns {{label: string, texts: string[]}[]} */
export function runRows({ runs, natural_frequency_hz: naturalFrequencyHz }) {
  const watched_s = WATCHED_PERIODS / naturalFrequencyHz;
  const figures = (/** @type {number} */ value) => (value === 0 ? '0' : formatFigures(value, 2));
  /** @type {[string, (run: import('./types.js').MotorRun) => string][]} */
  const rows = [
    ['Full steps lost', ({ lost_full_steps: lost }) => formatFixed(Math.abs(lost))],
    ['First lost at step', ({ first_lost_step: step }) => (step === null ? 'none' : formatFixed(step))],
    ['Largest load angle', ({ largest_load_angle_deg: angle }) => `${formatFixed(angle)}°`],
    ['Ripple of the slew speed', ({ speed_ripple: ripple }) => (ripple === null ? 'no slew' : `± ${figures(ripple * 100)} %`)],
    ['Overshoot at the stop', ({ overshoot_deg: angle }) => `${figures(angle / DEGREES_PER_FULL_STEP)} full steps`],
    ['Settled after', ({ settled_after_s: time }) => `${time < ALMOST * watched_s ? '' : 'not within '}${figures(time * MS_PER_S)} ms`],
  ];
  return rows.map(([label, text]) => ({ label, texts: runs.map(text) }));
}
