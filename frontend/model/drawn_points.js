// @ts-check
// A drawn acceleration as text: a point a line, a speed and the part of the acceleration that holds there.

import { parseEntry } from './numbers.js';

/** @typedef {import('./types.js').Entry} Entry */


/** The points of a text. What is no number stays as it was typed, for the server to name.
 * @param {string} text @returns {[Entry, Entry][]} */
export function pointsOf(text) {
  const lines = text.split(/\r?\n/).map((line) => line.trim());
  return lines.filter((line) => line !== '').map((line) => {
    const [speed, ...rest] = columnsOf(line);
    return [parseEntry(speed), parseEntry(rest.join(' '))];
  });
}

/** As spreadsheets and CSV files part them: a comma does only where nothing else does, else it is of a number.
 * @param {string} line */
const columnsOf = (line) =>
  /[\s;]/.test(line) ? line.split(/[\s;]+/).map((column) => column.replace(/,$/, '')) : line.split(',');

/** @param {[Entry, Entry][]} points */
export const pointsText = (points) => points.map((point) => point.map(String).join('  ')).join('\n');
