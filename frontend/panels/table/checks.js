// @ts-check
// What a gauge library would meet in the rows: asked of the server once they have changed.

import { newestWins } from '../../newest.js';

/** @typedef {import('../../types.js').Design} Design */
/** @typedef {import('../../messages.js').RowMessage} RowMessage */
/** @typedef {import('../../types.js').Entry} Entry */

// A slider under the hand changes what is checked many times a second, and the curves come first.
const QUIET_FOR_MS = 150;

/**
 * @param {(table: object) => Promise<{findings: {row: number, reason: string, wrong: boolean}[]}>} checkTable
 * @param {() => void} onFound
 */
export function createChecks(checkTable, onFound) {
  /** @type {Map<number, RowMessage>} */
  let found = new Map();
  let asked = '';
  let waiting = 0;
  /** @type {object | null} */
  let wanted = null;

  const ask = newestWins(async () => {
    found = new Map();
    for (const { row, reason, wrong } of await findings()) {
      const earlier = found.get(row);
      const text = earlier ? `${earlier.text}; ${reason}` : reason.charAt(0).toUpperCase() + reason.slice(1);
      found.set(row, { column: null, text, isWarning: true, isRemark: !wrong && (earlier?.isRemark ?? true) });
    }
    onFound();
  });

  async function findings() {
    if (wanted === null) return [];
    try {
      return (await checkTable(wanted)).findings;
    } catch {
      // The server is gone, or says about the design what is wrong. The next change asks again.
      asked = '';
      return [];
    }
  }

  return {
    /** By row. What is wrong with the design itself is said elsewhere. */
    found: () => found,
    /** @param {Design} design */
    check(design) {
      const next = tableToCheck(design);
      if (JSON.stringify(next) === asked) return;
      asked = JSON.stringify(next);
      wanted = next;
      clearTimeout(waiting);
      waiting = window.setTimeout(ask, QUIET_FOR_MS);
    },
  };
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
