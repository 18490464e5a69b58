// @ts-check
// How far the field leads the rotor, and how fast the rotor turns beside what it is told, over time or steps.

import { formatFixed, roundParts } from '../../model/numbers.js';
import { shownValue, unitWord } from '../../model/units.js';
import { element } from '../../ui/dom.js';
import { createTimeChart } from '../../ui/time_chart.js';

/** @typedef {import('../../model/types.js').MotorAnswer} MotorAnswer */
/** @typedef {import('../../model/types.js').Profile} Profile */
/** @typedef {'time' | 'step'} Against */

const HEIGHT = 116;
const PARTS_ACROSS = 6;
const LEVELS = 4;
/** From here on times are told in seconds [s]. */
const LONG_S = 10;
/** Beyond it a step is lost. */
const LOST_DEG = 180;
const USUAL_DAMPING = 0.05;
/** Of the rotor's swings after a lost step no more is drawn than so many times what it is told. */
const MOST_BEYOND = 2;

export function createRotorCharts() {
  const angle = { chart: createTimeChart(HEIGHT), title: element('h3') };
  const speed = { chart: createTimeChart(HEIGHT), title: element('h3') };
  return {
    element: element('div', { className: 'rotor-charts' }, angle.title, angle.chart.element, speed.title, speed.chart.element),
    /** @param {MotorAnswer} found @param {Profile | null} told the planned move; null: it is on its way
     * @param {Against} against @param {import('../../model/units.js').Units} units @param {import('../../model/types.js').Design} design */
    show(found, told, against, units, design) {
      const { rotor } = found;
      const across = axisOf(rotor, told, against);
      // What is drawn is what it does with a usual damping.
      const usual = found.runs.find(({ damping }) => damping === USUAL_DAMPING) ?? found.runs[0];
      const lost = lostAt(found, usual.first_lost_step, against);
      const over = against === 'time' ? 'time' : 'steps';
      angle.title.textContent = `Load angle over ${over}, electrical °, with ζ = ${USUAL_DAMPING}; a step is lost beyond ±${LOST_DEG}`;
      const angles = rotor.load_angle_deg;
      // Once a step is lost the rotor falls behind by turns: nothing is read of that.
      const most = 1.1 * LOST_DEG;
      const levels = [-LOST_DEG, -LOST_DEG / 2, 0, LOST_DEG / 2, LOST_DEG].map((at) => ({ at, text: `${formatFixed(at)}°` }));
      const limits = { x: [0, across.end, 0, across.end], y: [LOST_DEG, NaN, -LOST_DEG, NaN] };
      const way = { x: across.of(rotor), y: angles.map((one) => within(one, -most, most)) };
      const words = `at most ${formatFixed(usual.largest_load_angle_deg)}°${usual.first_lost_step === null ? '' : `; step ${formatFixed(usual.first_lost_step)} is lost`}`;
      angle.chart.show({ ...across, low: -most, high: most, levels, wanted: limits, way, dots: [], marks: lost }, `${angle.title.textContent}: ${words}.`);

      const shown = (/** @type {number} */ value) => shownValue(units, design, 'speed', value);
      speed.title.textContent = `Speed of the rotor over ${over}, ${unitWord(units, design, 'speed')}; dashed: as it is told`;
      const asked = (told?.speed_steps_per_s ?? []).map(shown);
      const fastest = Math.max(...asked, 0) || Math.max(...rotor.speed_steps_per_s.map((one) => Math.abs(shown(one))), 1);
      const made = rotor.speed_steps_per_s.map((one) => within(shown(one), -fastest, MOST_BEYOND * fastest));
      const scale = roundParts(Math.min(0, ...made), Math.max(...made, fastest), LEVELS);
      const wanted = { x: told ? across.of({ step: told.step, time_s: told.time_s }) : [], y: asked };
      speed.chart.show(
        { ...across, low: scale[0].at, high: scale[scale.length - 1].at, levels: scale, wanted, way: { x: way.x, y: made }, dots: [], marks: lost },
        `${speed.title.textContent}.`,
      );
    },
  };
}

/** @param {number} value @param {number} low @param {number} high */
const within = (value, low, high) => Math.min(high, Math.max(low, value));

/** The axis across: where it ends, what is written at it, and the places of steps on it.
 * @param {MotorAnswer['rotor']} rotor @param {Profile | null} told @param {Against} against */
function axisOf(rotor, told, against) {
  const of = (/** @type {Pick<MotorAnswer['rotor'], 'step' | 'time_s'>} */ { step, time_s }) => (against === 'time' ? time_s : step);
  const last = of(rotor)[rotor.step.length - 1];
  const end = Math.max(against === 'time' ? (told?.summary.duration_s ?? last) : last, 1e-6);
  const [unit, per] = against === 'step' ? ['', 1] : end < LONG_S ? [' ms', 1000] : [' s', 1];
  const times = roundParts(0, end * per, PARTS_ACROSS).flatMap(({ at, text }) => (at / per <= end ? [{ at: at / per, text }] : []));
  times[times.length - 1].text += unit;
  return { of, end, times };
}

/** Where the first step is lost.
 * @param {MotorAnswer} found @param {number | null} step null: none is @param {Against} against */
function lostAt({ rotor }, step, against) {
  if (step === null) return [];
  const index = Math.max(0, rotor.step.findIndex((one) => one >= step));
  return [{ at: against === 'step' ? step : rotor.time_s[index], text: `step ${formatFixed(step)} lost` }];
}
