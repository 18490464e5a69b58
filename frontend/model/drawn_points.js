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

/** @typedef {[number, number]} Point  a speed [steps/s] and the part of the acceleration that holds there */

// What the server takes.
const LEAST_PART = 0.001;
const FEWEST_POINTS = 2;
const PART_DIGITS = 3;
const SPEED_FIGURES = 4;
const NUDGE = 0.01;
const COARSE_NUDGE = 0.1;
const FINE_NUDGE = 0.001;

/** The points as numbers, when all of them can be drawn: speeds that increase.
 * @param {[Entry, Entry][] | undefined} points @returns {Point[] | null} */
export function drawablePoints(points) {
  const isDrawable =
    points !== undefined &&
    points.length >= FEWEST_POINTS &&
    points.every((point) => point.every(Number.isFinite)) &&
    points.every(([speed], i) => i === 0 || Number(speed) > Number(points[i - 1][0]));
  return isDrawable ? /** @type {Point[]} */ (points) : null;
}

/** The points with one of them moved, as far as it may be: between its neighbours, and within what the server takes.
 * @param {Point[]} points @param {number} index @param {Point} place @returns {Point[]} */
export function movedPoint(points, index, [speed, part]) {
  const [own] = points[index];
  const stride = strideAt(points);
  const least = index === 0 ? 0 : points[index - 1][0] + stride;
  const most = index === points.length - 1 ? Infinity : points[index + 1][0] - stride;
  const kept = least > most ? own : Math.min(most, Math.max(least, tidied(speed)));
  return points.with(index, [kept, Math.min(1, Math.max(LEAST_PART, Number(part.toFixed(PART_DIGITS))))]);
}

/** What an arrow key makes of a point: 1 % of the whole more or less, with Shift 10 %, with Alt a thousandth.
 * @param {Point[]} points @param {number} index @param {string} key @param {{shiftKey: boolean, altKey: boolean}} held
 * @returns {Point[] | null} null: the key is another */
export function nudgedPoint(points, index, key, { shiftKey, altKey }) {
  const by = altKey ? FINE_NUDGE : shiftKey || key.startsWith('Page') ? COARSE_NUDGE : NUDGE;
  const [speed, part] = points[index];
  const across = by * points[points.length - 1][0];
  const places = /** @type {Record<string, Point>} */ ({
    ArrowLeft: [speed - across, part],
    ArrowRight: [speed + across, part],
    ArrowUp: [speed, part + by],
    ArrowDown: [speed, part - by],
    PageUp: [speed, part + by],
    PageDown: [speed, part - by],
  });
  return key in places ? movedPoint(points, index, places[key]) : null;
}

/** The points with one more at its place among them, and which it is; one that is there already is not doubled.
 * @param {Point[]} points @param {Point} place @param {number} most so many there may be
 * @returns {{points: Point[], index: number}} */
export function withPointAt(points, [speed, part], most) {
  const stride = strideAt(points);
  const near = points.findIndex(([other]) => Math.abs(other - speed) < stride);
  if (near >= 0 || points.length >= most) return { points, index: near };
  const after = points.findIndex(([other]) => other > speed);
  const index = after < 0 ? points.length : after;
  return { points: movedPoint(points.toSpliced(index, 0, [tidied(speed), part]), index, [speed, part]), index };
}

/** The points without one; null where there would be too few.
 * @param {Point[]} points @param {number} index @returns {Point[] | null} */
export const withoutPoint = (points, index) => (points.length > FEWEST_POINTS ? points.toSpliced(index, 1) : null);

/** The least that two speeds are apart [steps/s].
 * @param {Point[]} points */
const strideAt = (points) => Math.max(points[points.length - 1][0], 1) * FINE_NUDGE;

/** @param {number} value */
const tidied = (value) => Number(value.toPrecision(SPEED_FIGURES));
