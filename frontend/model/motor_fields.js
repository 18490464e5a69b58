// @ts-check
// The numbers of a motor, its drive and its load: what each is called, what stands for it where it is left open, and which of
// them a design has.

import { fieldsOfMechanism } from './mechanisms.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {Omit<import('./fields.js').Field, 'limits' | 'unit' | 'isWhole'>} Described */

/** What the server takes for what is left open, as `backend/stepramp/drive_train.py` has it. */
export const SUPPLY_V = 24;
export const DETENT_PART = 0.04;
export const FRICTION_PART = 0.05;
export const PULL_OUT_FACTOR = 0.85;
export const EFFICIENCY = 0.4;
const FIGURES = 3;

/** @param {Design} design @param {number} part */
const partOfHolding = ({ motor }, part) => Number((part * Number(motor?.holding_torque_nm)).toPrecision(FIGURES)) || 0;
const none = () => 0;

/** @param {[number, number]} reach @returns {import('./fields.js').Slider} */
const log = ([from, to]) => ({ from, to, scale: 'log', figures: 3 });

/** What feeds the motor.
 * @type {Described[]} */
const DRIVE = [
  {
    path: 'drive.supply_v',
    label: 'Supply',
    symbol: 'V',
    slider: log([5, 80]),
    formula: '',
    help: 'Voltage of the driver’s supply. Twice as much keeps the torque up to twice the speed. Left open: 24 V, a usual one.',
    usual: () => SUPPLY_V,
  },
  {
    path: 'drive.current_a',
    label: 'Current',
    symbol: '',
    slider: log([0.1, 10]),
    formula: '',
    help: 'Of one phase, as the driver is set, RMS or peak. Left open: what the motor is rated for, as RMS.',
    usual: ({ motor }) => motor?.rated_current_a ?? '',
  },
];

/** What it moves.
 * @type {Described[]} */
const LOAD = [
  {
    path: 'load.mechanism.lead_mm',
    label: 'Lead',
    symbol: 'l',
    slider: log([0.5, 100]),
    formula: '',
    help: 'How far one turn of the motor moves the mass. A T8 screw with four starts: 8 mm, with one: 2 mm.',
  },
  {
    path: 'load.mechanism.pulley_mm',
    label: 'Pulley',
    symbol: 'd',
    slider: log([2, 200]),
    formula: '',
    help: 'Pitch diameter of the motor’s pulley: its teeth times the pitch, divided by π. 20 teeth of 2 mm: 12.73 mm.',
  },
  {
    path: 'load.mechanism.mass_kg',
    label: 'Mass',
    symbol: 'm',
    slider: log([0.01, 100]),
    formula: '',
    help: 'All that moves along: the slide with what is on it. At the shaft that is m (l / 2π)² of a screw, m r² of a belt.',
  },
  {
    path: 'load.mechanism.friction_n',
    label: 'Sliding friction',
    symbol: 'F',
    slider: log([0.1, 1000]),
    formula: '',
    help: 'Force against any motion of the mass: pull it by a spring balance, without the motor. Left open: none beside the friction at the shaft.',
    usual: none,
  },
  {
    path: 'load.mechanism.efficiency',
    label: 'Efficiency',
    symbol: 'η',
    slider: { from: 0.05, to: 1, scale: 'linear', strides: [0.01, 0.05, 0.1] },
    formula: '',
    help: 'How much of the work the thread passes on. Left open: 0.4, a usual one of a trapezoidal screw; a ball screw has 0.9.',
    usual: () => EFFICIENCY,
  },
  {
    path: 'load.mechanism.incline_deg',
    label: 'Incline',
    symbol: 'α',
    slider: { from: 0, to: 90, scale: 'linear', strides: [1, 5, 15] },
    formula: '',
    help: 'Where forward leads: 90° straight up, −90° straight down. Left open: 0, level.',
    usual: none,
  },
  {
    path: 'load.mechanism.inertia_g_cm2',
    label: 'Pointer inertia',
    symbol: '',
    slider: log([0.1, 100]),
    formula: '',
    help: 'Of the pointer about its shaft: 1 to 3 g·cm² for the usual ones of gauges.',
  },
  {
    path: 'load.inertia_g_cm2',
    label: 'Load inertia',
    symbol: '',
    slider: log([1, 100000]),
    formula: '',
    help: 'What is turned at the motor’s shaft, without the rotor, besides what the mechanism moves. Left open: nothing.',
    usual: none,
  },
  {
    path: 'load.torque_nm',
    label: 'Load torque',
    symbol: '',
    slider: log([0.001, 10]),
    formula: '',
    help: 'Constant at the shaft, against the forward move; negative where it helps it, as a weight that sinks. Left open: none.',
    usual: none,
  },
  {
    path: 'load.friction_nm',
    label: 'Friction',
    symbol: '',
    slider: log([0.001, 10]),
    formula: '',
    help: 'At the shaft, against any motion. Hardly anybody knows it. Left open: 5 % of the holding torque, a usual one.',
    usual: (design) => (isOpen(design.load?.mechanism?.friction_n) ? partOfHolding(design, FRICTION_PART) : 0),
  },
];

