// @ts-check
// Soft limits as the page remembers them: with the steps that their axis made when they were set, as they are kept in steps.

/** @typedef {import('../model/types.js').AxisState} AxisState */
/** @typedef {import('../model/types.js').KeptLimits} KeptLimits */
/** @typedef {import('../model/types.js').SoftLimits} SoftLimits */

/** So far apart two scales are the same, as the server takes them: less than as many steps as an axis is sent show. */
const SAME_SCALE = 1e-7;

/** @param {SoftLimits[]} limits @param {AxisState[]} axes as the device tells them @returns {KeptLimits[]} */
export function withScales(limits, axes) {
  return limits.map((one) => {
    const { steps_per_mm = null, microsteps = null } = axes.find(({ axis }) => axis === one.axis) ?? {};
    return { ...one, steps_per_mm, microsteps };
  });
}

/** Why limits would be at other places if they came into force now, as the rest of a sentence on them; empty: they wouldn't.
 * @param {KeptLimits} kept @param {AxisState} now their axis @returns {string} */
export function otherPlacesText(kept, now) {
  const scales = /** @type {const} */ ([
    ['steps per mm', kept.steps_per_mm ?? null, now.steps_per_mm],
    ['steps of a full step', kept.microsteps ?? null, now.microsteps],
  ]);
  const [other] = scales.filter(([, before, present]) => !areSame(before, present));
  if (other === undefined) return '';
  const [unit, before, present] = other;
  const made = before === null ? `when it was not known how many ${unit} it makes` : `while it made ${figure(before)} ${unit}`;
  const makes = present === null ? 'by now it doesn’t tell how many' : `by now it makes ${figure(present)}`;
  return `were set ${made}, and ${makes}, so they may be at other places`;
}

/** @param {number | null} one @param {number | null} other */
const areSame = (one, other) => one === other || (one !== null && other !== null && Math.abs(one / other - 1) <= SAME_SCALE);

/** @param {number} count */
const figure = (count) => count.toLocaleString('en', { maximumSignificantDigits: 7 });
