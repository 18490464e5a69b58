// @ts-check
// What an import of several axes tells beside their designs.

import { sentencesInUnits } from './told.js';

/** @typedef {import('./types.js').ReadAxis} ReadAxis */

/** What is not as the controller has it, of one axis, in the units that are shown.
 * @param {import('./units.js').Units} units */
export const remarksIn = (units) => (/** @type {ReadAxis} */ { design, remarks, remarks_told }) => sentencesInUnits(units, [design], remarks, remarks_told);

/** What is not as the controller has it: once what holds for all axes, by its name what holds for some.
 * @param {ReadAxis[]} axes @param {import('./units.js').Units} units that are shown
 * @returns {string[]} */
export function remarksOf(axes, units) {
  const ofEach = axes.map(remarksIn(units));
  const all = [...new Set(ofEach.flat())];
  const isOfAll = (/** @type {string} */ remark) => ofEach.every((remarks) => remarks.includes(remark));
  const own = axes.flatMap(({ design }, place) => ofEach[place].filter((remark) => !isOfAll(remark)).map((remark) => `${design.name}: ${remark}`));
  return [...all.filter(isOfAll), ...own];
}
