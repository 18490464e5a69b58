// @ts-check
// Arrays of two numbers a row in C and C++: a bare initialiser, its declaration, or a whole file with whatever else stands
// in it.

import { counted } from '../model/numbers.js';
import { namesIn, numberOf } from './c_numbers.js';
import { refuseTooMany, rowOf, withoutEmptyEnd } from './table_row.js';
import { shortened, Unreadable } from './unreadable.js';

/** @typedef {import('./c_numbers.js').Names} Names */
/** `about` is what is said of it in the text: the comment before its declaration, and all that stands within.
 * @typedef {{name: string, line: number, sizes: string[], body: string, about: string,
 *   missing: number}} FoundArray   closing braces that are missing */
/** @typedef {{name: string, line: number, about: string} &
 *   ({rows: number[][], problem: null} | {rows: null, problem: string})} ReadArray */

const COMMENT_OR_TEXT = /\/\*[\s\S]*?(?:\*\/|$)|\/\/[^\n]*|"(?:\\.|[^"\\\n])*"|'\\?[^\n]'/g;
const FARTHEST_COMMENT = 2000;
const DECLARATION = /\b([a-z_]\w*)\s*(?:((?:\[[^[\]{};]*\]\s*)+)([^=;{}[\]]{0,200}?))?(?:(=)\s*)?\{/gi;

/** The arrays whose rows are of two numbers: those declared so and, where there is none, those that hold such rows.
 * @param {string} text @returns {ReadArray[]} @throws {Unreadable} when there is none */
export function readArrays(text) {
  // Every sign keeps its place.
  const code = text.replace(COMMENT_OR_TEXT, (hidden) => hidden.replace(/[^\n]/g, ' '));
  const names = namesIn(code);
  const arrays = arraysIn(code, text);
  const declared = arrays.filter(({ sizes }) => sizes.length === 2 && isTwo(sizes[1], names));
  const found = declared.length > 0 ? declared : arrays.filter(holdsPairs);
  if (found.length > 0) return found.map((array) => reading(array, names));
  if (arrays.length === 0) return [bareArray(code, text, names)];
  // A single one of unsaid size is meant as a table: what is wrong with it is told.
  const [{ sizes, body }] = arrays;
  if (arrays.length === 1 && (sizes.length === 0 || (sizes.length === 1 && groupsIn(body).length > 0)))
    return [reading(arrays[0], names)];
  const others = arrays.map((array) => array.name + array.sizes.map((size) => `[${size}]`).join(''));
  throw new Unreadable(
    `No array here has rows of two numbers, as name[][2] = { { 10, 5000 }, … } has: ${listed(others)}.`,
  );
}

/** @param {string[]} words */
function listed(words) {
  const most = 4;
  const rest = words.length - most;
  return [...words.slice(0, most), ...(rest > 0 ? [`and ${rest} more`] : [])].join(', ');
}

/** @param {string} code @param {string} text the same with its comments @returns {FoundArray[]} */
function arraysIn(code, text) {
  const found = [];
  let end = 0;
  let line = 1;
  for (const match of code.matchAll(DECLARATION)) {
    const [whole, name, brackets = '', between = '', equals = ''] = match;
    const begin = match.index ?? 0;
    const isDeclared = equals === '=' || (brackets !== '' && /^[\w\s]*$/.test(between));
    if (begin < end || !isDeclared) continue;
    const open = begin + whole.length - 1;
    line += code.slice(end, begin).split('\n').length - 1;
    const about = aboutBegin(code, text, begin);
    const { depth, closed } = closing(code, open);
    end = closed;
    found.push({
      name,
      line,
      sizes: [...brackets.matchAll(/\[([^\]]*)\]/g)].map(([, size]) => size.trim()),
      body: code.slice(open + 1, depth === 0 ? end - 1 : end),
      missing: depth,
      about: text.slice(about, lineEnd(text, end)),
    });
    line += code.slice(begin, end).split('\n').length - 1;
  }
  return found;
}

/** Where what is said of a declaration begins: after the statement before it, or after an empty line.
 * @param {string} code @param {string} text @param {number} at */
function aboutBegin(code, text, at) {
  const statement = Math.max(code.lastIndexOf(';', at), code.lastIndexOf('}', at)) + 1;
  const from = Math.max(statement, at - FARTHEST_COMMENT);
  const paragraph = /[^]*\n[^\S\n]*\n/.exec(text.slice(from, at));
  return from + (paragraph?.[0].length ?? 0);
}

/** @param {string} text @param {number} at */
function lineEnd(text, at) {
  const end = text.indexOf('\n', at);
  return end < 0 ? text.length : end;
}

/** Where what a brace opens is over, and how many braces are then still open.
 * @param {string} code @param {number} open */
