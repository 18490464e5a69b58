// @ts-check
// Fits: what decides about one, what it looks like, and why there is none.

import { Refusal } from '../../server/api.js';
import { formatEntry, formatFigures } from '../../model/numbers.js';
import { previewTable } from './preview_table.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').FittedTable} FittedTable */

/** What decides about a fit.
 * @param {Design} design */
export function fitKey({ ramp, timer, method, move, table }) {
  return JSON.stringify([ramp, timer, method, move, table?.interval_unit]);
}

/** @param {FittedTable} fitted @param {string} unit */
export function rowsPreview({ table, linear_rows, relative_errors }, unit) {
  const heads = ['#', 'to index', `delay, ${unit}`, ...(linear_rows ? ['each step'] : []), 'error'];
  const rows = (table?.rows ?? linear_rows ?? []).map((row, index) => [
    ...[index + 1, ...row].map(formatEntry),
    `${relative_errors[index] === 0 ? 0 : formatFigures(relative_errors[index] * 100, 3)} %`,
  ]);
  return previewTable(heads, rows);
}

/** @param {unknown} error */
export function problemOf(error) {
  if (!(error instanceof Error)) throw error;
  const [rejection] = error instanceof Refusal ? error.rejections : [];
  if (rejection?.field !== 'largest_relative_error') return error.message;
  const percent = Number((Number(rejection.value) * 100).toPrecision(6));
  return `${formatEntry(percent)} % is refused: as a fraction, an error is ${rejection.allowed}.`;
}
