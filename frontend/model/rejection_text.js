// @ts-check
// What the server refuses, told in the unit that is shown. The server speaks of steps and seconds.

import { limitsInUnit } from './limits_text.js';
import { refusalText } from './messages.js';
import { formatEntry } from './numbers.js';
import { factorOf, shownEntry, unitOf } from './shown_entry.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./fields.js').Field} Field */
/** @typedef {import('./messages.js').Message} Message */
/** @typedef {import('./units.js').Units} Units */

/** The message in the unit that is shown, by the design that it is said of; else by the one given.
 * @param {Message | undefined} message @param {Units} units @param {Design} design @param {Field} field
 * @returns {Message | undefined} */
export function inShownUnit(message, units, design, field) {
  if (message?.refused?.unit !== field.unit) return message;
  const of = message.design ?? design;
  return inUnit(message, field, unitOf(units, of, field), factorOf(units, of, field));
}

/** The message in a unit of which the one that it is refused in has so many.
 * @param {Message} message @param {Pick<Field, 'label'>} field @param {string} unit @param {number} factor
 * @returns {Message} */
export function inUnit(message, field, unit, factor) {
  const { refused } = message;
  if (refused?.limits === undefined || factor === 1) return message;
  const { value } = refused;
  const given =
    typeof value === 'number'
      ? `${shownEntry(value, factor)} ${unit} (${formatEntry(value)} ${refused.unit})`
      : undefined;
  const allowed = limitsInUnit(refused.limits, unit, factor, value);
  return { ...message, text: refusalText(refused, field.label, { given, allowed }) };
}
