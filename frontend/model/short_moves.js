// @ts-check
// What a controller makes of moves of other lengths than the one that is seen, for ramps that are not meant to be cut.

import { shapeOf } from './shapes.js';
import { methodOf } from './methods.js';
import { shownValue, unitWord } from './units.js';
import { formatFigures, formatFixed } from './numbers.js';

/** @param {import('./types.js').Design} design @param {import('./types.js').Profile['summary']} summary of its move
 * @param {import('./units.js').Units} units @returns {string} empty: there is nothing to say */
export function shortMovesText(design, summary, units) {
  const { steps, ramp_steps, ramp_speed_steps_per_s, is_lowered } = summary;
  if (shapeOf(design).begins_alike || methodOf(design.method.name).plays_table) return '';
  const length = `${formatFixed(ramp_steps)} steps`;
  if (is_lowered) {
    const speed = `${figures(shownValue(units, design, 'speed', ramp_speed_steps_per_s))} ${unitWord(units, design, 'speed')}`;
    return `Seen: a ramp made for this move, up to ${speed}. Pushed, it is the ramp of every move: longer ones run at ${speed}, shorter ones are cut out of it, with a jolt at their peak.`;
  }
  if (steps < ramp_steps)
    return `Seen: what the controller cuts out of a ramp of ${length} for this move, with a jolt at its peak. Moves from ${length} on reach the slew speed.`;
  return `Seen: the whole ramp of ${length}. Shorter moves the controller cuts out of it, with a jolt at their peak; longer ones run on at its speed.`;
}

/** @param {number} value */
const figures = (value) => (Math.abs(value) < 100 ? formatFigures(value) : formatFixed(value));
