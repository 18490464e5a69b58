// @ts-check
// What a gauge library would meet in the rows: asked of the server once they have changed, and again while nobody answers.

import { createQuestion } from '../../app/effects/question.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/messages.js').RowMessage} RowMessage */
/** @typedef {import('../../model/types.js').Entry} Entry */
/** @typedef {{row: number, reason: string, wrong: boolean}} Finding */

// A slider under the hand changes what is checked many times a second, and the curves come first.
const QUIET_FOR_MS = 150;

/**
 * @param {(table: object) => Promise<{findings: Finding[]}>} checkTable
 * @param {() => void} onFound
 */
export function createChecks(checkTable, onFound) {
  /** @type {Map<number, RowMessage>} */
  let found = new Map();
  let asked = '';
  /** @type {number | null} */
  let axis = null;
  const question = createQuestion({
    ask: checkTable,
    take: ({ findings }) => show(messagesOf(findings)),
    // What is wrong with the design itself is said elsewhere.
    refuse: () => show(new Map()),
    afterMs: QUIET_FOR_MS,
  });

  /** @param {Map<number, RowMessage>} messages */
  function show(messages) {
    found = messages;
    onFound();
  }

  return {
    /** By row. */
    found: () => found,
    /** The server is back. */
    again: question.again,
    /** @param {Design} design @param {number} of the axis that it is of */
    check(design, of) {
      const wanted = tableToCheck(design);
      const isAnother = of !== axis;
      axis = of;
      if (JSON.stringify(wanted) === asked) return;
      asked = JSON.stringify(wanted);
      if (isAnother || wanted === null) {
        question.cancel();
        show(new Map());
      }
      if (wanted !== null) question.want(wanted);
    },
  };
}

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

/** @param {Design} design @returns {object | null} null: there are no rows, or some that can't be checked */
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
