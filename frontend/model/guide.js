// @ts-check
// The guide of a first visit: what it asks, and what the answers make of a design. Pure; a design that it made is like
// any other.

import { valueAt, withMethod, withValue } from './design.js';
import { tidy } from './numbers.js';
import { PRESETS, withPreset } from './presets.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./presets.js').Preset} Preset */
/** @typedef {import('./units.js').Units} Units */
/** @typedef {'motor' | 'limits' | 'ramp' | 'use'} GuideStep */
/** What the motor drives. linear: a screw, a belt or a rack.
 * @typedef {'linear' | 'wheel' | 'dial' | 'nothing'} Drive */
/** What makes the steps.
 * @typedef {'controller' | 'sketch' | 'grbl' | 'marlin' | 'chip'} Player */

/** Where the guide is, and what was answered that no design can hold.
 * @typedef {object} Guide
 * @property {boolean} isOpen
 * @property {GuideStep} step
 * @property {Drive | null} drive    null: not said; the design tells
 * @property {Player | null} player  null: not said */

/** @type {{name: GuideStep, label: string, title: string}[]} */
export const GUIDE_STEPS = [
  { name: 'motor', label: 'Motor', title: 'Your motor' },
  { name: 'limits', label: 'Limits', title: 'How fast it may go' },
  { name: 'ramp', label: 'Ramp', title: 'The ramp' },
  { name: 'use', label: 'Use', title: 'Put it to use' },
];

/** @type {Guide} */
export const FIRST_GUIDE = { isOpen: false, step: 'motor', drive: null, player: null };

/** What each drives: in which units its lengths are thought of, and the way of a turn that stands in until it is told.
 * @type {Record<Drive, {label: string, units: Units, travel_unit: 'mm' | 'deg', travel_per_rev: number}>} */
export const DRIVES = {
  linear: { label: 'Screw or belt', units: { length: 'mm', time: 's' }, travel_unit: 'mm', travel_per_rev: 8 },
  wheel: { label: 'Wheel', units: { length: 'mm', time: 's' }, travel_unit: 'mm', travel_per_rev: 65 * Math.PI },
  dial: { label: 'Gauge, turntable', units: { length: 'deg', time: 's' }, travel_unit: 'deg', travel_per_rev: 360 },
  nothing: { label: 'Nothing yet', units: { length: 'rev', time: 's' }, travel_unit: 'deg', travel_per_rev: 360 },
};

/** What of a guide's answers is known, of those that something holds.
 * @param {any} answers @returns {Pick<Guide, 'drive' | 'player'>} */
export const knownAnswers = (answers) => ({
  drive: Object.hasOwn(DRIVES, answers?.drive ?? '') ? answers.drive : null,
  player: Object.hasOwn(PLAYERS, answers?.player ?? '') ? answers.player : null,
});

/** @type {Record<Player, {label: string, help: string}>} */
export const PLAYERS = {
  controller: {
    label: 'StepRamp’s own controller',
    help: 'An Uno or Nano with StepRamp’s firmware, or the simulated one. It plays exact delays that are worked out here.',
  },
  sketch: { label: 'An Arduino sketch', help: 'A complete .ino for the Uno, with the exact delays in it.' },
  grbl: {
    label: 'grbl',
    help:
      'It works out ramps of constant acceleration itself. You get the settings to type into it; the curves show what they mean. ' +
      '“Largest error” holds them against the exact formula, whose first step from rest takes half as long: +100 % there is no fault of the machine.',
  },
  marlin: {
    label: 'Marlin',
    help: 'As grbl: you get the lines to send to it, and +100 % as “Largest error” of the first step from rest is no fault of the machine.',
  },
  chip: {
    label: 'Firmware of my own',
    help: 'C code that works the delays out on the chip, with the method that corrects itself.',
  },
};

/** The method that shows what a player does: exact delays are pushed as they are, constant acceleration is in time what
 * `ideal` plays, and of those worked out on the chip this one doesn't drift.
 * @type {Record<Player, string>} */
const METHOD_OF = { controller: 'exact', sketch: 'exact', grbl: 'ideal', marlin: 'ideal', chip: 'newton' };
/** Those that run by the timer of an Uno. */
const OF_AN_UNO = ['controller', 'sketch'];
const UNO_CLOCKS = PRESETS.timer.filter(({ values }) => values.counter_bits === 16);

/** What almost every motor does without load, and no machine is hurt by [full steps/s, full steps/s²]. */
const CAREFUL = { speed: 400, acceleration: 2000 };

