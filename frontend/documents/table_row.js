// @ts-check
// The rows of a table as words: last index and delay.

import { MOST_ROWS } from '../model/design.js';
import { Unreadable } from './unreadable.js';

/** @param {string[]} words @param {number} index of the row, from 0 @param {(word: string) => number} numberOf
 * @returns {number[]} @throws {Unreadable} */
export function rowOf(words, index, numberOf) {
  const row = `Row ${index + 1}`;
  if (words.length === 1 && words[0] === '') throw new Unreadable(`${row}: a number is missing.`);
  if (words.length !== 2) {
    const count = `${words.length} value${words.length === 1 ? '' : 's'}`;
    throw new Unreadable(`${row} has ${count}; a row is last index and delay.`);
  }
  try {
    return words.map(numberOf);
  } catch (error) {
    if (!(error instanceof Unreadable)) throw error;
    throw new Unreadable(`${row}: ${error.message}.`);
  }
}

/** A comma may follow the last word.
 * @param {string[]} words */
export function withoutEmptyEnd(words) {
  return words.length === 3 && words[2] === '' ? words.slice(0, 2) : words;
}

/** @param {number} count of rows */
export function refuseTooMany(count) {
  if (count <= MOST_ROWS) return;
  const [found, most] = [count, MOST_ROWS].map((number) => number.toLocaleString('en-US'));
  throw new Unreadable(`It has ${found} rows; a table has at most ${most}.`);
}
