// @ts-check
// The settings of controllers that work their ramps out themselves, as the lines that they are sent.

/** @typedef {import('../model/types.js').Design} Design */
/** @typedef {'grbl' | 'marlin'} Machine */

/** Of a machine's axes, in the order of grbl's numbers. */
export const AXIS_LETTERS = ['X', 'Y', 'Z'];
const SECONDS_PER_MIN = 60;
// grbl keeps three; smaller numbers are told by their figures.
const DECIMALS = 3;
const FIGURES = 4;
/** The most that grbl 1.1 makes on an Uno [steps/s], as its documentation says. */
const GRBL_STEPS_PER_S = 30_000;

/** The lines that give one axis the design's scale and limits.
 * @param {Design} design that the server takes @param {Machine} machine @param {string} letter of AXIS_LETTERS
 * @returns {string[]} */
export function settingLines({ axis, ramp }, machine, letter) {
  const perUnit = stepsPerUnit(axis);
  const speed = Number(ramp.slew_speed_steps_per_s) / perUnit;
  const acceleration = Number(ramp.acceleration_steps_per_s2) / perUnit;
  if (machine === 'marlin') {
    return [`M92 ${letter}${plain(perUnit)}`, `M203 ${letter}${plain(speed)}`, `M201 ${letter}${plain(acceleration)}`, 'M500'];
  }
  const at = AXIS_LETTERS.indexOf(letter);
  return [`$10${at}=${plain(perUnit)}`, `$11${at}=${plain(speed * SECONDS_PER_MIN)}`, `$12${at}=${plain(acceleration)}`];
}

/** What of a design such a machine does otherwise.
 * @param {Design} design @param {Machine} machine @returns {string[]} */
export function settingRemarks({ axis, ramp }, machine) {
  const name = machine === 'grbl' ? 'grbl' : 'Marlin';
  const speed = Number(ramp.slew_speed_steps_per_s);
  const remarks = [
    Number(ramp.base_speed_steps_per_s) > 0 && `${name} has no start speed of this kind: it is not in these lines.`,
    ramp.deceleration_steps_per_s2 !== null &&
      ramp.deceleration_steps_per_s2 !== ramp.acceleration_steps_per_s2 &&
      `${name} slows down as it speeds up: the deceleration is not in these lines.`,
    machine === 'grbl' && speed > GRBL_STEPS_PER_S && `On an Uno grbl makes up to 30,000 steps/s, and this asks for ${Math.ceil(speed).toLocaleString('en-US')}.`,
    axis.travel_unit === 'deg' && `${name} counts in mm: here each stands for a degree.`,
  ];
  return remarks.flatMap((remark) => remark || []);
}

/** @param {Design['axis']} axis */
function stepsPerUnit({ full_steps_per_rev, microsteps, travel_per_rev }) {
  return (Number(full_steps_per_rev) * Number(microsteps)) / Number(travel_per_rev);
}

/** A number as machines read it.
 * @param {number} value */
function plain(value) {
  return value >= 1 ? String(Number(value.toFixed(DECIMALS))) : Number(value.toPrecision(FIGURES)).toFixed(9).replace(/\.?0+$/, '');
}
