// @ts-check
// Where tables come from: rows that were fitted, or that came with a design, are of its ramp. When the ramp is another one
// by now, they can be fitted anew. Rows that a person typed, dragged or pasted are meant as they are.

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').FitWish} FitWish */
/** @typedef {{ramp: string, wish: FitWish | null}} Origin   wish: that of the fit, if it was one */

export function createOrigins() {
  /** By the rows and their unit.
   * @type {Map<string, Origin>} */
  const origins = new Map();
  /** The axes that were shown already: the rows of others come with their design.
   * @type {Set<number>} */
  const seen = new Set();
  /** A slider under the hand asks of the same rows many times a second.
   * @type {WeakMap<object, string>} */
  const keys = new WeakMap();

  /** @param {NonNullable<Design['table']>} table */
  function keyOf(table) {
    const key = keys.get(table) ?? JSON.stringify([table.rows, table.interval_unit]);
    keys.set(table, key);
    return key;
  }

  return {
    /** The rows of a table were fitted to the ramp of a design.
     * @param {NonNullable<Design['table']>} table @param {Design} design @param {FitWish} wish */
    fitted(table, design, wish) {
      origins.set(keyOf(table), { ramp: rampOf(design), wish });
    },
    /** An axis is shown: for the first time, its rows came with its design. Of which ramp they are nobody knows where it is
     * none, as when the page was left with a wrong value.
     * @param {Design} design @param {number} axis its id */
    shown(design, axis) {
      const { table } = design;
      if (table && isNumbers(design) && !seen.has(axis) && !origins.has(keyOf(table))) origins.set(keyOf(table), { ramp: rampOf(design), wish: null });
      seen.add(axis);
    },
    /** Forget all but those of these tables, and of these axes.
     * @param {Design['table'][]} tables @param {Set<number>} axes their ids */
    prune(tables, axes) {
      const present = new Set(tables.map((table) => table && keyOf(table)));
      for (const key of origins.keys()) if (!present.has(key)) origins.delete(key);
      for (const axis of seen) if (!axes.has(axis)) seen.delete(axis);
    },
    /** The wish for rows that suit the ramp again; null: they suit it, or are a person's own.
     * @param {Design} design @returns {{wish: FitWish, isFit: boolean} | null} */
    staleWish(design) {
      const origin = design.table && origins.get(keyOf(design.table));
      if (!design.table || !origin || !isNumbers(design) || origin.ramp === rampOf(design)) return null;
      const { rows, interval_unit } = design.table;
      const same = { rows: rows.length, row_kind: /** @type {const} */ ('constant'), fit_to: /** @type {const} */ ('played') };
      return { wish: { ...(origin.wish ?? same), interval_unit }, isFit: origin.wish !== null };
    },
  };
}

/** Whether the ramp is one: what a person types may be no number yet.
 * @param {Design} design */
const isNumbers = ({ ramp, timer }) => ![...Object.values(ramp), timer.frequency_hz].some((value) => typeof value === 'string');

/** @param {Design} design */
function rampOf({ ramp, timer }) {
  return JSON.stringify([ramp, timer.frequency_hz]);
}
