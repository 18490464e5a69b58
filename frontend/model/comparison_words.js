// @ts-check
// One ramp against another in words: what a softer shape costs, and what it saves the motor.

import { formatEntry, formatFixed } from './numbers.js';

/** The figures of a move that are compared: duration [s], largest planned acceleration [steps/s²] and jerk [steps/s³].
 * @typedef {{duration: number, acceleration: number, jerk: number}} Compared */

// Nearer than this they are told as the same; nearer than this to a simple part, as that part.
const SAME = 0.01;
const NEARLY = 0.06;
// From here on it is told in times, as two times and not as 100 % more; less than this part is next to nothing.
const IN_TIMES = 1.995;
const HARDLY = 0.001;
const PARTS = ['half the', ...['third', 'quarter', 'fifth', 'sixth', 'seventh', 'eighth', 'ninth', 'tenth'].map(partOf)];

/** @param {Compared} now @param {Compared} before @returns {string} such as "same peak acceleration: 12 % longer, a quarter of the jerk" */
export function comparisonWords(now, before) {
  const acceleration = apart(ratioOf(now.acceleration, before.acceleration), 'high', 'higher', 'lower');
  const duration = apart(ratioOf(now.duration, before.duration), 'long', 'longer', 'shorter') || 'as long';
  const head = acceleration === '' ? 'same peak acceleration' : `peak acceleration ${acceleration}`;
  return `${head}: ${duration}, ${jerkWords(ratioOf(now.jerk, before.jerk))}`;
}

/** @param {number} now @param {number} before */
const ratioOf = (now, before) => (now === before ? 1 : now / before);

/** How far a ratio is from 1, in per cent; as times where it is large; empty: it is the same.
 * @param {number} ratio @param {string} as @param {string} more @param {string} less */
function apart(ratio, as, more, less) {
  if (Math.abs(ratio - 1) < SAME) return '';
  if (ratio >= IN_TIMES) return `${times(ratio)} as ${as}`;
  if (ratio < HARDLY) return `over ${formatFixed((1 - HARDLY) * 100, 1)} % ${less}`;
  return `${formatFixed(Math.abs(ratio - 1) * 100)} % ${ratio > 1 ? more : less}`;
}

/** @param {number} ratio */
function jerkWords(ratio) {
  if (Math.abs(ratio - 1) < SAME) return 'the same jerk';
  if (ratio >= IN_TIMES) return `${times(ratio)} the jerk`;
  if (ratio < HARDLY) return 'hardly any jerk';
  const part = Math.round(1 / ratio);
  const words = PARTS[part - 2];
  if (words && Math.abs(ratio * part - 1) < NEARLY) return `${words} jerk`;
  if (ratio < 0.5) return `${rounded(ratio * 100)} % of the jerk`;
  return `${formatFixed(Math.abs(ratio - 1) * 100)} % ${ratio > 1 ? 'more' : 'less'} jerk`;
}

/** @param {number} ratio */
const times = (ratio) => (Number.isFinite(ratio) ? `${rounded(ratio)} times` : 'many times');

/** @param {number} value */
const rounded = (value) => formatEntry(Number(value.toPrecision(2)));

/** @param {string} part */
function partOf(part) {
  return `${part === 'eighth' ? 'an' : 'a'} ${part} of the`;
}
