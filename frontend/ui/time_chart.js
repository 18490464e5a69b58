// @ts-check
// A small chart over time: a way as stairs, dashed what was wanted, dots on it, and marks of instants.

import { chartText, DIGIT, gridLine } from './chart.js';
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

/** While it isn't known how wide it is shown. */
const USUAL_WIDTH = 420;
const LEFT = 44;
const RIGHT = 12;
const TOP = 12;
const BOTTOM = 26;
/** A text that stands for what is nearer to the edge ends there. */
const HALF_A_TEXT = 20;
/** Between the texts of two marks. */
const MARK_GAP = 3;

/** @param {number} height */
export function createTimeChart(height) {
  const drawing = svgElement('svg', { class: 'small-chart still', role: 'img' });
  /** @type {TimeChart | null} */
  let shown = null;
  let width = 0;
  // As wide as it is shown, so that its texts are as large as any.
  if (typeof ResizeObserver !== 'undefined') new ResizeObserver(fit).observe(drawing);

  function fit() {
    if (shown === null || drawing.clientWidth === 0 || drawing.clientWidth === width) return;
    drawing.replaceChildren();
    draw(shown);
  }

  /** @param {TimeChart} chart */
  function draw({ end, low, high, times, levels, wanted, way, dots, marks = [] }) {
    width = drawing.clientWidth || USUAL_WIDTH;
    drawing.setAttribute('viewBox', `0 0 ${width} ${height}`);
    const xOf = (/** @type {number} */ time) => LEFT + (time / end) * (width - LEFT - RIGHT);
    const yOf = (/** @type {number} */ value) => TOP + ((high - value) / (high - low)) * (height - TOP - BOTTOM);
    for (const { at, text } of levels) drawing.append(...gridLine(text, LEFT, width - RIGHT, yOf(at)));
    for (const { at, text } of times) {
      const anchor = xOf(at) + HALF_A_TEXT > width ? 'end' : 'middle';
      drawing.append(chartText(text, xOf(at), height - 8, anchor));
    }
    for (const { at } of marks) {
      drawing.append(svgElement('line', { class: 'mark', x1: xOf(at), x2: xOf(at), y1: TOP, y2: height - BOTTOM }));
    }
    for (const { at, text } of apart(marks, xOf)) {
      const isLong = text.length > 1 && xOf(at) < LEFT + HALF_A_TEXT;
      drawing.append(chartText(text, xOf(at), TOP - 3, isLong ? 'start' : 'middle'));
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
      shown = chart;
      if (chart === null) return;
      drawing.setAttribute('aria-label', label);
      draw(chart);
    },
  };
}

/** The ticks whose texts have room, from left to right.
 * @param {Tick[]} ticks @param {(time: number) => number} xOf */
function apart(ticks, xOf) {
  let end = -Infinity;
  return [...ticks]
    .sort((one, other) => one.at - other.at)
    .filter(({ at, text }) => {
      const half = (text.length * DIGIT) / 2;
      if (xOf(at) - half < end) return false;
      end = xOf(at) + half + MARK_GAP;
      return true;
    });
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
