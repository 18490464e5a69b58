// @ts-check
// The rows that others took the place of, by axis: they can be put back.

/** @typedef {import('../../model/design.js').Rows} Rows */
/** @typedef {{rows: Rows, unit: string}} Replaced */

export function createReplaced() {
  /** By the axis's id.
   * @type {Map<number, Replaced>} */
  const replaced = new Map();

  return {
    /** Others take the place of these rows.
     * @param {number} axis @param {Replaced} before */
    keep(axis, before) {
      replaced.set(axis, before);
    },
    /** Those to put back: they are kept no longer.
     * @param {number} axis @returns {Replaced | undefined} */
    take(axis) {
      const before = replaced.get(axis);
      replaced.delete(axis);
      return before;
    },
    /** The rows of an axis are shown: the same as before when it was undone, so that there is nothing to put back.
     * @param {number} axis @param {Replaced} rows */
    shown(axis, rows) {
      if (JSON.stringify(replaced.get(axis)) === JSON.stringify(rows)) replaced.delete(axis);
    },
    /** How many rows can be put back.
     * @param {number} axis */
    count: (axis) => replaced.get(axis)?.rows.length ?? 0,
    /** Forget all but those of these axes.
     * @param {Set<number>} axes their ids */
    prune(axes) {
      for (const axis of replaced.keys()) if (!axes.has(axis)) replaced.delete(axis);
    },
  };
}
