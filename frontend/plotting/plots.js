// @ts-check
// The plots, from top to bottom: an entry each, with all that is its own. Nothing else lists them.

import { formatFigures, formatFixed } from '../model/numbers.js';
import { unitWord } from '../model/units.js';
import { unitsOf } from './curves.js';

/** @typedef {import('./curves.js').Curve} Curve */
/** @typedef {import('./curves.js').MethodReading} MethodReading */

/** @typedef {object} Plot
 * @property {string} name
 * @property {string} plotlyAxis
 * @property {string} label     where one plot at a time is chosen
 * @property {string} title
 * @property {(answer: import('../model/types.js').Answer) => string} unit
 * @property {'from zero' | 'logarithmic' | 'around zero'} scale
 * @property {(curve: Curve) => {x: number[], y: number[]}} curve  what is drawn of a method
 * @property {((move: import('./frame.js').Measured) => number[]) | null} measured  what is drawn of a measured move
 * @property {(own: import('./frame.js').OwnCurve) => number[]} own  what is drawn of what a controller plays itself
 * @property {((axis: import('./frame.js').AxisCurve) => number[]) | null} ofAxis   what is drawn where all axes are shown;
 *   null: it is not there then
 * @property {(at: MethodReading) => number} read                  what the cursor reads of a method
 * @property {(value: number) => string} readingText */

/** @type {Plot[]} */
export const PLOTS = [
  {
    name: 'velocity',
    plotlyAxis: 'y',
    label: 'Velocity',
    title: 'Velocity',
    unit: (answer) => unitWord(unitsOf(answer), answer.design, 'speed'),
    scale: 'from zero',
    curve: ({ x, shownSpeed }) => ({ x, y: shownSpeed }),
    measured: ({ velocity }) => velocity,
    own: ({ velocity }) => velocity,
    ofAxis: ({ velocity }) => velocity,
    read: (at) => at.shownSpeed,
    readingText: formatReading,
  },
  {
    name: 'delay',
    plotlyAxis: 'y2',
    label: 'Delay',
    title: 'Delay per step',
    unit: () => 'µs',
    scale: 'logarithmic',
    curve: ({ x, delay_us }) => ({ x, y: delay_us }),
    measured: ({ delay }) => delay,
    own: ({ delay }) => delay,
    ofAxis: ({ delay }) => delay,
    read: (at) => at.delay_us,
    readingText: formatReading,
  },
  {
    name: 'error',
    plotlyAxis: 'y3',
    label: 'Error',
    title: 'Error against exact',
    unit: () => '% of the interval',
    scale: 'around zero',
    curve: ({ error }) => ({ x: error.x, y: error.percent }),
    measured: null,
    own: ({ error }) => error,
    ofAxis: null,
    read: (at) => at.percent,
    readingText: (percent) => formatFixed(percent, 2),
  },
];

/** What the lowest plot shows of every method in place of its errors.
 * @type {Partial<Record<import('./frame.js').Third, Pick<Plot, 'title' | 'unit' | 'curve' | 'read' | 'readingText'>>>} */
const MOTION = {
  acceleration: {
    title: 'Planned acceleration',
    unit: (answer) => unitWord(unitsOf(answer), answer.design, 'acceleration'),
    curve: ({ x, motion }) => ({ x: motion ? x : [], y: motion?.acceleration ?? [] }),
    read: (at) => at.acceleration,
    readingText: formatReading,
  },
  jerk: {
    title: 'Planned jerk',
    unit: (answer) => unitWord(unitsOf(answer), answer.design, 'jerk'),
    curve: ({ x, motion }) => ({ x: motion ? x : [], y: motion?.jerk ?? [] }),
    read: (at) => at.jerk,
    readingText: formatReading,
  },
};

/** Whether the lowest plot shows what is planned, before its delays are rounded.
 * @param {import('./frame.js').Third} third */
export const isOfMotion = (third) => third in MOTION;

/** The plots with what the lowest one shows.
 * @param {import('./frame.js').Third} [third] @returns {Plot[]} */
export const plotsShowing = (third = 'error') =>
  PLOTS.map((plot) => (plot.name === 'error' ? { ...plot, ...MOTION[third] } : plot));

/** The plots that there are: of the error only one axis' methods have some.
 * @param {boolean} areAxesShown */
export const plotsThere = (areAxesShown) => PLOTS.filter((plot) => !areAxesShown || plot.ofAxis !== null);

/** The one plot where there is room for one: the chosen one, if it is there.
 * @param {string} chosen @param {boolean} areAxesShown @returns {string} */
export function onePlot(chosen, areAxesShown) {
  const there = plotsThere(areAxesShown);
  return (there.find(({ name }) => name === chosen) ?? there[0]).name;
}

/** @param {number} value */
export function formatReading(value) {
  if (!Number.isFinite(value) || value === 0) return value === 0 ? '0' : '–';
  return Math.abs(value) < 100 ? formatFigures(value) : formatFixed(value, 1);
}
