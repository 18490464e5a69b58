// @ts-check
// Fits: what decides about one, what it looks like, and why there is none.

import { limitsInUnit } from '../../model/limits_text.js';
import { refusalText, textOf } from '../../model/messages.js';
import { formatEntry, formatFigures } from '../../model/numbers.js';
import { previewTable } from './preview_table.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').Entry} Entry */
/** @typedef {import('../../model/types.js').FittedTable} FittedTable */
/** @typedef {import('../../server/api.js').Refusal} Refusal */
/** What a fit can be held to: as the server names it, as its field is called, in which unit, and how many of that one of
 * the server's is.
 * @typedef {{name: 'rows' | 'largest_relative_error' | 'bytes', label: string, unit: string, factor: number}} Wish */

/** What decides about a fit.
 * @param {Design} design */
export function fitKey({ ramp, timer, method, move, table }) {
  return JSON.stringify([ramp, timer, method, move, table?.interval_unit]);
}

/** @param {FittedTable} fitted @param {string} unit */
export function rowsPreview({ table, linear_rows, relative_errors }, unit) {
  const heads = ['#', 'last index', `delay, ${unit}`, ...(linear_rows ? ['each step'] : []), 'error'];
  const rows = (table?.rows ?? linear_rows ?? []).map((row, index) => [
    ...[index + 1, ...row].map(formatEntry),
    `${relative_errors[index] === 0 ? 0 : formatFigures(relative_errors[index] * 100, 3)} %`,
  ]);
  return previewTable(heads, rows);
}

/** Why there is no fit; what is wrong with the wish, in the words and the unit of its field.
 * @param {Refusal} refusal @param {Wish} wish @param {Entry} typed */
export function problemOf({ rejections }, { name, label, unit, factor }, typed) {
  const found = rejections.find(({ field }) => field === name);
  if (found === undefined) return textOf(rejections);
  const given = typeof typed === 'number' && factor !== 1 ? `${formatEntry(typed)} ${unit}` : undefined;
  const allowed = found.limits && limitsInUnit(found.limits, unit, factor);
  return refusalText({ ...found, value: typed }, label, { given, allowed });
}
