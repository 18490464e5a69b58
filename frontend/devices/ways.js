// @ts-check
// How far an axis may be told to go: said also where a request was refused before its axis was asked.

import { limitsInUnit } from '../model/limits_text.js';
import { DESIGN_TAKES, DEVICE_TAKES } from '../model/taken.js';

/** @typedef {import('../model/types.js').Rejection} Rejection */

const [, FURTHEST] = DESIGN_TAKES['move.steps'].limits;
const [LEAST, MOST] = DEVICE_TAKES.lowest_steps.limits;

/** The refusal with what the axis may be told, in place of what any position fits in.
 * @param {Rejection} rejection of a distance, or of a position
 * @param {Pick<import('../model/types.js').AxisState, 'axis' | 'target_steps' | 'lowest_steps' | 'highest_steps'>} axis
 * @param {boolean} isRelative whether it is a distance @returns {Rejection} */
export function asTheAxisGoes(rejection, { axis, target_steps: target, lowest_steps, highest_steps }, isRelative) {
  const { limits } = rejection;
  if (limits?.lowest !== LEAST || limits.highest !== MOST) return rejection;
  const [free, origin] = isRelative ? [0, target] : [target, 0];
  const lowest = lowest_steps === null ? free - FURTHEST : lowest_steps - origin;
  const highest = highest_steps === null ? free + FURTHEST : highest_steps - origin;
  const isFree = lowest_steps === null && highest_steps === null;
  const from = isRelative && target !== 0 ? ' from there' : '';
  const why = isFree ? `, since axis ${axis} has no soft limit there` : `, the soft limits of axis ${axis}${from}`;
  const own = { ...limits, lowest: Math.max(lowest, LEAST), highest: Math.min(highest, MOST), note: limits.note || why };
  return { ...rejection, limits: own, allowed: limitsInUnit(own, 'steps', 1) };
}
