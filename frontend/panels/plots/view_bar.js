// @ts-check
// The bar over the plots: what they are drawn against, which part of the move, what is kept to compare with, and on a
// phone which plot.

import { element, icon, picker, segmented } from '../../dom.js';

/** @typedef {import('../../curves.js').AxisName} AxisName */
/** @typedef {import('../../frame.js').PlotName} PlotName */
/** @typedef {import('../../frame.js').ViewName} ViewName */

/** @type {[AxisName, string][]} */
const AXES = [
  ['step', 'Step'],
  ['time', 'Time'],
  ['position', 'Position'],
];
/** @type {[ViewName, string][]} */
const VIEWS = [
  ['whole', 'Whole'],
  ['start', 'Start'],
  ['up', 'Up'],
  ['down', 'Down'],
];
/** @type {[PlotName, string][]} */
const PLOT_CHOICES = [
  ['velocity', 'Velocity'],
  ['delay', 'Delay'],
  ['error', 'Error'],
];

/**
 * @param {object} handlers
 * @param {(axis: AxisName) => void} handlers.onAxis
 * @param {(view: ViewName) => void} handlers.onView
 * @param {(plot: PlotName) => void} handlers.onPlot
 * @param {() => void} handlers.onKeep
 * @param {() => void} handlers.onForget
 */
export function createViewBar({ onAxis, onView, onPlot, onKeep, onForget }) {
  const axis = segmented('Horizontal axis', AXES, onAxis);
  const view = segmented('View', VIEWS, onView);
  const plot = segmented('Plot', PLOT_CHOICES, onPlot);
  const axisPicker = picker('Horizontal axis', (value) => onAxis(/** @type {AxisName} */ (value)));
  const viewPicker = picker('View', (value) => onView(/** @type {ViewName} */ (value)));
  axis.element.id = 'axis-choice';
  view.element.id = 'view-choice';
  plot.element.id = 'plot-choice';
  const forget = iconButton('forget', 'remove', 'Forget', 'Stop comparing with what was kept', onForget);
  const keep = iconButton('keep', 'pin', 'Keep this', 'Keep this design to compare the next changes with', onKeep);
  const label = (/** @type {string} */ text) =>
    element('span', { className: 'label', 'aria-hidden': 'true', textContent: text });
  forget.hidden = true;
  return {
    element: element(
      'div',
      { className: 'view-bar' },
      element('span', { className: 'not-phone choices' }, label('Against'), axis.element, label('View'), view.element),
      element('span', { className: 'phone-only choices' }, plot.element, viewPicker.element, axisPicker.element),
      element('span', { className: 'keeping' }, forget, keep),
    ),
    /** @param {{axis: AxisName, view: ViewName, only: PlotName, areAxesShown: boolean}} present */
    show(present) {
      axis.press(present.axis);
      view.press(present.view);
      plot.press(present.only);
      axisPicker.offer(AXES, present.axis);
      viewPicker.offer(VIEWS, present.view);
      // All axes have only their time in common.
      for (const choice of [...axis.element.children, ...view.element.children, axisPicker.select, viewPicker.select])
        /** @type {HTMLButtonElement} */ (choice).disabled = present.areAxesShown;
    },
    /** @param {boolean} isKept */
    showKept(isKept) {
      forget.hidden = !isKept;
    },
  };
}

/** @param {string} id @param {'pin' | 'remove'} drawing @param {string} text @param {string} title
 * @param {() => void} onclick */
function iconButton(id, drawing, text, title, onclick) {
  return element(
    'button',
    { className: 'button quiet', id, type: 'button', title, 'aria-label': `${text}: ${title}`, onclick },
    icon(drawing),
    element('span', { className: 'not-phone', textContent: text }),
  );
}
