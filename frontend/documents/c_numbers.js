// @ts-check
// Numbers as C writes them: with suffixes, casts and arithmetic, and by the names that the source gives them.

import { shortened, Unreadable } from './unreadable.js';

/** What names stand for, as the source says it: more than one text where it is said again, otherwise. Once it is known,
 * the value.
 * @typedef {Map<string, {texts: Set<string>, value: Value | null}>} Names */
/** @typedef {{value: number, isWhole: boolean}} Value   whole numbers are divided as C divides them */

const TOKEN =
  /\s*(0x[\da-f][\da-f']*[ul]*|0b[01][01']*[ul]*|(?:\d[\d']*\.?\d*|\.\d+)(?:e[+-]?\d+)?[ulf]*|[a-z_]\w*|<<|>>|[-+*/%()])\s*/iy;
const TYPE = /^(const|unsigned|signed|char|short|int|long|float|double|byte|word|\w+_t)$/;
const DEFINED = /^[ \t]*#[ \t]*define[ \t]+(\w+)[ \t]+(.+)$/gm;
const CONSTANT = /\b(?:const|constexpr)\b[\w\s:]{0,80}?\b(\w+)\s*=([^;{}]{1,200});/g;
// Longer than any number that a person writes, and short enough to be read at once.
const LONGEST = 200;
const DEEPEST = 20;

/** The names that macros and constants give to numbers.
 * @param {string} code without comments @returns {Names} */
export function namesIn(code) {
  /** @type {Names} */
  const names = new Map();
  const joined = code.replace(/\\\r?\n/g, ' ');
  for (const [, name, text] of [...joined.matchAll(DEFINED), ...joined.matchAll(CONSTANT)]) {
    const meant = names.get(name) ?? { texts: new Set(), value: null };
    meant.texts.add(text.trim());
    names.set(name, meant);
  }
  return names;
}

/** @param {string} text such as "(uint16_t)5000UL" or "TOP / 2" @param {Names} names @returns {number} */
export function numberOf(text, names) {
  if (text.trim() === '') throw new Unreadable('a number is missing');
  const { value } = valueOf(text.trim(), names, 0);
  if (!Number.isFinite(value)) throw new Unreadable(`“${shortened(text)}” is too large`);
  return value;
}

/** @param {string} text @param {Names} names @param {number} depth of names within names @returns {Value} */
function valueOf(text, names, depth) {
  const tokens = text.length > LONGEST ? null : tokensOf(text);
  if (tokens === null || tokens.length === 0) throw noNumber(text);
  const reader = createReader(tokens, text, names, depth);
  const value = reader.sum();
  if (!reader.isAtEnd()) throw noNumber(text);
  return value;
}

/** @param {string} text */
function noNumber(text) {
  return new Unreadable(`“${shortened(text)}” is not a number`);
}

/** @param {string} text @returns {string[] | null} null: something in it is of no number */
function tokensOf(text) {
  const tokens = [];
  for (TOKEN.lastIndex = 0; TOKEN.lastIndex < text.length; ) {
    const found = TOKEN.exec(text);
    if (found === null) return null;
    tokens.push(found[1]);
  }
  return tokens;
}

/** @param {string[]} tokens @param {string} text @param {Names} names @param {number} depth */
function createReader(tokens, text, names, depth) {
  let at = 0;

  /** Terms joined by operators of one rank, from the left.
   * @param {string[]} operators @param {() => Value} term @returns {Value} */
  function chain(operators, term) {
    let left = term();
    while (operators.includes(tokens[at])) left = applied(left, tokens[at++], term(), text);
    return left;
  }

  const product = () => chain(['*', '/', '%'], signed);
  const addition = () => chain(['+', '-'], product);
  const sum = () => chain(['<<', '>>'], addition);

  /** @returns {Value} */
  function signed() {
    const sign = tokens[at];
    if (sign !== '-' && sign !== '+') return isCast() ? cast() : single();
    at += 1;
    const { value, isWhole } = signed();
    return { value: sign === '-' ? -value : value, isWhole };
  }

  function isCast() {
    const end = tokens.indexOf(')', at);
    return tokens[at] === '(' && end > at + 1 && tokens.slice(at + 1, end).every((word) => TYPE.test(word));
  }

  /** @returns {Value} */
  function cast() {
    const end = tokens.indexOf(')', at);
    const isWhole = !tokens.slice(at, end).some((word) => /^(float|double)$/.test(word));
    at = end + 1;
    const { value } = signed();
    return { value: isWhole ? Math.trunc(value) : value, isWhole };
  }

  /** @returns {Value} */
  function single() {
    const token = tokens[at++] ?? '';
    if (token === '(') {
      const value = sum();
      if (tokens[at++] !== ')') throw noNumber(text);
      return value;
    }
    if (/^[.\d]/.test(token)) return literal(token);
    return named(token);
  }

  /** @param {string} name @returns {Value} */
  function named(name) {
    const meant = names.get(name);
    const texts = [...(meant?.texts ?? [])];
    if (texts.length > 1) throw new Unreadable(`“${name}” is defined as ${texts.map(shortened).join(' and as ')}`);
    if (meant === undefined || depth >= DEEPEST) throw noNumber(text);
    meant.value ??= valueOf(texts[0], names, depth + 1);
    return meant.value;
  }

  return { sum, isAtEnd: () => at >= tokens.length };
}

/** @param {string} token @returns {Value} */
function literal(token) {
  const plain = token.replaceAll("'", '').toLowerCase();
  const based = /^(0x[\da-f]+|0b[01]+)[ul]*$/.exec(plain);
  if (based) return { value: Number(based[1]), isWhole: true };
  const digits = plain.replace(/[ulf]+$/, '');
  const isWhole = /^\d+$/.test(digits) && !plain.includes('f');
  if (isWhole && /^0\d/.test(digits))
    throw new Unreadable(`“${token}” is octal in C; write it without the leading zero`);
  return { value: Number(digits), isWhole };
}

/** @param {Value} left @param {string} operator @param {Value} right @param {string} text @returns {Value} */
function applied({ value: one, isWhole }, operator, { value: other, isWhole: isOtherWhole }, text) {
  const areWhole = isWhole && isOtherWhole;
  const quotient = areWhole ? Math.trunc(one / other) : one / other;
  if ((operator === '/' || operator === '%') && other === 0) throw new Unreadable(`“${shortened(text)}” divides by 0`);
  const values = /** @type {Record<string, number>} */ ({
    '+': one + other,
    '-': one - other,
    '*': one * other,
    '/': quotient,
    '%': one % other,
    '<<': one * 2 ** other,
    '>>': Math.floor(one / 2 ** other),
  });
  return { value: values[operator], isWhole: areWhole };
}
