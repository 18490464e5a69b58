// @ts-check
// What a remedy does, in the units that are shown. The server says it in steps.

import { valueAt } from '../../model/design.js';
import { formatEntry } from '../../model/numbers.js';
import { shownValue, unitsFor, unitWord } from '../../model/units.js';

/** @typedef {import('../../model/units.js').Quantity} Quantity */

/** @type {Record<string, {quantity: Quantity, word: string}>} */
const FIELDS = {
  'ramp.base_speed_steps_per_s': { quantity: 'speed', word: 'base speed' },
  'ramp.slew_speed_steps_per_s': { quantity: 'speed', word: 'slew speed' },
  'ramp.acceleration_steps_per_s2': { quantity: 'acceleration', word: 'acceleration' },
  'ramp.deceleration_steps_per_s2': { quantity: 'acceleration', word: 'deceleration' },
  'ramp.shape.jerk_steps_per_s3': { quantity: 'jerk', word: 'jerk' },
  'ramp.shape.deceleration_jerk_steps_per_s3': { quantity: 'jerk', word: 'jerk down' },
};
const FIGURES = 4;

/** The server's words, where they are in the units that are shown or about something else.
 * @param {import('../../model/types.js').Remedy} remedy @param {import('../../model/types.js').Design} design whose it is
 * @param {import('../../model/units.js').Units} units */
export function remedyWords({ text, changes }, design, units) {
  const { length, time } = unitsFor(units, design);
  const known = changes.every(({ field, value }) => field in FIELDS && typeof value === 'number');
  if (!known || changes.length === 0 || (length === 'steps' && time === 's')) return sentence(text);
  return sentence(changes.map((change) => changeWords(change, design, units)).join(' and '));
}

/** @param {{field: string, value: unknown}} change @param {import('../../model/types.js').Design} design
 * @param {import('../../model/units.js').Units} units */
function changeWords({ field, value }, design, units) {
  const { quantity, word } = FIELDS[field];
  // A deceleration that isn't set is the acceleration.
  const present = valueAt(design, field) ?? design.ramp.acceleration_steps_per_s2;
  const verb = Number(value) < Number(present) ? 'lower' : 'raise';
  const shown = formatEntry(Number(shownValue(units, design, quantity, Number(value)).toPrecision(FIGURES)));
  return `${verb} the ${word} to about ${shown} ${unitWord(units, design, quantity)}`;
}

/** @param {string} text */
const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1);
