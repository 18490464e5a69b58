// @ts-check
// A drawn acceleration as text: a point a line, a speed and the part of the acceleration that holds there.

import { parseEntry } from './numbers.js';
import { MOST_POINTS } from './shapes.js';
import { readEntry, shownEntry } from './shown_entry.js';

/** @typedef {import('./types.js').Entry} Entry */

/** The lines of a text, without those that are empty.
 * @param {string} text */
export const linesOf = (text) => text.split(/\r?\n/).map((line) => line.trim()).filter((line) => line !== '');

/** The points of a text. What is no number stays as it was typed, for the server to name. A first line of words over lines of
 * numbers is a heading.
 * @param {string} text @param {number} factor of the unit that speeds are shown in @returns {[Entry, Entry][]} */
export function pointsOf(text, factor) {
  const points = linesOf(text).map((line) => {
    const [speed, ...rest] = columnsOf(line);
    return /** @type {[Entry, Entry]} */ ([readEntry({ isWhole: false }, speed, factor).entry, parseEntry(rest.join(' '))]);
  });
  return isHeading(points[0]) && points.slice(1).some((point) => point.every(Number.isFinite)) ? points.slice(1) : points;
}

/** @param {[Entry, Entry] | undefined} point */
const isHeading = (point) => point !== undefined && point.every((entry) => typeof entry === 'string' && /^[^\d]*[a-z]/i.test(entry));

/** As spreadsheets and CSV files part them: a comma does only where nothing else does, else it is of a number.
 * @param {string} line */
const columnsOf = (line) =>
  /[\s;]/.test(line) ? line.split(/[\s;]+/).map((column) => column.replace(/,$/, '')) : line.split(',');

/** @param {[Entry, Entry][]} points @param {number} factor of the unit that speeds are shown in */
export const pointsText = (points, factor) =>
  points.map(([speed, part]) => `${typeof speed === 'number' ? shownNumber(speed, factor) : speed}  ${part}`).join('\n');

/** Without separators: a comma would part columns.
 * @param {number} speed @param {number} factor */
const shownNumber = (speed, factor) => (factor === 1 ? String(speed) : shownEntry(speed, factor).replaceAll(',', ''));

/** @typedef {[number, number]} Point  a speed [steps/s] and the part of the acceleration that holds there */

// What the server takes.
const LEAST_PART = 0.001;
const FEWEST_POINTS = 2;
const PART_DIGITS = 3;
const SPEED_FIGURES = 4;
const NUDGE = 0.01;
const COARSE_NUDGE = 0.1;
const FINE_NUDGE = 0.001;
const HIGHEST_SPEED = 1_000_000;

/** The points as numbers, when all of them can be drawn: speeds that increase, no more than the server takes.
 * @param {[Entry, Entry][] | undefined} points @returns {Point[] | null} */
export function drawablePoints(points) {
  const isDrawable =
    points !== undefined &&
    points.length >= FEWEST_POINTS &&
    points.length <= MOST_POINTS &&
    points.every((point) => point.every(Number.isFinite)) &&
    points.every(([speed], i) => i === 0 || Number(speed) > Number(points[i - 1][0]));
  return isDrawable ? /** @type {Point[]} */ (points) : null;
}

/** The points with one of them moved, as far as it may be: between its neighbours, and within what the server takes. One that
 * is closer to a neighbour than a hand brings it may stay so.
 * @param {Point[]} points @param {number} index @param {Point} place @returns {Point[]} */
export function movedPoint(points, index, [speed, part]) {
  const [own] = points[index];
  const stride = strideAt(points);
  const least = index === 0 ? 0 : Math.min(own, points[index - 1][0] + stride);
  const most = index === points.length - 1 ? HIGHEST_SPEED : Math.max(own, points[index + 1][0] - stride);
  const kept = Math.min(most, Math.max(least, speed));
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
    ArrowLeft: [tidied(speed - across), part],
    ArrowRight: [tidied(speed + across), part],
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
  const added = /** @type {Point} */ ([tidied(speed), part]);
  return { points: movedPoint(points.toSpliced(index, 0, added), index, added), index };
}

/** The points without one; null where there would be too few.
 * @param {Point[]} points @param {number} index @returns {Point[] | null} */
export const withoutPoint = (points, index) => (points.length > FEWEST_POINTS ? points.toSpliced(index, 1) : null);

/** The least that two speeds are apart [steps/s].
 * @param {Point[]} points */
const strideAt = (points) => Math.max(points[points.length - 1][0], 1) * FINE_NUDGE;

/** A speed as a hand sets it.
 * @param {number} value */
export const tidied = (value) => Number(value.toPrecision(SPEED_FIGURES));
