// @ts-check
// The switches at the titles of plots: what is drawn beside the curves, and what the lowest plot shows.

import { element, picker, segmented } from '../../ui/dom.js';

/** @typedef {import('../../plotting/frame.js').Third} Third */

/** @type {[Third, string][]} */
const THIRDS = [
  ['error', 'Error'],
  ['parts', 'Parts'],
  ['deviation', 'Deviation'],
  ['acceleration', 'Acceleration'],
  ['jerk', 'Jerk'],
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
    textContent: 'Implied acceleration',
    title: 'The acceleration between two delays, (vᵢ² − vᵢ₋₁²) / 2, on the scale at the right',
    onclick: () => onAcceleration(acceleration.getAttribute('aria-pressed') !== 'true'),
  });
  const third = segmented('Lowest plot', THIRDS, onThird);
  const thirdPicker = picker('Lowest plot', (value) => onThird(/** @type {Third} */ (value)));
  third.element.id = 'third-choice';
  third.element.classList.add('plot-switches', 'all-plots-only');
  thirdPicker.element.classList.add('one-plot-only');
  const deviation = /** @type {HTMLButtonElement} */ (third.element.querySelector('[data-value=deviation]'));
  return {
    elements: { velocity: acceleration, error: element('span', { className: 'thirds' }, third.element, thirdPicker.element) },
    /** @param {{acceleration: boolean, third: Third}} present @param {boolean} isMeasured whether there is a deviation
     * @param {boolean} areAxesShown all of them have only speed and delay */
    show(present, isMeasured, areAxesShown) {
      acceleration.hidden = areAxesShown;
      acceleration.setAttribute('aria-pressed', String(present.acceleration));
      third.press(present.third);
      deviation.hidden = !isMeasured;
      thirdPicker.offer(
        THIRDS.filter(([name]) => name !== 'deviation' || isMeasured),
        present.third,
      );
    },
  };
}
