// @ts-check
// What is said of a motor's verdict.

import { isOpen } from './motor_fields.js';
import { counted, formatEntry, formatFigures, formatFixed, formatHighest } from './numbers.js';
import { shownValue, unitWord } from './units.js';

/** @typedef {import('./types.js').MotorAnswer} MotorAnswer */

/** @type {Record<MotorAnswer['verdict'], string>} */
export const VERDICTS = { safe: 'Safe', marginal: 'Marginal', stalls: 'Stalls' };

/** @type {Record<string, string>} */
const CAUSES = {
  start: 'it starts too fast',
  onset: 'it speeds up too suddenly',
  top_speed: 'there is too little torque at speed',
  resonance: 'the rotor swings in time with the steps',
  timer: 'the ticks of the timer are too coarse for this speed',
  stop: 'it slows down too hard',
};

/** What shows it, where that isn't the rotor.
 * @type {Record<string, string>} */
const EVIDENCE = {
  no_torque: ', where the motor has no torque at all',
  measured_torque: ', by the torque that was measured and not by the model',
};

/** @param {MotorAnswer} answer @returns {string} such as ": it starts too fast, and 4 full steps are lost" */
export function causeText({ cause, evidence, lost_full_steps: lost, first_lost_step: first }) {
  if (cause === null) return ': no step is lost, and enough torque is kept back';
  const steps = first === null ? '' : lost === 0 ? `, and the rotor slips at step ${formatFixed(first)}` : `, and ${formatFixed(Math.abs(lost))} full steps are lost from step ${formatFixed(first)} on`;
  return `: ${CAUSES[cause] ?? cause}${EVIDENCE[evidence ?? ''] ?? ''}${steps}`;
}

/** @param {MotorAnswer} answer @param {import('./units.js').Units} units @param {import('./types.js').Design} design */
export function marginText(answer, units, design) {
  const shown = (/** @type {number} */ value) => formatFigures(shownValue(units, design, 'speed', value), 3);
  const speed = (/** @type {number} */ value) => `${shown(value)} ${unitWord(units, design, 'speed')}`;
  const at = speed(answer.most_used_at_steps_per_s);
  const used = answer.most_used === null ? `At ${at} the ramp asks for torque, and there is none` : `The ramp asks for up to ${usedText(answer.most_used)} of the torque, at ${at}`;
  const angle = `load angle up to ${formatFixed(answer.largest_load_angle_deg)}°`;
  const fastest = answer.greatest_start_speed_steps_per_s;
  const start = fastest === 0 ? 'the load alone is too much to start it' : `it can start at up to ${formatHighest(shownValue(units, design, 'speed', fastest), 3)} ${unitWord(units, design, 'speed')}`;
  const swing = `swings at ${formatFigures(answer.natural_frequency_hz, 3)} Hz`;
  const bands = answer.resonances_steps_per_s.map(([low, high]) => `${shown(low)} to ${speed(high)}`).join(' and ');
  return `${used}; ${angle}; ${start}; ${swing}; resonances at ${bands}.`;
}

/** How much of the torque is used, such as "62 %".
 * @param {number | null} used null: some is asked for where there is none */
export const usedText = (used) => (used === null ? 'more than there is' : `${formatFixed(used * 100)} %`);

/** What the model knows nothing of, where nobody has just told it. */
export const NOT_COVERED = 'Not covered: closed-loop drives, hot windings, a supply that sags, belts and couplings that give. Keep 40 % of margin.';

/** What the model knows nothing of, where its verdict stands.
 * @param {Pick<MotorAnswer, 'not_covered'>} answer */
export const notCoveredText = ({ not_covered: notCovered }) => `Not covered: ${notCovered}. Keep 40 % of margin.`;

/** A motor in a line.
 * @param {import('./types.js').Design} design */
export function motorText({ motor }) {
  if (motor === undefined) return '';
  const { holding_torque_nm: torque, rated_current_a: current, resistance_ohm: resistance, inductance_mh: inductance } = motor;
  return `${formatEntry(torque)} Nm, ${formatEntry(current)} A, ${formatEntry(resistance)} Ω, ${formatEntry(inductance)} mH`;
}

/** What was measured of it, in a line.
 * @param {import('./types.js').Design} design */
export function measuredText({ motor }) {
  const curve = motor?.torque_curve ? [`a curve of ${counted(motor.torque_curve.length, 'point')}`] : [];
  const stall = motor?.stalled && !isOpen(motor.stalled) ? [`stalled at ${formatEntry(motor.stalled.rpm) || '…'} rpm`] : [];
  return [...stall, ...curve].join(', ') || 'nothing yet';
}
