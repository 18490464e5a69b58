// @ts-check
// What was measured of a motor: a stall point, a torque curve, and what drove the motor then. Another drive later leaves that as it is.

import { withValue } from './design.js';
import { isOpen, SUPPLY_V } from './motor_fields.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {'stalled' | 'torque_curve'} Measured */

const DRIVE_THEN = 'motor.measured_with';

/** What drives a design's motor, with what stands for what it leaves open.
 * @param {Design} design @returns {NonNullable<Design['drive']>} */
export function driveOf({ motor, drive }) {
  const isTold = !isOpen(drive?.current_a);
  return {
    supply_v: drive?.supply_v ?? SUPPLY_V,
    current_a: (isTold ? drive?.current_a : motor?.rated_current_a) ?? null,
    current_is: isTold ? (drive?.current_is ?? null) : 'rms',
  };
}

/** The design with something measured of its motor, or without. What drives it now is told with the first, and forgotten with
 * the last.
 * @param {Design} design @param {Measured} name @param {unknown} value undefined: forgotten @returns {Design} */
export function withMeasured(design, name, value) {
  const made = withValue(design, `motor.${name}`, value);
  if (!isMeasured(made)) return withValue(made, DRIVE_THEN, undefined);
  return isMeasured(design) ? made : withValue(made, DRIVE_THEN, driveOf(design));
}

/** The design with what drove its motor while it was measured: what drives it now where nobody has told, so that it may be driven
 * by something else.
 * @param {Design} design @returns {Design} */
export const withDriveThen = (design) =>
  isMeasured(design) && isOpen(design.motor?.measured_with) ? withValue(design, DRIVE_THEN, driveOf(design)) : design;

/** @param {Design} design */
const isMeasured = ({ motor }) => !isOpen(motor?.stalled) || !isOpen(motor?.torque_curve);
