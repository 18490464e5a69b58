// @ts-check
// What a gauge library would meet in the rows: asked of the server once they have changed, and again while nobody answers.

import { createQuestion } from '../../app/effects/question.js';
import { areEqual } from '../../model/equal.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/messages.js').RowMessage} RowMessage */
/** @typedef {import('../../model/types.js').Entry} Entry */
/** @typedef {{row: number, reason: string, wrong: boolean}} Finding */
/** Rows that can be checked, and what they are checked for.
 * @typedef {{rows: [Entry, Entry][], interval_unit: string, frequency_hz: number, slew_interval_us: number | null}} Table */
/** What was found, by row of the table that was asked about.
 * @typedef {{of: Table, messages: Map<number, RowMessage>}} Found */

// A slider under the hand changes what is checked many times a second, and the curves come first.
const QUIET_FOR_MS = 150;

/**
 * @param {(table: Table, ended: AbortSignal) => Promise<{findings: Finding[]}>} checkTable
 * @param {() => void} onFound
 */
export function createChecks(checkTable, onFound) {
  /** null: nothing is known.
   * @type {Found | null} */
  let found = null;
  /** @type {Table | null} */
  let present = null;
  /** @type {number | null} */
  let axis = null;
  const question = createQuestion({
    ask: checkTable,
    take: ({ findings }, of) => show({ of, messages: messagesOf(findings) }),
    // What is wrong with the design itself is said elsewhere.
    refuse: () => show(null),
    miss: () => show(null),
    afterMs: QUIET_FOR_MS,
  });

  /** @param {Found | null} known */
  function show(known) {
    found = known;
    onFound();
  }

  return {
    /** By row: of those that are where they were when they were asked about.
     * @returns {Map<number, RowMessage>} */
    found: () => new Map([...(found?.messages ?? [])].filter(([row]) => found && present && areSameAt(row, found.of, present))),
    /** The server is back. */
    again: question.again,
    /** @param {Design} design @param {number} of the axis that it is of */
    check(design, of) {
      const wanted = tableToCheck(design);
      const isAnother = of !== axis;
      axis = of;
      if (areEqual(wanted, present)) return;
      present = wanted;
      if (isAnother || wanted === null) {
        question.cancel();
        found = null;
      }
      onFound();
      if (wanted !== null) question.want(wanted);
    },
  };
}

/** Whether a row is the same in both tables, and what it comes after.
 * @param {number} row @param {Table} one @param {Table} other */
const areSameAt = (row, one, other) =>
  one.interval_unit === other.interval_unit &&
  [row - 1, row].every((at) => areEqual(one.rows[at] ?? null, other.rows[at] ?? null));

/** @param {Finding[]} findings @returns {Map<number, RowMessage>} by row */
function messagesOf(findings) {
  const found = new Map();
  for (const { row, reason, wrong } of findings) {
    const earlier = found.get(row);
    const text = earlier ? `${earlier.text}; ${reason}` : reason.charAt(0).toUpperCase() + reason.slice(1);
    found.set(row, { column: null, text, isWarning: true, isRemark: !wrong && (earlier?.isRemark ?? true) });
  }
  return found;
}

/** @param {Design} design @returns {Table | null} null: there are no rows, or some that can't be checked */
function tableToCheck({ table, timer, ramp }) {
  const isWhole = (/** @type {[Entry, Entry]} */ [index, delay]) =>
    Number.isInteger(index) && Number.isInteger(delay) && Number(index) >= 0 && Number(delay) >= 1;
  if (table === null || !(Number(timer.frequency_hz) >= 1) || !table.rows.every(isWhole)) return null;
  const speed = Number(ramp.slew_speed_steps_per_s);
  return {
    rows: table.rows,
    interval_unit: table.interval_unit,
    frequency_hz: Number(timer.frequency_hz),
    slew_interval_us: speed >= 0.001 ? 1e6 / speed : null,
  };
}
