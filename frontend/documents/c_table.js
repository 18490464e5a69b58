// @ts-check
// A lookup table written as C and as CSV.

/** @typedef {import('../model/design.js').Rows} Rows */

const WIDEST_16_BIT = 65535;

/** @param {Rows} rows of numbers @param {string} unit 'us' or 'ticks' */
export function tableAsC(rows, unit) {
  const type = rows.flat().every((value) => Number(value) <= WIDEST_16_BIT) ? 'uint16_t' : 'uint32_t';
  const lines = rows.map(([index, delay]) => `  {${index}, ${delay}},\n`);
  return (
    `/* A row: last ramp index, delay in ${unit}. */\n` +
    `const ${type} ramp_table[${rows.length}][2] = {\n${lines.join('')}};\n`
  );
}

/** @param {Rows} rows of numbers @param {string} unit 'us' or 'ticks' */
export function tableAsCsv(rows, unit) {
  return [`last_index,delay_${unit}`, ...rows.map((row) => row.join(','))].map((line) => `${line}\r\n`).join('');
}

/** @param {[number, number, number][]} rows last index, delay at the first step, what is added each step
 * @param {string} unit 'us' or 'ticks' */
export function linearTableAsC(rows, unit) {
  const lines = rows.map((row) => `  {${row.join(', ')}},\n`);
  return (
    `/* A row: last ramp index, delay at its first step in ${unit}, what is added each step. */\n` +
    `const int32_t ramp_table[${rows.length}][3] = {\n${lines.join('')}};\n`
  );
}
