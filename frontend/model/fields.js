// @ts-check
// The table of parameters: what each is called, the reach of its slider, its formula and what it does. What it takes, and in
// which unit, the server says.

import { MOTOR_SECTIONS } from './motor_fields.js';
import { DESIGN_TAKES } from './taken.js';

/** What a hand sets: the reach of a slider, and what one step of it, of the wheel or of an arrow key is.
 * A logarithmic one, whose reach spans decades, steps by about 1 % and is set to some significant figures (0: to whole
 * numbers); or it doubles. A linear one steps by its strides: fine, usual, coarse.
 * @typedef {{from: number, to: number} & ({scale: 'log', figures: number, doubles?: boolean} |
 *   {scale: 'linear', strides: [number, number, number]})} Slider */

/** @typedef {object} Field
 * @property {string} path       where it stands in the design document
 * @property {string} label
 * @property {string} symbol
 * @property {string} unit              as the server says; empty: none of its own
 * @property {import('./units.js').Quantity} [quantity]  what can be shown in other units
 * @property {boolean} isWhole          only whole numbers, as the server says
 * @property {[number, number]} limits  least and most that the server takes, as it says
 * @property {Slider} slider
 * @property {string} formula    numbers of its formulas; empty: none
 * @property {string} help
 * @property {(design: import('./types.js').Design) => import('./types.js').Entry} [usual]  what stands for it while it is left
 *   open; it may not be left open without one */

/** All but what the server says.
 * @type {{title: string, fields: Omit<Field, 'limits' | 'unit' | 'isWhole'>[]}[]} */
const DESCRIBED = [
  {
    title: 'Axis',
    fields: [
      {
        path: 'axis.full_steps_per_rev',
        label: 'Steps a turn',
        symbol: '',
        slider: { from: 20, to: 800, scale: 'linear', strides: [1, 1, 10] },
        formula: '',
        help: 'Full steps of one turn of the motor, before microstepping: 200 for the usual 1.8° motor.',
      },
      {
        path: 'axis.microsteps',
        label: 'Microsteps',
        symbol: '',
        slider: { from: 1, to: 256, scale: 'log', figures: 0, doubles: true },
        formula: '',
        help: 'Driver pulses for one full step. Every step in the plots is one pulse.',
      },
      {
        path: 'axis.travel_per_rev',
        label: 'Travel a turn',
        symbol: '',
        slider: { from: 0.5, to: 400, scale: 'log', figures: 2 },
        formula: '',
        help: 'Distance the axis covers in one turn of the motor. It scales the position axis, not the ramp.',
      },
    ],
  },
  {
    title: 'Timer',
    fields: [
      {
        path: 'timer.frequency_hz',
        label: 'Frequency',
        symbol: 'F',
        slider: { from: 1e4, to: 2e8, scale: 'log', figures: 3 },
        formula: '7',
        help: 'Ticks a second of the step timer. Delays are whole ticks, so a low F coarsens the top speeds.',
      },
      {
        path: 'timer.counter_bits',
        label: 'Counter',
        symbol: '',
        slider: { from: 8, to: 64, scale: 'linear', strides: [1, 1, 8] },
        formula: '',
        help: 'Width of the timer’s counter. The longest delay, that of the first step, has to fit into it.',
      },
      {
        path: 'timer.shortest_interval_us',
        label: 'Shortest delay',
        symbol: '',
        slider: { from: 1, to: 1000, scale: 'log', figures: 3 },
        formula: '',
        help: 'The least time that the firmware needs between two pulses. It sets the highest slew speed.',
      },
    ],
  },
  {
    title: 'Ramp',
    fields: [
      {
        path: 'ramp.base_speed_steps_per_s',
        label: 'Base speed',
        symbol: 'v₀',
        quantity: 'speed',
        slider: { from: 0, to: 1000, scale: 'linear', strides: [1, 10, 100] },
        formula: '17',
        help: 'Speed at which the ramp begins and ends. Sets the first delay; from rest (0) the methods differ most.',
      },
      {
        path: 'ramp.slew_speed_steps_per_s',
        label: 'Slew speed',
        symbol: 'v',
        quantity: 'speed',
        slider: { from: 50, to: 50000, scale: 'log', figures: 3 },
        formula: '18',
        help: 'Speed that the ramp leads to. Its delay is F / v, rounded to whole ticks.',
      },
      {
        path: 'ramp.acceleration_steps_per_s2',
        label: 'Acceleration',
        symbol: 'a',
        quantity: 'acceleration',
        slider: { from: 100, to: 1e6, scale: 'log', figures: 3 },
        formula: '4, 16',
        help: 'Gain of speed each second. The ramp takes (v² − v₀²) / 2a steps.',
      },
      {
        path: 'ramp.deceleration_steps_per_s2',
        label: 'Deceleration',
        symbol: 'd',
        quantity: 'acceleration',
        slider: { from: 100, to: 1e6, scale: 'log', figures: 3 },
        formula: '4, 16',
        help: 'Loss of speed each second. It follows the acceleration until it is set; emptied, it follows again.',
      },
      {
        path: 'ramp.shape.jerk_steps_per_s3',
        label: 'Jerk',
        symbol: 'j',
        quantity: 'jerk',
        slider: { from: 100, to: 1e9, scale: 'log', figures: 3 },
        formula: '',
        help: 'How fast the acceleration comes and goes. The ramp takes Δv / a + a / j; where that is too short for a, less of a.',
      },
      {
        path: 'ramp.shape.deceleration_jerk_steps_per_s3',
        label: 'Jerk down',
        symbol: 'j',
        quantity: 'jerk',
        slider: { from: 100, to: 1e9, scale: 'log', figures: 3 },
        formula: '',
        help: 'The same for the ramp down. It follows the jerk until it is set; emptied, it follows again.',
      },
      {
        path: 'ramp.shape.margin',
        label: 'Part of torque',
        symbol: 'm',
        slider: { from: 0.05, to: 1, scale: 'linear', strides: [0.01, 0.05, 0.1] },
        formula: '',
        help: 'How much of the motor’s torque the ramp asks for at each speed. 0.6 keeps the usual reserve.',
      },
    ],
  },
  { title: 'Motor', fields: Object.values(MOTOR_SECTIONS).flat() },
  {
    title: 'Move',
    fields: [
      {
        path: 'move.steps',
        label: 'Distance',
        symbol: 'N',
        quantity: 'length',
        slider: { from: 1, to: 1e6, scale: 'log', figures: 3 },
        formula: '',
        help: 'Length of the plotted move; negative moves backward. Too short for the slew speed, it is a triangle.',
      },
    ],
  },
];

