// @ts-check
// A lookup table as text. Read from a C initialiser such as `{ 10, 5000 }, { 30, 1500 }`, alone or within its
// declaration, or from lines of cells as CSV and spreadsheets have them; written as C and as CSV.

/** @typedef {import('./design.js').Rows} Rows */
/** The unit is that which the text names; none: it names none.
 * @typedef {{rows: [number, number][], problem: null, unit?: 'us' | 'ticks'} | {rows: null, problem: string, unit?: undefined}} Reading */

const C_NUMBER = /^[+-]?(0x[0-9a-f]+|(\d+\.?\d*|\.\d+)(e[+-]?\d+)?)$/i;

/**
 * Read the rows of a table, or say what can't be understood and where.
 * @param {string} text
 * @returns {Reading}
 */
export function parseTable(text) {
  const code = text
    .replace(/^\ufeff/, '')
    .replace(/\/\*[\s\S]*?\*\//g, ' ')
    .replace(/\/\/[^\n]*/g, ' ');
  if (code.trim() === '') return { rows: null, problem: 'There is nothing to read yet.' };
  try {
    const rows = code.includes('{') || code.includes('}') ? initialiserRows(code) : lineRows(code);
    const unit = namedUnit(text);
    return {
      rows: rows.map(([step, interval]) => [step, interval]),
      problem: null,
      ...(unit === null ? {} : { unit }),
    };
  } catch (error) {
    if (error instanceof Unreadable) return { rows: null, problem: error.message };
    throw error;
  }
}

/** Raised inside this module only: its message is the problem shown. */
class Unreadable extends Error {}

/** @param {string} code C text with at least one brace @returns {number[][]} */
function initialiserRows(code) {
  const body = withinBraces(code);
  const groups = [...body.matchAll(/\{([^{}]*)\}/g)];
  const outside = body.replace(/\{[^{}]*\}/g, '').replace(/[\s,;]/g, '');
  if (/[{}]/.test(outside)) throw new Unreadable('Braces are nested deeper than rows within one table.');
  if (groups.length === 0) return flatRows(body);
  if (outside !== '')
    throw new Unreadable(`“${shortened(outside)}” stands between the rows, which are { step, delay }.`);
  return groups.map((group, index) => pair(group[1].split(','), index));
}

/** Take off the declaration and the outer braces: `T name[][2] = { … };`.
 * @param {string} code */
function withinBraces(code) {
  const depth = [...code].reduce((open, sign) => open + Number(sign === '{') - Number(sign === '}'), 0);
  if (depth !== 0)
    throw new Unreadable(
      depth > 0 ? `${depth} closing brace(s) “}” missing.` : `${-depth} opening brace(s) “{” missing.`,
    );
  const declaration = code.indexOf('=') >= 0 && code.indexOf('=') < code.indexOf('{') ? code.indexOf('=') + 1 : 0;
  const initialiser = code.slice(declaration).trim();
  const outer =
    /^\{([\s\S]*\}[\s,]*)\}\s*;?\s*$/.exec(initialiser) ??
    (declaration > 0 ? /^\{([\s\S]*)\}\s*;?\s*$/.exec(initialiser) : null);
  return outer && isBalanced(outer[1]) ? outer[1] : initialiser;
}

/** @param {string} code whether no brace closes before it opens, so that what was cut off was one pair */
function isBalanced(code) {
  let open = 0;
  for (const sign of code) {
    open += Number(sign === '{') - Number(sign === '}');
    if (open < 0) return false;
  }
  return true;
}

/** Rows of an initialiser without inner braces: `{ 10, 5000, 30, 1500 }`.
 * @param {string} body */
function flatRows(body) {
  const words = body.split(',').filter((word) => word.trim() !== '');
  if (words.length === 0) throw new Unreadable('No row found between the braces.');
  if (words.length % 2 !== 0) throw new Unreadable(`${words.length} numbers don’t make rows of two.`);
  return words.filter((_, index) => index % 2 === 0).map((word, index) => pair([word, words[2 * index + 1]], index));
}

/** The unit of the delays that a heading or a comment names.
 * @param {string} text @returns {'us' | 'ticks' | null} */
function namedUnit(text) {
  const isUs = /(µs|μs|(^|[^a-z])us([^a-z]|$)|microsec)/i.test(text);
  const isTicks = /ticks?([^a-z]|$)/i.test(text);
  return isUs === isTicks ? null : isUs ? 'us' : 'ticks';
}

