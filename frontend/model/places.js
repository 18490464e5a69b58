// @ts-check
// Lengths and positions of a device in the unit that is shown.

import { formatFigures, formatFixed } from './numbers.js';
import { shownValue, unitsFor, unitWord } from './units.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./units.js').Units} Units */

const FIGURES = 6;

/** A length or a position without its unit.
 * @param {Units} units @param {Design} design @param {number} steps */
export const lengthFigures = (units, design, steps) =>
  unitsFor(units, design).length === 'steps' ? formatFixed(steps) : formatFigures(shownValue(units, design, 'length', steps), FIGURES);

/** The same with it, such as "12.5000 mm".
 * @param {Units} units @param {Design} design @param {number} steps */
export const lengthText = (units, design, steps) => `${lengthFigures(units, design, steps)} ${unitWord(units, design, 'length')}`;
