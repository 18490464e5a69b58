// @ts-check
// A small chart over time: a way as stairs, dashed what was wanted, dots on it, and marks of instants.

import { chartText, gridLine } from './chart.js';
import { svgElement } from './dom.js';

/** @typedef {{at: number, text: string}} Tick */

/** A value that is kept until the next one; NaN: none.
 * @typedef {{x: number[], y: number[]}} Stairs */

/** @typedef {object} TimeChart
 * @property {number} end      of the time, which begins with 0
 * @property {number} low      of the values
 * @property {number} high
 * @property {Tick[]} times
 * @property {Tick[]} levels
 * @property {Stairs} wanted
 * @property {Stairs} way
 * @property {{x: number, y: number}[]} dots
 * @property {Tick[]} [marks]  of instants */

const WIDTH = 420;
const LEFT = 44;
const RIGHT = 12;
const TOP = 12;
const BOTTOM = 26;
/** A text that stands for what is nearer to the edge ends there. */
const HALF_A_TEXT = 20;

/** @param {number} height */
export function createTimeChart(height) {
  const drawing = svgElement('svg', { class: 'small-chart still', viewBox: `0 0 ${WIDTH} ${height}`, role: 'img' });

  /** @param {TimeChart} chart */
  function draw({ end, low, high, times, levels, wanted, way, dots, marks = [] }) {
    const xOf = (/** @type {number} */ time) => LEFT + (time / end) * (WIDTH - LEFT - RIGHT);
    const yOf = (/** @type {number} */ value) => TOP + ((high - value) / (high - low)) * (height - TOP - BOTTOM);
    for (const { at, text } of levels) drawing.append(...gridLine(text, LEFT, WIDTH - RIGHT, yOf(at)));
    for (const { at, text } of times) {
      const anchor = xOf(at) + HALF_A_TEXT > WIDTH ? 'end' : 'middle';
      drawing.append(chartText(text, xOf(at), height - 8, anchor));
    }
    for (const { at, text } of marks) {
      const line = svgElement('line', { class: 'mark', x1: xOf(at), x2: xOf(at), y1: TOP, y2: height - BOTTOM });
      drawing.append(line, chartText(text, xOf(at), TOP - 3, 'middle'));
    }
    drawing.append(svgElement('path', { class: 'wanted', d: stairsPath(wanted, xOf, yOf) }));
    drawing.append(svgElement('path', { class: 'line', d: stairsPath(way, xOf, yOf) }));
    for (const { x, y } of dots) drawing.append(svgElement('circle', { class: 'dot', cx: xOf(x), cy: yOf(y), r: 3 }));
  }

  return {
    element: drawing,
    /** @param {TimeChart | null} chart null: there is none @param {string} [label] what it shows, in words */
    show(chart, label = '') {
      drawing.replaceChildren();
      if (chart === null) return;
      drawing.setAttribute('aria-label', label);
      draw(chart);
    },
  };
}

/** @param {Stairs} stairs @param {(time: number) => number} xOf @param {(value: number) => number} yOf */
function stairsPath({ x, y }, xOf, yOf) {
  let isBegun = false;
  const parts = x.map((time, at) => {
    const across = short(xOf(time));
    if (Number.isNaN(y[at])) {
      const end = isBegun ? `H${across}` : '';
      isBegun = false;
      return end;
    }
    const down = short(yOf(y[at]));
    const part = isBegun ? `H${across}V${down}` : `M${across} ${down}`;
    isBegun = true;
    return part;
  });
  return parts.join('');
}

/** Hundredths of a pixel.
 * @param {number} value */
const short = (value) => Math.round(value * 100) / 100;
