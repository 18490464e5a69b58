// @ts-check
// Limits as words, in the unit that is shown.

import { formatEntry } from './numbers.js';

// The figures of a converted limit.
const FIGURES = 6;

/** Limits in another unit are rounded inwards, so that what is told is allowed.
 * @param {import('./types.js').Limits} limits @param {string} unit @param {number} factor from the unit they are in
 * @param {unknown} [value] that was refused, in that unit */
export function limitsInUnit({ lowest, highest, is_whole, note }, unit, factor, value) {
  if (lowest !== null && lowest === highest) return `only ${formatEntry(roundedTo(lowest * factor, factor, Math.round))} ${unit}${note}`;
  const low = lowest === null ? null : formatEntry(roundedTo(lowest * factor, factor, Math.ceil));
  const high = highest === null ? null : formatEntry(roundedTo(highest * factor, factor, Math.floor));
  // What is whole in another unit are steps: any number that is typed is taken for the nearest of them.
  const kind = is_whole && factor === 1 ? 'a whole number' : 'a number';
  const isBetween = is_whole && factor !== 1 && typeof value === 'number' && !Number.isInteger(value);
  const apart = isBetween ? `, in steps of ${formatEntry(Number(factor.toPrecision(FIGURES)))} ${unit}` : '';
  const ends =
    low !== null && high !== null ? `${kind} from ${low} to ${high}` : low !== null ? `at least ${low}` : `at most ${high}`;
  return `${ends} ${unit}${apart}${note}`;
}

/** A converted number with as many figures as are told.
 * @param {number} limit @param {number} factor it was converted with @param {(value: number) => number} toWhole */
export function roundedTo(limit, factor, toWhole) {
  if (limit === 0 || factor === 1) return limit;
  const scale = 10 ** (FIGURES - 1 - Math.floor(Math.log10(Math.abs(limit))));
  // Noise of the conversion must not push a limit to its neighbour.
  return Number((toWhole(Number((limit * scale).toPrecision(12))) / scale).toPrecision(FIGURES));
}
