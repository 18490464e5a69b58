// @ts-check
// What is told of the fastest ramps.

import { valueAt } from './design.js';
import { areEqual } from './equal.js';
import { usedText } from './motor_words.js';
import { formatFigures } from './numbers.js';
import { USUAL_SHAPE } from './shapes.js';
import { shownValue, unitWord } from './units.js';

/** @typedef {import('./types.js').Design} Design */

const SHAPE = 'ramp.shape';
const FIGURES = 4;

/** Each figure by what it is called.
 * @param {import('./types.js').FastestFigures} figures @param {import('./units.js').Units} units @param {Design} design
 * @returns {[string, string][]} */
export function figuresOf({ duration_s, ramp_up_s, peak_speed_steps_per_s, acceleration_steps_per_s2, most_used }, units, design) {
  const shown = (/** @type {'speed' | 'acceleration'} */ quantity, /** @type {number | null} */ value) =>
    `${formatFigures(shownValue(units, design, quantity, value ?? NaN), FIGURES)} ${unitWord(units, design, quantity)}`;
  return [
    ['Move', timeText(duration_s ?? NaN)],
    ['Ramp up', timeText(ramp_up_s ?? NaN)],
    ['Peak speed', shown('speed', peak_speed_steps_per_s)],
    ['Acceleration', shown('acceleration', acceleration_steps_per_s2)],
    ['Torque used', usedText(most_used)],
  ];
}

/** @param {number} time [s] */
const timeText = (time) => (time < 1 ? `${formatFigures(time * 1000, FIGURES)} ms` : `${formatFigures(time, FIGURES)} s`);

/** Whether a design is as changes would make it.
 * @param {Design} design @param {import('./types.js').Remedy['changes']} changes */
export const isInUse = (design, changes) =>
  changes.every(({ field, value }) => areEqual(valueAt(design, field) ?? (field === SHAPE ? { name: USUAL_SHAPE } : null), value));