function closing(code, open) {
  let depth = 0;
  for (let at = open; at < code.length; at += 1) {
    depth += Number(code[at] === '{') - Number(code[at] === '}');
    if (depth === 0) return { depth, closed: at + 1 };
  }
  return { depth, closed: code.length };
}

/** @param {string} size @param {Names} names */
function isTwo(size, names) {
  try {
    return numberOf(size, names) === 2;
  } catch {
    return false;
  }
}

/** Whether an array that isn't declared so holds rows of two: of a type of rows, say.
 * @param {FoundArray} array */
function holdsPairs({ sizes, body }) {
  const groups = groupsIn(peeled(body));
  return sizes.length < 3 && groups.length > 0 && groups.every((group) => wordsOf(group).length === 2);
}

/** @param {FoundArray} array @param {Names} names @returns {ReadArray} */
function reading({ name, line, body, about, missing }, names) {
  try {
    if (missing > 0)
      throw new Unreadable(`${missingBraces(missing, 'closing', '}')}: what “${name}” holds has no end.`);
    return { name, line, about, rows: rowsIn(body, names), problem: null };
  } catch (error) {
    if (!(error instanceof Unreadable)) throw error;
    return { name, line, about, rows: null, problem: error.message };
  }
}

/** Rows without a declaration.
 * @param {string} code @param {string} text the same with its comments @param {Names} names @returns {ReadArray} */
function bareArray(code, text, names) {
  const read = reading({ name: '', line: 1, sizes: [], body: code.replace(/;\s*$/, ''), about: text, missing: 0 }, names);
  if (read.rows === null && /[;#]|\)\s*\{/.test(code.trim().replace(/;$/, ''))) {
    throw new Unreadable('There is no array with rows of two numbers here, such as name[][2] = { { 10, 5000 }, … }.');
  }
  return read;
}

/** @param {number} count @param {'opening' | 'closing'} kind @param {string} sign */
const missingBraces = (count, kind, sign) =>
  `${counted(count, `${kind} brace`)} “${sign}” ${count === 1 ? 'is' : 'are'} missing`;

/** @param {string} body what stands between the braces of an initialiser @param {Names} names */
function rowsIn(body, names) {
  const missing = [...body].reduce((open, sign) => open + Number(sign === '{') - Number(sign === '}'), 0);
  if (missing > 0) throw new Unreadable(`${missingBraces(missing, 'closing', '}')}.`);
  if (missing < 0) throw new Unreadable(`${missingBraces(-missing, 'opening', '{')}.`);
  const condition = /^[ \t]*#.*$/m.exec(body);
  if (condition)
    throw new Unreadable(`“${shortened(condition[0])}” stands between the rows: which of them hold, it decides.`);
  const rows = peeled(body);
  const outside = rows.replace(/\{[^{}]*\}/g, '').replace(/[\s,]/g, '');
  if (/[{}]/.test(outside)) throw new Unreadable('Braces are nested deeper than rows within one table.');
  const groups = groupsIn(rows);
  if (groups.length === 0) return flatRows(rows, names);
  refuseTooMany(groups.length);
  if (outside !== '')
    throw new Unreadable(`“${shortened(outside)}” stands between the rows, which are { step, delay }.`);
  return groups.map((group, index) => rowOf(wordsOf(group), index, (word) => numberOf(word, names)));
}

/** Without braces around all rows.
 * @param {string} body @returns {string} */
function peeled(body) {
  const inner = /^\s*\{([^]*\}[\s,]*|\s*\{[^]*)\}[\s,]*$/.exec(body)?.[1];
  return inner !== undefined && isBalanced(inner) ? peeled(inner) : body;
}

/** Whether no brace closes before it opens, so that what was cut off was one pair.
 * @param {string} code */
function isBalanced(code) {
  let open = 0;
  for (const sign of code) {
    open += Number(sign === '{') - Number(sign === '}');
    if (open < 0) return false;
  }
  return true;
}

/** @param {string} rows */
function groupsIn(rows) {
  return [...rows.matchAll(/\{([^{}]*)\}/g)].map(([, group]) => group);
}

/** @param {string} group */
function wordsOf(group) {
  return withoutEmptyEnd(group.split(',').map((word) => word.trim()));
}

/** Rows of an initialiser without inner braces: `{ 10, 5000, 30, 1500 }`.
 * @param {string} body @param {Names} names */
function flatRows(body, names) {
  const words = body.split(',').filter((word) => word.trim() !== '');
  if (words.length === 0) throw new Unreadable('No row found between the braces.');
  if (words.length % 2 !== 0) throw new Unreadable(`${words.length} numbers don’t make rows of two.`);
  refuseTooMany(words.length / 2);
  return words
    .filter((_, index) => index % 2 === 0)
    .map((word, index) => rowOf([word, words[2 * index + 1]], index, (one) => numberOf(one, names)));
}
