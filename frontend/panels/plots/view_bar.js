// @ts-check
// The bar over the plots: what they are drawn against, which part of the move, and on a phone which plot.

import { element, picker, segmented } from '../../dom.js';

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
 */
export function createViewBar({ onAxis, onView, onPlot }) {
  const axis = segmented('Horizontal axis', AXES, onAxis);
  const view = segmented('View', VIEWS, onView);
  const plot = segmented('Plot', PLOT_CHOICES, onPlot);
  const axisPicker = picker('Horizontal axis', (value) => onAxis(/** @type {AxisName} */ (value)));
  const viewPicker = picker('View', (value) => onView(/** @type {ViewName} */ (value)));
  axis.element.id = 'axis-choice';
  view.element.id = 'view-choice';
  plot.element.id = 'plot-choice';
  const label = (/** @type {string} */ text) =>
    element('span', { className: 'label', 'aria-hidden': 'true', textContent: text });
  return {
    element: element(
      'div',
      { className: 'view-bar' },
      element('span', { className: 'not-phone choices' }, label('Against'), axis.element, label('View'), view.element),
      element('span', { className: 'phone-only choices' }, plot.element, viewPicker.element, axisPicker.element),
    ),
    /** @param {AxisName} axisName @param {ViewName} viewName @param {PlotName} plotName */
    show(axisName, viewName, plotName) {
      axis.press(axisName);
      view.press(viewName);
      plot.press(plotName);
      axisPicker.offer(AXES, axisName);
      viewPicker.offer(VIEWS, viewName);
    },
  };
}
