// @ts-check
// What numbers are taken, as the server says, and what is refused of them: the same as the server would, before it is asked.

// @ts-expect-error  No file, but a module that the server makes of its design document.
import design from '../assets/design_fields.js';
// @ts-expect-error  So is this, of the settings of controllers and of soft limits.
import device from '../assets/device_fields.js';
import { limitsInUnit } from './limits_text.js';

/** @typedef {import('./types.js').Limits} Limits */
/** @typedef {import('./types.js').Rejection} Rejection */
/** The least and most that is taken, in which unit (empty: none of its own), and whether only whole numbers are.
 * @typedef {{limits: [number, number], unit: string, isWhole: boolean}} Taken */

/** Of a design, by path; of any row of its table "table.rows.1".
 * @type {Record<string, Taken>} */
export const DESIGN_TAKES = design;
/** Of a controller's settings and of soft limits, by name.
 * @type {Record<string, Taken>} */
export const DEVICE_TAKES = device;

/** Why something can't be taken; null: it can.
 * @param {string} field its path, as the server would tell it @param {unknown} value @param {Taken} taken
 * @param {string} [note] how the sentence goes on that says what is allowed @returns {Rejection | null} */
export function refusalOf(field, value, { limits: [lowest, highest], unit, isWhole }, note = '') {
  const isNumber = typeof value === 'number' && (!isWhole || Number.isInteger(value));
  if (isNumber && value >= lowest && value <= highest) return null;
  return beyond(field, value, { lowest, highest, is_whole: isWhole, note }, unit);
}

/** The refusal of what is beyond limits.
 * @param {string} field @param {unknown} value @param {Limits} limits @param {string} unit @returns {Rejection} */
export function beyond(field, value, limits, unit) {
  const allowed = limitsInUnit(limits, unit, 1);
  return { field, value, allowed, limits, unit, message: `${field} is ${value}; allowed: ${allowed}.` };
}
