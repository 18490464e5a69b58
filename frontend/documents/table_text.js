// @ts-check
// Lookup tables in a text: C, be it a bare initialiser, its declaration or a whole file, or lines of cells as CSV and
// spreadsheets have them.

import { readArrays } from './c_arrays.js';
import { sheetRows } from './sheet.js';
import { Unreadable } from './unreadable.js';

/** The unit is that which the text names; none: it names none. A table that can't be read has a problem in place of rows.
 * @typedef {{name: string, line: number, unit?: 'us' | 'ticks'} &
 *   ({rows: [number, number][], problem: null} | {rows: null, problem: string})} Table */
/** @typedef {{tables: Table[], problem: null} | {tables: null, problem: string}} ReadTables */

/** No text longer than this is read [characters]. */
export const LONGEST_SOURCE = 2_000_000;
const COMMENT = /\/\*[^]*?(?:\*\/|$)|\/\/[^\n]*/g;

/**
 * Read all tables, at least one, or say why there is none.
 * @param {string} text
 * @returns {ReadTables}
 */
export function readTables(text) {
  try {
    return { tables: tablesIn(text.replace(/^\ufeff/, '').replaceAll('\r\n', '\n')), problem: null };
  } catch (error) {
    if (!(error instanceof Unreadable)) throw error;
    return { tables: null, problem: error.message };
  }
}

/** @param {string} text @returns {Table[]} */
function tablesIn(text) {
  if (text.length > LONGEST_SOURCE) {
    const [length, limit] = [text.length, LONGEST_SOURCE].map((count) => count.toLocaleString('en-US'));
    throw new Unreadable(`The text has ${length} characters; at most ${limit} are read.`);
  }
  const code = text.replace(COMMENT, ' ');
  if (code.trim() === '') throw new Unreadable('There is nothing to read yet.');
  const isC = /[{}]|^[ \t]*#[ \t]*(?:include|define|if|pragma)|^[ \t]*[a-z_]\w*[ \t]+[a-z_][^;,\n]*;[ \t]*$/im.test(code);
  const found = isC
    ? readArrays(text)
    : [{ name: '', line: 1, about: text, rows: sheetRows(code), problem: null }];
  const tables = found.map(tableOf);
  const [only] = tables;
  if (tables.length === 1 && only.rows === null) throw new Unreadable(only.problem);
  return tables;
}

/** @param {import('./c_arrays.js').ReadArray} found @returns {Table} */
function tableOf({ name, line, about, rows, problem }) {
  if (rows === null) return { name, line, rows, problem };
  const unit = namedUnit(about);
  return { name, line, rows: rows.map(([index, delay]) => [index, delay]), problem, ...(unit === null ? {} : { unit }) };
}

/** The unit of the delays that a heading or a comment names.
 * @param {string} text @returns {'us' | 'ticks' | null} */
function namedUnit(text) {
  const isUs = /(µs|μs|(^|[^a-z])us([^a-z]|$)|microsec)/i.test(text);
  const isTicks = /ticks?([^a-z]|$)/i.test(text);
  return isUs === isTicks ? null : isUs ? 'us' : 'ticks';
}
