// @ts-check
// A motor's way and its speed over time: what it is told is marked by numbers, its rests by dots.

import { MS_PER_S } from '../../model/flight.js';
import { roundParts } from '../../model/numbers.js';
import { shownValue, unitWord } from '../../model/units.js';
import { element } from '../../ui/dom.js';
import { createTimeChart } from '../../ui/time_chart.js';

/** @typedef {import('../../model/flight.js').Flight} Flight */
/** @typedef {import('../../model/flight.js').Told} Told */
/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/units.js').Units} Units */

const HEIGHT = 136;
const TIME_PARTS = 6;
const LEVEL_PARTS = 4;
/** From here on times are told in seconds [s]. */
const LONG_S = 10;

/** @type {{name: string, quantity: 'length' | 'speed', kind: Told['kind'], along: (flight: Flight) => number[]}[]} */
const CHARTS = [
  { name: 'Position', quantity: 'length', kind: 'target', along: ({ steps }) => steps.position },
  { name: 'Speed', quantity: 'speed', kind: 'speed', along: ({ steps }) => steps.speed },
];

export function createCharts() {
  const parts = CHARTS.map((what) => ({ ...what, chart: createTimeChart(HEIGHT), title: element('h3') }));
  const box = element('div', { className: 'flight-charts' }, ...parts.flatMap(({ title, chart }) => [title, chart.element]));
  return {
    element: box,
    /** @param {Flight | null} flight @param {Told[]} told @param {Units} units @param {Design} design @param {string} text */
    show(flight, told, units, design, text) {
      box.hidden = flight === null;
      for (const { name, quantity, kind, along, chart, title } of parts) {
        const shown = (/** @type {number} */ value) => shownValue(units, design, quantity, value);
        title.textContent = `${name} over time, ${unitWord(units, design, quantity)}`;
        const wanted = told.map((one) => (one.kind === kind ? shown(Number(one.value)) : NaN));
        chart.show(flight && chartOf(flight, told, wanted, along(flight).map(shown), quantity), `${name} over time. ${text}`);
      }
    },
  };
}

/** @param {Flight} flight @param {Told[]} told @param {number[]} wanted of each command, NaN: it is about something else
 * @param {number[]} way @param {'length' | 'speed'} quantity
 * @returns {import('../../ui/time_chart.js').TimeChart} */
function chartOf({ end_s, steps, rests }, told, wanted, way, quantity) {
  const end = Math.max(end_s, 0.001);
  const [unit, perS] = end < LONG_S ? ['ms', MS_PER_S] : ['s', 1];
  const times = roundParts(0, end * perS, TIME_PARTS)
    .map(({ at, text }) => ({ at: at / perS, text }))
    .filter(({ at }) => at <= end);
  times[times.length - 1].text += ` ${unit}`;
  const [low, high] = extent([...way, ...wanted]);
  const levels = roundParts(low, high, LEVEL_PARTS);
  const at = told.map(({ atMs }) => Number(atMs) / MS_PER_S);
  return {
    end,
    low: levels[0].at,
    high: levels[levels.length - 1].at,
    times,
    levels,
    wanted: { x: [...at, end], y: [...wanted, wanted[wanted.length - 1]] },
    way: { x: [...steps.at_s, end], y: [...way, way[way.length - 1]] },
    dots: rests.map(({ at_s }) => ({ x: at_s, y: quantity === 'speed' ? 0 : way[lastUntil(steps.at_s, at_s)] })),
    marks: at.map((time, index) => ({ at: time, text: String(index + 1) })),
  };
}

/** The least and the greatest, with room where all are the same.
 * @param {number[]} values */
function extent(values) {
  const known = values.filter((value) => !Number.isNaN(value));
  const low = known.reduce((least, value) => Math.min(least, value), 0);
  const high = known.reduce((most, value) => Math.max(most, value), 0);
  return low === high ? [low, low + 1] : [low, high];
}

/** The place of the last of rising times that is not later.
 * @param {number[]} times @param {number} time */
const lastUntil = (times, time) => times.findLastIndex((one) => one <= time);
