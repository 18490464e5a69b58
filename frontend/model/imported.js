// @ts-check
// What an import of several axes tells beside their designs.

/** What is not as the controller has it: once what holds for all axes, by its name what holds for some.
 * @param {{design: {name: string}, remarks: string[]}[]} axes
 * @returns {string[]} */
export function remarksOf(axes) {
  const all = [...new Set(axes.flatMap(({ remarks }) => remarks))];
  const isOfAll = (/** @type {string} */ remark) => axes.every(({ remarks }) => remarks.includes(remark));
  const own = axes.flatMap(({ design, remarks }) => remarks.filter((remark) => !isOfAll(remark)).map((remark) => `${design.name}: ${remark}`));
  return [...all.filter(isOfAll), ...own];
}
