// @ts-check
// A speed and the button that says which way: the speed itself has no sign.

/** @typedef {import('../model/types.js').Rejection} Rejection */

/** @param {unknown} speed [steps/s], or the text that is none, of which the server says what is wrong with it
 * @param {1 | -1} direction @returns {{speed: unknown, rejections: Rejection[]}} the speed with its sign */
export function directedSpeed(speed, direction) {
  if (typeof speed !== 'number') return { speed, rejections: [] };
  if (speed >= 0) return { speed: speed * direction, rejections: [] };
  const limits = { lowest: 0, highest: null, is_whole: false, note: ': the buttons say which way' };
  const allowed = `at least 0 steps/s${limits.note}`;
  const field = 'speed_steps_per_s';
  return { speed, rejections: [{ field, value: speed, allowed, message: `${field} is ${speed}; allowed: ${allowed}.`, limits, unit: 'steps/s' }] };
}
