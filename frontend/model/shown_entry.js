// @ts-check
// A field's content in the unit that is shown, and back. The design keeps steps and seconds whatever is shown.

import { formatEntry, nearestWhole, parseEntry, tidy } from './numbers.js';
import { shownValue, unitWord } from './units.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Entry} Entry */
/** @typedef {import('./fields.js').Field} Field */
/** @typedef {import('./units.js').Units} Units */

// Of a converted value as many figures are shown as a field has room for.
const FIGURES = 8;

/** How many of the unit shown one of the design's units is.
 * @param {Units} units @param {Design} design @param {Field} field */
export function factorOf(units, design, { quantity }) {
  return quantity === undefined ? 1 : shownValue(units, design, quantity, 1);
}

/** The word for the unit shown; of a share, such as "of the work", its name says what it is of.
 * @param {Units} units @param {Design} design @param {Field} field */
export function unitOf(units, design, { quantity, unit }) {
  if (quantity !== undefined) return unitWord(units, design, quantity);
  return unit.startsWith('of ') ? '' : unit;
}

/** A field's content as it is shown: a number in the design's own unit with all its digits, a converted one with about
 * eight, text as it was typed.
 * @param {Entry} entry @param {number} factor */
export function shownEntry(entry, factor) {
  if (typeof entry === 'string' || factor === 1) return formatEntry(entry);
  const value = entry * factor;
  return formatEntry(Math.abs(value) >= 10 ** FIGURES ? Math.round(value) : Number(value.toPrecision(FIGURES)));
}

/** What typed text is in the design's unit. A field of whole numbers takes a converted one to the nearest: `exact` is
 * what it would have been, null when it is that.
 * @param {Pick<Field, 'isWhole'>} field @param {string} text @param {number} factor
 * @returns {{entry: Entry, exact: number | null}} */
export function readEntry({ isWhole }, text, factor) {
  const typed = parseEntry(text);
  if (typeof typed === 'string' || factor === 1) return { entry: typed, exact: null };
  const stored = tidy(typed / factor);
  // Beyond all numbers: it stays as it was typed, to be refused by name.
  if (!Number.isFinite(stored)) return { entry: text.trim(), exact: null };
  const entry = isWhole ? nearestWhole(stored) : stored;
  return { entry, exact: entry === stored ? null : stored };
}

/** A length that is no whole number of steps: as it was typed, and the steps that it would be.
 * @typedef {{text: string, exact: number}} Between */

/** A motor makes whole steps: what a typed length becomes.
 * @param {Between} between @param {number} whole @param {string} unit @param {number} factor */
export const roundingText = ({ text, exact }, whole, unit, factor) =>
  `${text} ${unit} would be ${formatEntry(exact)} steps: it is ${formatEntry(whole)}, ${shownEntry(whole, factor)} ${unit}.`;

/** Whether it is refused because it is nothing at all.
 * @param {import('./types.js').Rejection | undefined} refused */
export const isNothing = (refused) => refused?.value === 0 && /but not 0/.test(refused.allowed ?? '');

/** Why a length that becomes no step is refused.
 * @param {Between} between @param {string} unit @param {number} factor */
export const tooShortText = ({ text }, unit, factor) =>
  `${text} ${unit} is less than half a step; the least is ${shownEntry(1, factor)} ${unit}.`;