/** @type {{title: string, fields: Field[]}[]} */
export const GROUPS = DESCRIBED.map(({ title, fields }) => ({
  title,
  fields: fields.map((field) => ({ ...field, ...DESIGN_TAKES[field.path] })),
}));

/** Explanations of what is no number.
 * @type {Record<string, {label: string, formula: string, help: string}>} */
export const CHOICES = {
  'move.plan': {
    label: 'Short moves',
    formula: '',
    help: 'A move too short for the slew speed: planned by itself to a lower peak, soft all along; or cut out of the long ramp, as a controller plays moves of other lengths, with a jolt at its peak.',
  },
  'ramp.shape.points': {
    label: 'Drawn acceleration',
    formula: '',
    help: 'A point a line: a speed, and which part of the acceleration holds there, from 0.001 to 1. Smooth in between, level outside. Two columns of a spreadsheet can be pasted, with or without their heading.',
  },
  'drive.current_is': {
    label: 'Current is',
    formula: '',
    help: 'Trinamic drivers and Klipper set RMS currents, A4988 and DRV8825 peak ones.',
  },
  'motor.measured_with.current_is': {
    label: 'Current then is',
    formula: '',
    help: 'Whether the current that the driver was set to while it was measured is RMS or peak.',
  },
  'motor.kind': {
    label: 'Kind',
    formula: '',
    help: 'A hybrid motor has four full steps in a period of its field, which is what nearly all NEMA motors are; a gauge motor has six partial ones.',
  },
  'motor.torque_curve': {
    label: 'Torque curve',
    formula: '',
    help: 'A maker’s pull-out curve for your supply and current takes the place of the model: a line each, rpm and Nm, speeds rising, or two columns of a spreadsheet.',
  },
  'load.mechanism': {
    label: 'Moved by',
    formula: '',
    help: 'What lies between the motor’s shaft and what it moves: its masses and forces are brought to the shaft, and come on top of what is told there.',
  },
  'method.arithmetic': {
    label: 'Arithmetic',
    formula: '',
    help: 'How the target computes: float32 is what C float gives, operation for operation, float64 what double gives, fixed the integers of a chip without either.',
  },
  'method.rounding': {
    label: 'Rounding',
    formula: '',
    help: 'How a delay becomes whole ticks: nearest, down (floor), or down with the rest carried into the next delay.',
  },
  'method.tuned_for': {
    label: 'Tuned for',
    formula: '',
    help: 'What the method makes least with its c: the largest error of a delay, or the error of the time that the ramp takes.',
  },
  'axis.travel_unit': {
    label: 'Travel unit',
    formula: '',
    help: 'mm for a screw or a belt, degrees for a turntable or a gauge.',
  },
};