/** By its data sheet.
 * @type {Described[]} */
const DATA = [
  {
    path: 'motor.holding_torque_nm',
    label: 'Holding torque',
    symbol: 'T',
    slider: log([0.01, 20]),
    formula: '',
    help: 'Both phases at the rated current, by the data sheet.',
  },
  {
    path: 'motor.rated_current_a',
    label: 'Rated current',
    symbol: 'I',
    slider: log([0.1, 10]),
    formula: '',
    help: 'Of one phase, by the data sheet, up to which its holding torque is told.',
  },
  {
    path: 'motor.resistance_ohm',
    label: 'Resistance',
    symbol: 'R',
    slider: log([0.1, 100]),
    formula: '',
    help: 'Of one phase, by the data sheet, or measured at its two wires with a multimeter.',
  },
  {
    path: 'motor.inductance_mh',
    label: 'Inductance',
    symbol: 'L',
    slider: log([0.1, 100]),
    formula: '',
    help: 'Of one phase. The higher it is, the sooner the torque falls with the speed.',
  },
  {
    path: 'motor.rotor_inertia_g_cm2',
    label: 'Rotor inertia',
    symbol: 'J',
    slider: log([1, 10000]),
    formula: '',
    help: 'Of the rotor alone, by the data sheet: about 50 g·cm² for a NEMA 17, 300 for a NEMA 23.',
  },
  {
    path: 'motor.detent_torque_nm',
    label: 'Detent torque',
    symbol: '',
    slider: log([0.001, 1]),
    formula: '',
    help: 'What it takes to turn the motor without current. Left open: 4 % of the holding torque, a usual one.',
    usual: (design) => partOfHolding(design, DETENT_PART),
  },
  {
    path: 'motor.full_steps_per_rev',
    label: 'Steps of it',
    symbol: '',
    slider: { from: 20, to: 800, scale: 'linear', strides: [1, 1, 10] },
    formula: '',
    help: 'Full steps of one turn of the motor’s own shaft, as its coils see them. Left open: those of the axis, which is the same motor.',
    usual: ({ axis }) => axis.full_steps_per_rev,
  },
];

/** What was measured of it.
 * @type {Described[]} */
const MEASURED = [
  {
    path: 'motor.stalled.rpm',
    label: 'Stall speed',
    symbol: '',
    slider: log([10, 10000]),
    formula: '',
    help: 'Raise the speed slowly until the motor stalls: the speed where it did, in turns of its shaft a minute.',
  },
  {
    path: 'motor.stalled.torque_nm',
    label: 'Stall torque',
    symbol: '',
    slider: log([0.001, 20]),
    formula: '',
    help: 'What was asked of the motor there: load, friction and acceleration together. The pull-out factor is made to fit.',
  },
  {
    path: 'motor.measured_with.supply_v',
    label: 'Supply then',
    symbol: 'V',
    slider: log([5, 80]),
    formula: '',
    help: 'What fed the driver while it was measured: what was found holds with it, and with any other as the model has it. Left open: the supply above.',
    usual: ({ drive }) => drive?.supply_v ?? SUPPLY_V,
  },
  {
    path: 'motor.measured_with.current_a',
    label: 'Current then',
    symbol: '',
    slider: log([0.1, 10]),
    formula: '',
    help: 'Of one phase, as the driver was set while it was measured. Left open: the current above.',
    usual: ({ motor, drive }) => drive?.current_a ?? motor?.rated_current_a ?? '',
  },
  {
    path: 'motor.pull_out_factor',
    label: 'Pull-out factor',
    symbol: 'k',
    slider: { from: 0.05, to: 1.5, scale: 'linear', strides: [0.01, 0.05, 0.1] },
    formula: '',
    help: 'How much of the model’s torque the motor has. Left open: 0.85, which fits NEMA 17 and 23; NEMA 34 have about 0.55.',
    usual: () => PULL_OUT_FACTOR,
  },
];

/** What the motor's fields are about, in the order of the page. */
export const MOTOR_SECTIONS = { drive: DRIVE, load: LOAD, data: DATA, measured: MEASURED };

/** Whether nobody has said what a field holds.
 * @param {unknown} value */
export const isOpen = (value) => value === undefined || value === null;

/** Whether a design has a field of its motor, drive or load; without a motor it has none.
 * @param {Design} design @param {string} path */
export function hasMotorField({ motor, load }, path) {
  if (motor === undefined) return false;
  const isMeasured = !isOpen(motor.stalled) || !isOpen(motor.torque_curve);
  if (path.startsWith('motor.stalled.')) return !isOpen(motor.stalled);
  if (path.startsWith('motor.measured_with.')) return isMeasured;
  // A measured point sets it, and a measured curve takes the model's place.
  if (path === 'motor.pull_out_factor') return !isMeasured;
  const [, , part] = path.split('.');
  return path.startsWith('load.mechanism.') ? fieldsOfMechanism(load?.mechanism?.name).includes(part) : true;
}
