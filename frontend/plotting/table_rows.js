// @ts-check
// The rows of a lookup table as points of a plot: where each lies, how far it may be moved, and the rows after a move.
// A row holds up to its last ramp index. The first step of a ramp is at index 2, so a row's last step is its index less
// one. Nothing of the page.

/** @typedef {import('../model/types.js').Design} Design */
/** @typedef {import('../model/types.js').Entry} Entry */
/** @typedef {import('../model/design.js').Rows} Rows */
/** @typedef {import('./curves.js').PlotAxis} PlotAxis */

/** How the steps of a move become values of the axis; `factor` from seconds on a time axis, from steps on the others.
 * @typedef {{against: PlotAxis, factor: number}} Scale */

/** `index` is the row's last ramp index; both may be anything until they are kept within the row's limits.
 * @typedef {{index: number, delay: number}} Place */

// What the server takes.
const LEAST_INDEX = 0;
const MOST_INDEX = 10_000_000;
const SHORTEST_DELAY = 1;
export const LONGEST_DELAY = 2 ** 32 - 1;

const NUDGE = 0.01;
const COARSE_NUDGE = 0.1;

/** Ticks of a delay, as the design rounds them.
 * @param {Design} design @param {number} delay in the table's unit */
function ticksOf(design, delay) {
  if (design.table?.interval_unit === 'ticks') return delay;
  const ticks = (delay * Number(design.timer.frequency_hz)) / 1e6;
  if (design.method.rounding === 'floor') return Math.floor(ticks + 1e-9);
  return design.method.rounding === 'carry' ? ticks : Math.round(ticks);
}

/** @param {Design} design @param {number} delay in the table's unit */
export function delayInUs(design, delay) {
  return (ticksOf(design, delay) / Number(design.timer.frequency_hz)) * 1e6;
}

/** The whole delay in the table's unit nearest to a time.
 * @param {Design} design @param {number} us */
export function delayFromUs(design, us) {
  return Math.round(design.table?.interval_unit === 'ticks' ? (us * Number(design.timer.frequency_hz)) / 1e6 : us);
}

/** When the first step of a row goes out and which ramp index that is; rows before that hold no number are left out.
 * @param {Design} design @param {Rows} rows @param {number} row */
function startOf(design, rows, row) {
  let [seconds, index] = [0, 1];
  for (const [last, delay] of rows.slice(0, row)) {
    if (typeof last !== 'number' || typeof delay !== 'number') continue;
    seconds += (Math.max(0, last - index) * delayInUs(design, delay)) / 1e6;
    index = Math.max(index, last);
  }
  return { seconds, index };
}

/** Where a row's point lies along the axis: at the row's last step.
 * @param {Design} design @param {Rows} rows
 * @param {number} row @param {Scale} scale */
export function rowX(design, rows, row, { against, factor }) {
  const [last, delay] = rows[row].map((entry) => (typeof entry === 'number' ? entry : NaN));
  if (against !== 'time') return (last - 1) * factor;
  const start = startOf(design, rows, row);
  return (start.seconds + ((last - start.index - 1) * delayInUs(design, delay)) / 1e6) * factor;
}

/** The ramp index that would put a row's point at a place of the axis, given the row's delay; not rounded.
 * @param {Design} design @param {Rows} rows @param {number} row @param {number} delay @param {Scale} scale
 * @param {number} x */
export function indexAtX(design, rows, row, delay, { against, factor }, x) {
  if (against !== 'time') return x / factor + 1;
  const start = startOf(design, rows, row);
  return start.index + 1 + ((x / factor - start.seconds) * 1e6) / delayInUs(design, delay);
}

/** The ramp indices that a row may end at: between the rows beside it.
 * @param {Rows} rows @param {number} row */
export function indexLimits(rows, row) {
  const before = rows.slice(0, row).findLast(isSound);
  const after = rows.slice(row + 1).find(isSound);
  return {
    least: before ? Number(before[0]) + 1 : LEAST_INDEX,
    most: after ? Number(after[0]) - 1 : MOST_INDEX,
  };
}

/** @param {[Entry, Entry]} row */
export function isSound([index, delay]) {
  return Number.isFinite(index) && Number.isFinite(delay);
}

/** The rows with one of them moved, as far as it may be: where there is no room between its neighbours it stays.
 * @param {Rows} rows @param {number} row @param {Place} place @returns {Rows} */
export function movedRow(rows, row, place) {
  const { least, most } = indexLimits(rows, row);
  const index = least > most ? Number(rows[row][0]) : Math.min(most, Math.max(least, Math.round(place.index)));
  const delay = Math.min(LONGEST_DELAY, Math.max(SHORTEST_DELAY, Math.round(place.delay)));
  return rows.with(row, [index, delay]);
}

/** What an arrow key makes of a row: about 1 % of its index or delay more or less, with Shift 10 %, with Alt the least
 * that makes a difference.
 * @param {Rows} rows @param {number} row @param {string} key
 * @param {{shiftKey: boolean, altKey: boolean}} held @returns {Rows | null} null: the key is another */
export function nudgedRow(rows, row, key, { shiftKey, altKey }) {
  const [index, delay] = rows[row].map(Number);
  const share = shiftKey || key.startsWith('Page') ? COARSE_NUDGE : NUDGE;
  const by = (/** @type {number} */ value) => (altKey ? 1 : Math.max(1, Math.round(Math.abs(value) * share)));
  const places = {
    ArrowLeft: () => ({ index: index - by(index), delay }),
    ArrowRight: () => ({ index: index + by(index), delay }),
    ArrowUp: () => ({ index, delay: delay + by(delay) }),
    ArrowDown: () => ({ index, delay: delay - by(delay) }),
    PageUp: () => ({ index, delay: delay + by(delay) }),
    PageDown: () => ({ index, delay: delay - by(delay) }),
  };
  const place = places[/** @type {keyof typeof places} */ (key)];
  return place ? movedRow(rows, row, place()) : null;
}

/** The rows with one more at its place among them, and which it is; a row that ends there already is not doubled.
 * @param {Rows} rows @param {Place} place @returns {{rows: Rows, row: number}} */
export function withRowAt(rows, place) {
  const index = Math.min(MOST_INDEX, Math.max(LEAST_INDEX, Math.round(place.index)));
  const delay = Math.min(LONGEST_DELAY, Math.max(SHORTEST_DELAY, Math.round(place.delay)));
  const same = rows.findIndex(([last]) => last === index);
  if (same >= 0) return { rows, row: same };
  const after = rows.findIndex(([last]) => typeof last === 'number' && last > index);
  const row = after < 0 ? rows.length : after;
  return { rows: rows.toSpliced(row, 0, [index, delay]), row };
}
