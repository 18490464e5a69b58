// @ts-check
// The bar over the plots: what they are drawn against, which part of the move, what is pinned to compare with, and on a
// phone which plot.

import { onePlot, PLOTS, plotsThere } from '../../plotting/plots.js';
import { element, icon, picker, segmented } from '../../ui/dom.js';

/** @typedef {import('../../plotting/curves.js').PlotAxis} PlotAxis */
/** @typedef {import('../../plotting/frame.js').PlotName} PlotName */
/** @typedef {import('../../plotting/frame.js').ViewName} ViewName */

/** @type {[PlotAxis, string][]} */
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
/** How all axes are drawn, whatever was chosen for one.
 * @type {[PlotAxis, ViewName]} */
const ALL_AXES = ['time', 'whole'];
/** @type {[PlotName, string][]} */
const PLOT_CHOICES = PLOTS.map(({ name, label }) => [name, label]);

/**
 * @param {object} handlers
 * @param {(against: PlotAxis) => void} handlers.onPlotAxis
 * @param {(view: ViewName) => void} handlers.onView
 * @param {(plot: PlotName) => void} handlers.onPlot
 * @param {() => void} handlers.onPin
 * @param {() => void} handlers.onUnpin
 * @param {() => void} handlers.onCapture
 */
export function createViewBar({ onPlotAxis, onView, onPlot, onPin, onUnpin, onCapture }) {
  const plotAxis = segmented('Horizontal axis', AXES, onPlotAxis);
  const view = segmented('View', VIEWS, onView);
  const plot = segmented('Plot', PLOT_CHOICES, onPlot);
  const plotAxisPicker = picker('Horizontal axis', (value) => onPlotAxis(/** @type {PlotAxis} */ (value)));
  const viewPicker = picker('View', (value) => onView(/** @type {ViewName} */ (value)));
  plotAxis.element.id = 'axis-choice';
  view.element.id = 'view-choice';
  plot.element.id = 'plot-choice';
  // Enter that is held repeats itself, and the focus goes on to the other: one press does one thing.
  const once = (/** @type {KeyboardEvent} */ event) => {
    if (event.repeat && event.key === 'Enter') event.preventDefault();
  };
  const unpin = iconButton('forget', 'remove', 'Unpin', 'Stop comparing with the pinned design', () => {
    onUnpin();
    pin.focus();
  });
  const pin = iconButton('keep', 'pin', 'Pin', 'Pin this design to compare the next changes with it', onPin);
  const capture = iconButton('open-capture', 'pulses', 'Capture', 'Lay steps that a logic analyser measured over the plots', onCapture);
  const label = (/** @type {string} */ text) =>
    element('span', { className: 'label', 'aria-hidden': 'true', textContent: text });
  for (const button of [pin, unpin]) button.addEventListener('keydown', once);
  unpin.hidden = true;
  return {
    element: element(
      'div',
      { className: 'view-bar' },
      element('span', { className: 'all-plots-only choices' }, label('Against'), plotAxis.element, label('View'), view.element),
      element('span', { className: 'one-plot-only choices' }, plot.element, viewPicker.element, plotAxisPicker.element),
      element('span', { className: 'keeping' }, capture, unpin, pin),
    ),
    /** @param {{against: PlotAxis, view: ViewName, only: PlotName, areAxesShown: boolean}} present */
    show({ against, view: part, only, areAxesShown }) {
      // All axes have only their time in common, and all of it is drawn.
      const [drawnAgainst, drawnPart] = areAxesShown ? ALL_AXES : [against, part];
      plotAxis.press(drawnAgainst);
      view.press(drawnPart);
      plot.press(onePlot(only, areAxesShown));
      plotAxisPicker.offer(AXES, drawnAgainst);
      viewPicker.offer(VIEWS, drawnPart);
      for (const choice of [...plotAxis.element.children, ...view.element.children, plotAxisPicker.select, viewPicker.select])
        /** @type {HTMLButtonElement} */ (choice).disabled = areAxesShown;
      const there = plotsThere(areAxesShown).map(({ name }) => name);
      for (const choice of plot.element.querySelectorAll('button')) choice.disabled = !there.includes(choice.dataset.value ?? '');
    },
    /** @param {boolean} isPinned */
    showPinned(isPinned) {
      unpin.hidden = !isPinned;
    },
  };
}

/** @param {string} id @param {'pin' | 'remove' | 'pulses'} drawing @param {string} text @param {string} title
 * @param {() => void} onclick */
function iconButton(id, drawing, text, title, onclick) {
  return element(
    'button',
    { className: 'button quiet', id, type: 'button', title, 'aria-label': `${text}: ${title}`, onclick },
    icon(drawing),
    element('span', { className: 'not-short', textContent: text }),
  );
}
