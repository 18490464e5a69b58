// @ts-check
// What the motor can do, drawn over the figure: written anew only when it lies elsewhere, or says something else.

import { svgElement } from '../../ui/dom.js';

/** @typedef {import('../../plotting/motor_marks.js').MotorMarks} MotorMarks */

const CROSS = 'M-5,-5L5,5M-5,5L5,-5';
const TEXT_GAP = 4;

export function createMotorMarks() {
  const drawing = svgElement('svg', { class: 'overlay motor-marks', 'aria-hidden': 'true' });
  let shown = '';

  return {
    element: drawing,
    /** @param {boolean} isStale whether what is shown is of an earlier design */
    showStale: (isStale) => void drawing.classList.toggle('stale', isStale),
    /** @param {MotorMarks | null} found null: nothing is known of a motor */
    show(found) {
      const now = JSON.stringify(found);
      if (now === shown) return;
      shown = now;
      drawing.replaceChildren(...(found ? [...found.marks.flatMap(drawnMark), ...(found.lost ? drawnLoss(found.lost) : [])] : []));
    },
  };
}

/** @param {import('../../plotting/motor_marks.js').Mark} mark */
function drawnMark({ name, x, y, width, height, text }) {
  const shape =
    name === 'band'
      ? svgElement('rect', { class: 'band', x, y, width, height: Math.max(1, height) })
      : svgElement('line', { class: `limit ${name}`, x1: x, x2: x + width, y1: y, y2: y });
  // A line's text stands on it; that of a band in its midst.
  const at = name === 'band' ? y + height / 2 + TEXT_GAP : y - TEXT_GAP;
  return text === '' ? [shape] : [shape, textAt(text, x + width / 2, at, 'middle')];
}

/** @param {import('../../plotting/motor_marks.js').LostStep} lost */
function drawnLoss({ x, y, text }) {
  return [svgElement('path', { class: 'lost', d: CROSS, transform: `translate(${x} ${y})` }), textAt(text, x + 2 * TEXT_GAP, y + TEXT_GAP, 'start', 'lost-text')];
}

/** @param {string} text @param {number} x @param {number} y @param {'start' | 'middle'} anchor @param {string} [name] */
function textAt(text, x, y, anchor, name = '') {
  const label = svgElement('text', { class: name, x, y, 'text-anchor': anchor });
  label.textContent = text;
  return label;
}
