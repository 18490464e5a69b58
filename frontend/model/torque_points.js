// @ts-check
// A torque curve as text: a line a point, its speed in rpm and its torque in Nm, as spreadsheets and CSV files have them.

import { formatFixed, parseEntry, pointHint } from './numbers.js';
import { MOST_POINTS } from './shapes.js';

/** @typedef {[number, number]} TorquePoint  [rpm] and [Nm] */

const LONGEST_SHOWN = 30;

/** The points of a text, and what is wrong with each line that is none. A heading may come first.
 * @param {string} text @returns {{points: TorquePoint[], problems: string[]}} */
export function torquePointsOf(text) {
  const lines = text.split(/\r?\n/).map((line, index) => ({ line: line.trim(), number: index + 1 }));
  const filled = lines.filter(({ line }) => line !== '');
  // Nobody reads what is wrong with each of them.
  if (filled.length > MOST_POINTS + 1) return { points: [], problems: [tooMany(filled.length)] };
  const read = filled.map(({ line, number }) => ({ line, number, columns: columnsOf(line).map(parseEntry) }));
  const isHeading = read.length > 1 && read[0].columns.every((column) => typeof column === 'string');
  /** @type {{points: TorquePoint[], problems: string[]}} */
  const found = { points: [], problems: [] };
  for (const { line, number, columns } of isHeading ? read.slice(1) : read) {
    const [rpm, torque] = columns;
    const before = found.points.at(-1)?.[0] ?? -Infinity;
    if (columns.length !== 2 || typeof rpm !== 'number' || typeof torque !== 'number')
      found.problems.push(`Line ${number} is “${shortened(line)}”; allowed: two numbers, the speed in rpm and the torque in Nm.${commaHint(line)}`);
    else if (rpm <= before) found.problems.push(`Line ${number}: the speed is ${rpm} rpm; allowed: more than ${before} rpm, that of the point before.`);
    else found.points.push([rpm, torque]);
  }
  if (found.points.length > MOST_POINTS) found.problems.push(tooMany(found.points.length));
  return found;
}

/** @param {number} count */
const tooMany = (count) => `These are ${formatFixed(count)} points; allowed: 2 to ${MOST_POINTS}.`;

/** What to write in place of a decimal comma.
 * @param {string} line */
const commaHint = (line) => line.split(/[\s;]+/).map(pointHint).find((hint) => hint !== '') ?? '';

/** A comma parts columns only where nothing else does, else it is of a number.
 * @param {string} line */
const columnsOf = (line) => (/[\t;]/.test(line) ? line.split(/[\t;]/) : /,/.test(line) ? line.split(',') : line.split(/\s+/)).map((column) => column.trim());

/** @param {string} line */
const shortened = (line) => (line.length > LONGEST_SHOWN ? `${line.slice(0, LONGEST_SHOWN)}…` : line);

/** @param {readonly (readonly import('./types.js').Entry[])[]} points */
export const torquePointsText = (points) => points.map((point) => point.join(', ')).join('\n');
