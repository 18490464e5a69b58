// @ts-check
// Moves: by so much, to a place, there and back, several axes along a line.

import { asTheAxisGoes } from '../../devices/ways.js';
import { element, segmented, showText } from '../../ui/dom.js';
import { refusalText } from '../../model/messages.js';
import { plainField } from '../../ui/plain_field.js';
import { quantityField } from '../../ui/quantity_field.js';
import { showAtPlaces } from '../../ui/refusal.js';
import { able, can, otherRampText, scaleText } from './section.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('./section.js').Context} Context */
/** @typedef {'by' | 'to' | 'back' | 'line'} Kind */

/** Proposed is the move that is planned.
 * @param {import('../../model/types.js').Design} design */
const planned = ({ move }) => move.steps;
const MOST_AXES = 4;
/** Matches no path. */
const NOTHING = /(?!)/;
const BUTTONS = { by: 'Move', to: 'Move', back: 'Start', line: 'Move' };

/** @param {{go: (device: Device, axis: number, what: 'move' | 'line' | 'there_and_back', body: unknown) => void}} act */
export function createMoveSection({ go }) {
  /** @type {Kind} */
  let kind = 'by';
  /** @type {Context | null} */
  let context = null;
  const kinds = segmented(
    'Kind of move',
    [
      ['by', 'By'],
      ['to', 'To'],
      ['back', 'There and back'],
      ['line', 'Line'],
    ],
    (value) => {
      kind = value;
      reject([]); // It was about the other kind.
      if (context) show(context);
    },
  );
  kinds.element.classList.add('fill');
  const distance = quantityField({
    id: 'move-steps',
    label: 'How far to move, or which position to move to',
    quantity: 'length',
    start: planned,
  });
  const times = plainField({ id: 'move-times', label: 'Times', unit: '×', value: '3' });
  const pause = plainField({ id: 'move-pause', label: 'Pause at each end', unit: 's pause', value: '0.5' });
  const lines = Array.from({ length: MOST_AXES }, (_, axis) =>
    quantityField({ id: `line-${axis}`, label: `How far axis ${axis} moves`, quantity: 'length', start: planned }),
  );
  const rows = lines.map((field, axis) =>
    element('label', { className: 'line-axis' }, element('span', { textContent: `Axis ${axis}` }), field.element),
  );
  const lineProblems = rows.map(() => element('div', { className: 'problem' }));
  const linesInSteps = rows.map((_, axis) => element('p', { className: 'reason', id: `line-${axis}-in-steps` }));
  const several = element(
    'div',
    { className: 'line-axes' },
    ...rows.flatMap((row, axis) => [row, lineProblems[axis], linesInSteps[axis]]),
  );
  const repeat = element('div', { className: 'line' }, times.element, pause.element);
  const move = element('button', {
    className: 'button',
    id: 'move',
    type: 'submit',
    'aria-describedby': 'move-reason',
  });
  const inSteps = element('p', { className: 'reason', id: 'move-in-steps' });
  const scale = element('p', { className: 'reason', id: 'move-scale' });
  const otherRamp = element('p', { className: 'reason warns', id: 'move-ramp' });
  const reason = element('p', { className: 'reason', id: 'move-reason' });
  const problem = element('div', { className: 'problem' });
  const timesProblem = element('div', { className: 'problem' });
  const pauseProblem = element('div', { className: 'problem' });
  const form = element(
    'form',
    { className: 'section', onsubmit: submitted, oninput: showSteps },
    kinds.element,
    several,
    repeat,
    timesProblem,
    pauseProblem,
    element('div', { className: 'line' }, distance.element, move),
    problem,
    inSteps,
    scale,
    otherRamp,
    reason,
  );

  /** Several axes along a line only where there are several. */
  function shownKind() {
    const isLine = (context?.device?.axes.length ?? 1) > 1 && (context === null || can(context, 'line'));
    return kind === 'line' && !isLine ? 'by' : kind;
  }

  /** @param {SubmitEvent} event */
  function submitted(event) {
    event.preventDefault();
    if (!context?.device || move.disabled) return;
    const kind = shownKind();
    const { device, axis } = context;
    const steps = distance.value();
    if (kind === 'line') {
      const own = device.axes.map((one) => ({ axis: one.axis, by_steps: lines[one.axis].value() }));
      go(device, axis, 'line', { axes: own });
    } else if (kind === 'back') {
      go(device, axis, 'there_and_back', { axis, by_steps: steps, times: times.value(), pause_s: pause.value() });
    } else if (axis === 0) {
      go(device, axis, 'move', kind === 'by' ? { by_steps: steps } : { to_steps: steps });
    } else {
      const own = kind === 'by' ? { axis, by_steps: steps } : { axis, to_steps: steps };
      go(device, axis, 'move', { axes: [own] });
    }
  }

  function showSteps() {
    const isLine = shownKind() === 'line';
    showStepsOf(distance, inSteps, !isLine);
    lines.forEach((field, axis) => showStepsOf(field, linesInSteps[axis], isLine && !rows[axis].hidden));
  }

  /** @param {ReturnType<typeof quantityField>} field @param {HTMLElement} place @param {boolean} isShown */
  function showStepsOf(field, place, isShown) {
    showText(place, isShown ? field.inSteps() : '');
    // What is refused says what it was taken for.
    place.hidden = place.textContent === '' || field.input.getAttribute('aria-invalid') === 'true';
  }

  /** @param {Context} present */
  function show(present) {
    context = present;
    const { device, situation, axis: chosen, inTheWay, notAtRest } = present;
    const { units, scaled } = situation;
    const count = device?.axes.length ?? 1;
    const lineButton = /** @type {HTMLElement} */ (kinds.element.querySelector('[data-value="line"]'));
    lineButton.hidden = count < 2 || !can(present, 'line');
    const shown = shownKind();
    kinds.press(shown);
    distance.show(units, scaled[chosen]);
    lines.forEach((field, axis) => {
      field.show(units, scaled[axis] ?? scaled[chosen]);
      rows[axis].hidden = axis >= count;
    });
    several.hidden = shown !== 'line';
    repeat.hidden = shown !== 'back';
    distance.element.hidden = shown === 'line';
    // The plots may show another axis than the one that is chosen here.
    showText(move, count > 1 && shown !== 'line' ? `${BUTTONS[shown]} axis ${chosen}` : BUTTONS[shown]);
    const noRamp = device && !device.ramp ? 'Push a ramp first.' : '';
    able([move], reason, inTheWay || notAtRest || noRamp, situation.isBusy);
    showText(scale, scaleText(present, shown === 'line' && device ? device.axes.map(({ axis }) => axis) : [chosen]));
    scale.hidden = scale.textContent === '';
    showText(otherRamp, otherRampText(present));
    otherRamp.hidden = otherRamp.textContent === '';
    showSteps();
  }

  /** @param {import('../../model/types.js').Rejection[]} rejections */
  function reject(rejections) {
    const isLine = shownKind() === 'line';
    const label = shownKind() === 'to' ? 'Position' : 'Distance';
    const told = (/** @type {import('../../model/types.js').Rejection} */ one, /** @type {number} */ axis) => {
      const state = context?.device?.axes[axis];
      return state ? asTheAxisGoes(one, state, shownKind() !== 'to') : one;
    };
    return showAtPlaces(rejections, [
      ...lines.map((field, axis) => ({
        path: isLine ? new RegExp(`^axes\\.${axis}\\.by_steps$`) : NOTHING,
        input: field.input,
        problem: lineProblems[axis],
        text: (/** @type {import('../../model/types.js').Rejection} */ one) => field.refusal(told(one, axis), `Distance of axis ${axis}`),
      })),
      {
        path: isLine ? NOTHING : /(^|\.)(by|to)_steps$/,
        input: distance.input,
        problem,
        text: (one) => distance.refusal(told(one, context?.axis ?? 0), label),
      },
      { path: /^times$/, input: times.input, problem: timesProblem, text: (one) => refusalText(one, 'Times') },
      { path: /^pause_s$/, input: pause.input, problem: pauseProblem, text: (one) => refusalText(one, 'The pause') },
    ]);
  }

  return { element: form, show, reject };
}
