// @ts-check
// A speed and the button that says which way: the speed itself has no sign.

import { limitsInUnit } from '../model/limits_text.js';

/** @typedef {import('../model/types.js').Rejection} Rejection */

const FIELD = 'speed_steps_per_s';
const WHICH_WAY = 'but not 0: the buttons say which way';
const SLEW = 'the slew speed of the axis\u2019 ramp';
const ALLOWED = `a number from 0 to ${SLEW}, ${WHICH_WAY}`;

/** @param {unknown} speed [steps/s], or the text that is none
 * @param {1 | -1} direction @returns {{speed: unknown, rejections: Rejection[]}} the speed with its sign */
export function directedSpeed(speed, direction) {
  if (typeof speed === 'number' && speed > 0) return { speed: speed * direction, rejections: [] };
  return { speed, rejections: [{ field: FIELD, value: speed, allowed: ALLOWED, message: `${FIELD} is ${speed}; allowed: ${ALLOWED}.` }] };
}

/** What the server says of a speed with its sign, said of the speed without: it can be as fast either way.
 * @param {Rejection} rejection @returns {Rejection} */
export function ofUndirected(rejection) {
  const { value, limits } = rejection;
  // What was refused here is told as it was typed.
  if (typeof value !== 'number' || rejection.allowed === ALLOWED) return rejection;
  const speed = Math.abs(value);
  if (!limits || limits.highest === null) return { ...rejection, value: speed };
  const isTooFast = limits.lowest === -limits.highest && speed > limits.highest;
  const isTooSlow = limits.lowest !== null && limits.lowest > 0 && speed < limits.lowest;
  if (!isTooFast && !isTooSlow) return { ...rejection, value: speed };
  // What is beyond every ramp is told before the axis\u2019 own is looked at.
  const why = limits.note ? `, ${SLEW}` : '';
  const ahead = isTooSlow ? { ...limits, note: ': the buttons say which way' } : { ...limits, lowest: 0, note: `${why}, ${WHICH_WAY}` };
  return { ...rejection, value: speed, allowed: limitsInUnit(ahead, 'steps/s', 1), limits: ahead };
}
