// @ts-check
// What the small charts of dialogs are made of.

import { svgElement } from './dom.js';

/** @param {string} text @param {number} x @param {number} y @param {'start' | 'middle' | 'end'} anchor */
export function chartText(text, x, y, anchor) {
  const label = svgElement('text', { x, y, 'text-anchor': anchor });
  label.textContent = text;
  return label;
}

/** A line across the chart, with what it stands for to its left.
 * @param {string} text @param {number} left @param {number} right @param {number} y */
export function gridLine(text, left, right, y) {
  const line = svgElement('line', { class: 'grid', x1: left, x2: right, y1: y, y2: y });
  return [line, chartText(text, left - 8, y + 4, 'end')];
}