/** @param {string} text a row a line, its cells parted by tabs, semicolons, commas or spaces */
function lineRows(text) {
  const lines = text
    .split('\n')
    .map((line) => line.replace(/\r$/, ''))
    .filter((line) => line.trim() !== '' && !/^sep=.$/i.test(line.trim()))
    .map(cellsOf);
  const hasHeading = lines.length > 1 && lines[0].length > 1 && lines[0].every((cell) => !/\d/.test(cell));
  if (!hasHeading) return lines.map((cells, index) => pair(cells, index));
  const [heading, ...body] = lines;
  const [step, delay] = columnsOf(heading);
  return body.map((cells, index) => pair([cells[step] ?? '', cells[delay] ?? ''], index));
}

/** Which columns a heading calls the step and the delay; the first two where it says nothing of them.
 * @param {string[]} heading */
function columnsOf(heading) {
  const step = heading.findIndex((cell) => /step|index/i.test(cell) && !/\//.test(cell));
  const delay = heading.findIndex((cell) => /delay|interval|period|wait/i.test(cell));
  if (step >= 0 && delay >= 0) return [step, delay];
  if (heading.length === 2) return [0, 1];
  throw new Unreadable(
    `The heading has ${heading.length} columns, and none that are called “step” and “delay”: “${shortened(heading.join(', '))}”.`,
  );
}

/** @param {string} line */
function cellsOf(line) {
  const separator = ['\t', ';', ','].find((sign) => line.includes(sign)) ?? ' ';
  if (separator === ' ') return line.trim().split(/\s+/);
  // Quotation marks keep a separator within a cell.
  const cells = line.match(CELLS[separator]) ?? [];
  return cells.map((cell) =>
    plainNumber(
      cell
        .trim()
        .replace(/^"(.*)"$/, '$1')
        .trim(),
    ),
  );
}

/** Patterns of cells by separator.
 * @type {Record<string, RegExp>} */
const CELLS = {
  ',': /("[^"]*"|[^,])+|(?<=,|^)(?=,|$)/g,
  ';': /("[^"]*"|[^;])+|(?<=;|^)(?=;|$)/g,
  '\t': /("[^"]*"|[^\t])+|(?<=\t|^)(?=\t|$)/g,
};

/** A number as a spreadsheet writes it, without what parts its thousands and with a point for a decimal comma: 8,284 and
 * 1.234.567 are whole, as rows are; 1500,5 is not. Other text stays.
 * @param {string} cell */
function plainNumber(cell) {
  if (/^[+-]?[1-9]\d{0,2}([ ,'’\u00a0\u202f]\d{3})+(\.\d*)?$/.test(cell))
    return cell.replace(/[ ,'’\u00a0\u202f]/g, '');
  if (/^[+-]?[1-9]\d{0,2}(\.\d{3}){2,}$|^[+-]?[1-9]\d{0,2}(\.\d{3})+,\d+$/.test(cell))
    return cell.replaceAll('.', '').replace(',', '.');
  return /^[+-]?\d+,\d+$/.test(cell) ? cell.replace(',', '.') : cell;
}

/** @param {string[]} words @param {number} index of the row, from 0 */
function pair(words, index) {
  const values = words.map((word) => word.trim());
  if (values.length === 3 && values[2] === '') values.pop();
  if (values.length === 1 && values[0] === '') throw new Unreadable(`Row ${index + 1}: a number is missing.`);
  if (values.length !== 2) {
    throw new Unreadable(
      `Row ${index + 1} has ${values.length} value${values.length === 1 ? '' : 's'}; a row is last index and delay.`,
    );
  }
  return values.map((value) => number(value, index));
}

/** @param {string} word @param {number} index of the row, from 0 */
function number(word, index) {
  const hexadecimal = /^[+-]?0x/i.test(word);
  const digits = word.replace(hexadecimal ? /[ul]+$/i : /([ul]+|f)$/i, '');
  if (!C_NUMBER.test(digits))
    throw new Unreadable(
      `Row ${index + 1}: ${word === '' ? 'a number is missing' : `“${shortened(word)}” is not a number`}.`,
    );
  if (/^[+-]?0\d/.test(digits) && !digits.includes('.')) {
    throw new Unreadable(`Row ${index + 1}: “${word}” is octal in C; write it without the leading zero.`);
  }
  const value = hexadecimal ? parseInt(digits, 16) : Number(digits);
  if (!Number.isFinite(value)) throw new Unreadable(`Row ${index + 1}: “${shortened(word)}” is too large.`);
  return value;
}

/** @param {string} text */
function shortened(text) {
  const line = text.replace(/\s+/g, ' ');
  return line.length > 32 ? `${line.slice(0, 31)}…` : line;
}

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
