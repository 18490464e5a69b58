// @ts-check
// Rows of a lookup table before they are used: what of them would be refused, and which delays can be rounded.

import { refusalText, rowLabel } from './messages.js';
import { beyond, DESIGN_TAKES, refusalOf } from './taken.js';

/** @typedef {import('./types.js').Rejection} Rejection */
/** Last index and delay.
 * @typedef {[number, number]} Row */

/** The words for the units of delays. */
export const DELAY_UNITS = /** @type {Record<string, string>} */ ({ us: 'µs', ticks: 'ticks' });
const INDEX = DESIGN_TAKES['table.rows.0'];
const DELAY = DESIGN_TAKES['table.rows.1'];
const MOST_STEPS = INDEX.limits[1];

/** What the server would refuse of rows, a sentence for each number.
 * @param {Row[]} rows @param {string} unit of their delays, as designs name it */
export function rowProblems(rows, unit) {
  const delay = { ...DELAY, unit: DELAY_UNITS[unit] };
  return rows.flatMap((row, index) => {
    const found = [
      refusalOf(pathOf(index, 0), row[0], INDEX) ?? orderRefusal(rows, index),
      refusalOf(pathOf(index, 1), row[1], delay),
    ];
    return found.flatMap((one, column) => (one ? [refusalText(one, rowLabel(index, column))] : []));
  });
}

/** Why an index can't be where it is: each is more than the one before, the last of all indices has none behind it.
 * @param {Row[]} rows @param {number} index @returns {Rejection | null} */
function orderRefusal(rows, index) {
  const [before, own, next] = [rows[index - 1]?.[0] ?? -1, rows[index][0], rows[index + 1]?.[0]];
  if (own === MOST_STEPS && next !== undefined) {
    const note = `, so that row ${index + 2} can lie behind it`;
    return beyond(pathOf(index, 0), own, { lowest: 0, highest: MOST_STEPS - 1, is_whole: true, note }, INDEX.unit);
  }
  if (own > before || before >= MOST_STEPS) return null;
  const lowest = Math.floor(before) + 1;
  const note = ': more than the ramp index of the row before';
  return beyond(pathOf(index, 0), own, { lowest, highest: MOST_STEPS, is_whole: true, note }, INDEX.unit);
}

/** @param {number} index @param {number} column */
const pathOf = (index, column) => `table.rows.${index}.${column}`;

/** The rows with whole delays, and how many of them had to be rounded for that.
 * @param {Row[]} rows */
export function roundedRows(rows) {
  const rounded = rows.filter(([, delay]) => !Number.isInteger(delay)).length;
  return { rows: rows.map(([index, delay]) => /** @type {Row} */ ([index, Math.round(delay)])), rounded };
}
