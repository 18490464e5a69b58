// @ts-check
// Reading a lookup table out of pasted text: a C initialiser such as `{ 10, 5000 }, { 30, 1500 }`, alone or within its
// declaration, or two numbers a line as a spreadsheet gives them.

/** @typedef {{rows: [number, number][], problem: null} | {rows: null, problem: string}} Reading */

const C_NUMBER = /^[+-]?(0x[0-9a-f]+|(\d+\.?\d*|\.\d+)(e[+-]?\d+)?)$/i;

/**
 * Read the rows of a table, or say what can't be understood and where.
 * @param {string} text
 * @returns {Reading}
 */
export function parseTable(text) {
  const code = text.replace(/\/\*[\s\S]*?\*\//g, ' ').replace(/\/\/[^\n]*/g, ' ');
  if (code.trim() === '') return { rows: null, problem: 'There is nothing to read yet.' };
  try {
    const rows = code.includes('{') || code.includes('}') ? initialiserRows(code) : lineRows(code);
    return { rows: rows.map(([step, interval]) => [step, interval]), problem: null };
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

/** Rows of an initialiser without inner braces: `{ 10, 5000, 30, 1500 }`. @param {string} body */
function flatRows(body) {
  const words = body.split(',').filter((word) => word.trim() !== '');
  if (words.length === 0) throw new Unreadable('No row found between the braces.');
  if (words.length % 2 !== 0) throw new Unreadable(`${words.length} numbers don’t make rows of two.`);
  return words.filter((_, index) => index % 2 === 0).map((word, index) => pair([word, words[2 * index + 1]], index));
}

/** @param {string} text two numbers a line, parted by commas, semicolons, tabs or spaces */
function lineRows(text) {
  const lines = text
    .split('\n')
    .map((line) => line.trim())
    .filter((line) => line !== '');
  return lines.map((line, index) => pair(line.split(/\s*[,;\t]\s*|\s+/), index));
}

/** @param {string[]} words @param {number} index of the row, from 0 */
function pair(words, index) {
  const values = words.map((word) => word.trim());
  if (values.length === 3 && values[2] === '') values.pop();
  if (values.length === 1 && values[0] === '') throw new Unreadable(`Row ${index + 1}: a number is missing.`);
  if (values.length !== 2) {
    throw new Unreadable(
      `Row ${index + 1} has ${values.length} value${values.length === 1 ? '' : 's'}; a row is last step and delay.`,
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
