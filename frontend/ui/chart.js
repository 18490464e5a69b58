// @ts-check
// What the small charts of dialogs are made of.

import { svgElement } from './dom.js';

/** @param {string} text @param {number} x @param {number} y @param {'start' | 'middle' | 'end'} anchor */
export function chartText(text, x, y, anchor) {
  const label = svgElement('text', { x, y, 'text-anchor': anchor });
  label.textContent = text;
  return label;
}

/** About so wide is a digit [px]. */
export const DIGIT = 5.8;
const GAP = 8;

/** A line across the chart, with what it stands for to its left: narrower where there is no room for it, never cut.
 * @param {string} text @param {number} left @param {number} right @param {number} y */
export function gridLine(text, left, right, y) {
  const line = svgElement('line', { class: 'grid', x1: left, x2: right, y1: y, y2: y });
  const label = chartText(text, left - GAP, y + 4, 'end');
  const room = left - GAP - 2;
  if (text.length * DIGIT > room) {
    label.setAttribute('textLength', String(room));
    label.setAttribute('lengthAdjust', 'spacingAndGlyphs');
  }
  return [line, label];
}