/** What is driven, as far as a design tells.
 * @param {Design} design @param {Drive | null} said @returns {Drive} */
export function driveOf({ axis }, said) {
  if (said !== null && DRIVES[said].travel_unit === axis.travel_unit) return said;
  return axis.travel_unit === 'mm' ? 'linear' : 'dial';
}

/** The design with another thing driven.
 * @param {Design} design @param {Drive} drive @param {Drive | null} said what was driven before @returns {Design} */
export function withDrive(design, drive, said) {
  const { travel_unit, travel_per_rev } = DRIVES[drive];
  return drive === driveOf(design, said) ? design : { ...design, axis: { ...design.axis, travel_unit, travel_per_rev } };
}

/** The numbers that are told in steps. */
const IN_STEPS = [
  'ramp.base_speed_steps_per_s',
  'ramp.slew_speed_steps_per_s',
  'ramp.acceleration_steps_per_s2',
  'ramp.deceleration_steps_per_s2',
  'move.steps',
];

/** How many steps one turn of the motor takes; NaN while the design has no such numbers.
 * @param {Design} design */
const stepsPerTurn = ({ axis }) => Number(axis.full_steps_per_rev) * Number(axis.microsteps);

/** The design with the motor turning as it did before its steps became smaller or larger: as fast, and as far.
 * @param {Design} design @param {Design} before @returns {Design} */
export function withTurnsKept(design, before) {
  const [steps, stepsBefore] = [stepsPerTurn(design), stepsPerTurn(before)];
  if (!(steps > 0 && stepsBefore > 0)) return design;
  return IN_STEPS.reduce((kept, path) => {
    const entry = valueAt(before, path);
    if (typeof entry !== 'number') return kept;
    const scaled = steps === stepsBefore ? entry : tidy((entry * steps) / stepsBefore);
    return withValue(kept, path, path === 'move.steps' ? Math.round(scaled) : scaled);
  }, design);
}

/** The design as it is played: with the method that shows it, and where an Uno plays it, by one of an Uno's clocks.
 * @param {Design} design @param {Player} player @returns {Design} */
export function withPlayer(design, player) {
  const planned = withMethod(design, METHOD_OF[player]);
  const { frequency_hz, counter_bits } = design.timer;
  const isUno = UNO_CLOCKS.some(({ values }) => values.frequency_hz === frequency_hz && values.counter_bits === counter_bits);
  return !OF_AN_UNO.includes(player) || isUno ? planned : { ...withPreset(planned, 'timer', UNO_CLOCKS[0]), name: design.name };
}

/** The design with limits to begin with, from rest; never faster than its timer allows.
 * @param {Design} design @returns {Design} */
export function withCarefulLimits(design) {
  const microsteps = Number(design.axis.microsteps);
  const fastest = 1e6 / Number(design.timer.shortest_interval_us);
  if (!(microsteps > 0 && fastest > 0)) return design;
  const ramp = {
    ...design.ramp,
    base_speed_steps_per_s: 0,
    slew_speed_steps_per_s: Math.min(CAREFUL.speed * microsteps, fastest),
    acceleration_steps_per_s2: CAREFUL.acceleration * microsteps,
    deceleration_steps_per_s2: null,
  };
  return { ...design, ramp };
}

/** How many steps it takes to reach the slew speed and come to rest again; NaN while the design has no such numbers.
 * @param {Design} design */
export function leastSteps({ ramp }) {
  const { base_speed_steps_per_s, slew_speed_steps_per_s, acceleration_steps_per_s2: up, deceleration_steps_per_s2: down } = ramp;
  const gained = Number(slew_speed_steps_per_s) ** 2 - Number(base_speed_steps_per_s) ** 2;
  return Math.ceil(gained / 2 / Number(up)) + Math.ceil(gained / 2 / Number(down ?? up));
}

/** The design with a move of which half is at slew speed, in the direction that it has.
 * @param {Design} design @returns {Design} */
export function withLongMove(design) {
  const steps = 2 * leastSteps(design);
  return steps > 0 ? withValue(design, 'move.steps', Number(design.move.steps) < 0 ? -steps : steps) : design;
}

/** Turns a minute that a speed is; NaN while the axis has no such numbers.
 * @param {Design} design @param {string} path of the speed */
export function turnsPerMinute(design, path) {
  const steps = stepsPerTurn(design);
  return steps > 0 ? (Number(valueAt(design, path)) / steps) * 60 : NaN;
}
