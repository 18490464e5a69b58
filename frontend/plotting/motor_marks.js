// @ts-check
// What a motor can do, where the plots show it: speeds over the velocity, the greatest sudden acceleration over accelerations, and
// the step that it loses. Pixels of the figure; nothing of the page.

import { interpolate, unitsOf } from './curves.js';
import { activeCurve, xPixel, yPixel } from './frame.js';
import { formatFigures, formatFixed, formatHighest } from '../model/numbers.js';
import { shownValue, unitWord } from '../model/units.js';

/** @typedef {import('../model/types.js').MotorAnswer} MotorAnswer */
/** @typedef {import('./frame.js').Frame} Frame */
/** @typedef {import('./frame.js').PlotFrame} PlotFrame */
/** A line across a plot, or a band of it; its text stands on it, empty: there is no room.
 * @typedef {{name: 'start' | 'top' | 'sudden' | 'band', x: number, y: number, width: number, height: number, text: string}} Mark */
/** @typedef {{x: number, y: number, text: string}} LostStep */
/** @typedef {{marks: Mark[], lost: LostStep | null}} MotorMarks */

/** Of the pull-out torque, that a ramp should ask for at most. */
const MOST_USED = 0.6;
const FIGURES = 3;
/** So high a text is, and so far apart two have to be [px]. */
const TEXT_PX = 12;

/** Beyond which speed load and friction alone ask for more than the usual part of the torque [steps/s]; null: not as far as the
 * curve tells.
 * @param {MotorAnswer} answer */
export function topSpeedOf({ torque: { speed_steps_per_s: speeds, pull_out_nm: has, required_nm: asks } }) {
  // Faster than the ramp nothing is accelerated.
  const held = asks[asks.length - 1];
  const beyond = has.findIndex((torque) => MOST_USED * torque < held);
  return beyond < 0 ? null : speeds[Math.max(0, beyond - 1)];
}

/** @param {MotorAnswer} answer @param {Frame} frame @param {import('./frame.js').Scene} scene @returns {MotorMarks} */
export function motorMarksOf(answer, frame, scene) {
  const velocity = frame.plots[0];
  const { design } = scene.answer;
  const units = unitsOf(scene.answer);
  const speed = (/** @type {number} */ value) => shownValue(units, design, 'speed', value);
  const most = (/** @type {number} */ value) => formatHighest(speed(value), FIGURES);
  const sudden = formatHighest(shownValue(units, design, 'acceleration', answer.greatest_sudden_acceleration_steps_per_s2), FIGURES);
  const words = (/** @type {string} */ text) => `${text} ${unitWord(units, design, 'speed')}`;
  const top = topSpeedOf(answer);
  const start = answer.greatest_start_speed_steps_per_s;
  /** @type {Mark[]} */
  const marks = [
    ...answer.resonances_steps_per_s.map(([low, high]) =>
      across(frame, velocity, 'band', speed(low), speed(high), words(`resonance ${[low, high].map((end) => formatFigures(speed(end), FIGURES)).join(' to ')}`)),
    ),
    ...(start === 0 ? [] : [across(frame, velocity, 'start', speed(start), speed(start), words(`starts at once up to ${most(start)}`))]),
    ...(top === null || top === 0 ? [] : [across(frame, velocity, 'top', speed(top), speed(top), words(`enough torque up to ${most(top)}`))]),
    ...suddenMarks(answer, frame, scene, `may come at once up to ${sudden}`),
  ].flatMap((mark) => mark ?? []);
  return { marks: withRoom(marks), lost: lostStepOf(answer, frame, scene) };
}

/** @param {MotorAnswer} answer @param {Frame} frame @param {import('./frame.js').Scene} scene @param {string} text */
function suddenMarks(answer, frame, { answer: of, third }, text) {
  if (answer.greatest_sudden_acceleration_steps_per_s2 === 0) return [];
  const most = shownValue(unitsOf(of), of.design, 'acceleration', answer.greatest_sudden_acceleration_steps_per_s2);
  const lowest = frame.plots[frame.plots.length - 1];
  const planned = third === 'acceleration' ? [across(frame, lowest, 'sudden', most, most, text), across(frame, lowest, 'sudden', -most, -most, '')] : [];
  const implied = frame.acceleration ? [across(frame, { ...frame.plots[0], range: frame.acceleration }, 'sudden', most, most, `${text}, at the right`)] : [];
  return [...planned, ...implied];
}

/** What of a band from low to high lies within a plot; null: nothing.
 * @param {Frame} frame @param {PlotFrame} plot @param {Mark['name']} name @param {number} low @param {number} high
 * @param {string} text @returns {Mark | null} */
function across({ left, width }, plot, name, low, high, text) {
  const { range, top, height, isVisible } = plot;
  if (!isVisible || high < range.low || low > range.high) return null;
  const [above, below] = [Math.max(top, yPixel(plot, high)), Math.min(top + height, yPixel(plot, low))];
  return { name, x: left, y: above, width, height: below - above, text };
}

/** The marks with the texts for which there is room, the lines' before those of bands.
 * @param {Mark[]} marks @returns {Mark[]} */
function withRoom(marks) {
  /** @type {number[]} */
  const taken = [];
  const placed = [...marks].reverse().map((mark) => {
    const at = mark.y + mark.height / 2;
    const isFree = mark.text !== '' && taken.every((other) => Math.abs(other - at) >= TEXT_PX);
    if (isFree) taken.push(at);
    return isFree ? mark : { ...mark, text: '' };
  });
  return placed.reverse();
}

/** Where the first step is lost, on the line of the chosen method; null: none is, or it lies elsewhere.
 * @param {MotorAnswer} answer @param {Frame} frame @param {import('./frame.js').Scene} scene @returns {LostStep | null} */
function lostStepOf({ first_lost_step: step }, frame, scene) {
  const velocity = frame.plots[0];
  const curve = activeCurve(scene);
  if (step === null || !velocity.isVisible || curve.step.length === 0) return null;
  const x = xPixel(frame, interpolate(curve.step, curve.x, step));
  const y = yPixel(velocity, interpolate(curve.step, curve.shownSpeed, step));
  const isInside = x >= frame.left && x <= frame.left + frame.width && y >= velocity.top && y <= velocity.top + velocity.height;
  return isInside ? { x, y, text: `step ${formatFixed(step)} is lost` } : null;
}
