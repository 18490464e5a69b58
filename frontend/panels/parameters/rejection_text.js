// @ts-check
// What the server refuses, told in the unit that is shown. The server speaks of steps and seconds.

import { formatEntry } from '../../numbers.js';
import { factorOf, shownEntry, unitOf } from './shown_entry.js';

/** @typedef {import('../../types.js').Design} Design */
/** @typedef {import('../../fields.js').Field} Field */
/** @typedef {import('../../messages.js').Message} Message */
/** @typedef {import('../../units.js').Units} Units */

const NUMBER = /(from |at least )?(-?\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?)/g;
// The figures of a converted limit.
const FIGURES = 6;

/** The message in the unit that is shown. A warning stays as it is: it says itself which units its numbers are in.
 * @param {Message | undefined} message @param {Units} units @param {Design} design @param {Field} field
 * @returns {Message | undefined} */
export function inShownUnit(message, units, design, field) {
  const factor = factorOf(units, design, field);
  if (message?.refused === undefined || factor === 1) return message;
  const { value, allowed } = message.refused;
  const unit = unitOf(units, design, field);
  const limits = convertedLimits(allowed, field.unit, unit, factor);
  if (limits === null) return message;
  const given =
    typeof value === 'number'
      ? `${shownEntry(value, factor)} ${unit} (${formatEntry(value)} ${field.unit})`
      : `'${value}'`;
  return { ...message, text: `${field.label} is ${given}; allowed: ${limits}.` };
}

/** What is allowed, with the numbers that the unit belongs to converted: those that stand before it. Limits are rounded
 * inwards, so that what is told is allowed. Null when nothing is said of the unit.
 * @param {string} allowed @param {string} stored unit @param {string} shown unit @param {number} factor */
function convertedLimits(allowed, stored, shown, factor) {
  const end = unitPlace(allowed, stored);
  if (end < 0) return null;
  const numbers = allowed.slice(0, end).replace(NUMBER, (_, before, digits) => {
    const limit = Number(digits.replaceAll(',', '')) * factor;
    return (before ?? '') + formatEntry(roundedTo(limit, before === undefined ? Math.floor : Math.ceil));
  });
  const words = numbers.replace('a whole number', 'whole steps');
  return words + shown + allowed.slice(end + stored.length);
}

/** Where the unit itself stands, not one that begins alike.
 * @param {string} text @param {string} unit */
function unitPlace(text, unit) {
  const found = new RegExp(`${unit}(?![\\w/²])`).exec(text);
  return found?.index ?? -1;
}

/** @param {number} limit @param {(value: number) => number} toWhole */
function roundedTo(limit, toWhole) {
  if (limit === 0) return 0;
  const scale = 10 ** (FIGURES - 1 - Math.floor(Math.log10(Math.abs(limit))));
  // Noise of the conversion must not push a limit to its neighbour.
  return Number((toWhole(Number((limit * scale).toPrecision(12))) / scale).toPrecision(FIGURES));
}
