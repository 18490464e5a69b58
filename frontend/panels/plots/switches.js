// @ts-check
// The switches at the titles of plots: what is drawn beside the curves, and what the lowest plot shows.

import { element, segmented } from '../../ui/dom.js';

/** @typedef {import('../../plotting/frame.js').Third} Third */

/** @type {[Third, string][]} */
const THIRDS = [
  ['error', 'Error'],
  ['parts', 'Parts'],
  ['deviation', 'Deviation'],
];

/**
 * @param {object} handlers
 * @param {(isShown: boolean) => void} handlers.onAcceleration
 * @param {(third: Third) => void} handlers.onThird
 */
export function createSwitches({ onAcceleration, onThird }) {
  const acceleration = element('button', {
    className: 'plot-switch',
    id: 'show-acceleration',
    type: 'button',
    textContent: 'Acceleration',
    title: 'The acceleration between two delays, (vᵢ² − vᵢ₋₁²) / 2, on the scale at the right',
    onclick: () => onAcceleration(acceleration.getAttribute('aria-pressed') !== 'true'),
  });
  const third = segmented('Lowest plot', THIRDS, onThird);
  third.element.id = 'third-choice';
  third.element.classList.add('plot-switches');
  const deviation = /** @type {HTMLButtonElement} */ (third.element.querySelector('[data-value=deviation]'));
  return {
    elements: { velocity: acceleration, error: third.element },
    /** @param {{acceleration: boolean, third: Third}} present @param {boolean} isMeasured whether there is a deviation
     * @param {boolean} areAxesShown all of them have only speed and delay */
    show(present, isMeasured, areAxesShown) {
      acceleration.hidden = areAxesShown;
      acceleration.setAttribute('aria-pressed', String(present.acceleration));
      third.press(present.third);
      deviation.hidden = !isMeasured;
    },
  };
}
