// @ts-check
// The dialog that plays the table: what a gauge does when its target changes in flight. Nothing is sent to a device.

import { createQuestion, laterText } from '../../app/effects/question.js';
import { conversionProblem, convertedRows } from '../../model/design.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, messageLine } from '../../ui/dom.js';
import { formatEntry, formatFixed, parseEntry, pointHint } from '../../model/numbers.js';
import { createPlayChart } from './play_chart.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').PlayedTable} PlayedTable */
/** @typedef {import('./play_chart.js').Target} Target */

const FIELDS = /** @type {const} */ ([
  { name: 'first', label: 'Go to', unit: 'step' },
  { name: 'after', label: 'and after', unit: 'ms' },
  { name: 'second', label: 'to', unit: 'step' },
]);

/** @param {(request: object, ended: AbortSignal) => Promise<PlayedTable>} playTable */
export function createPlayDialog(playTable) {
  /** @type {Design | null} */
  let design = null;
  /** That of the design. */
  let axis = -1;
  const chart = createPlayChart();
  const result = element('div', { className: 'fit-result', id: 'play-result', role: 'status' });
  const inputs = FIELDS.map(({ name, label }) =>
    element('input', {
      id: `play-${name}`,
      inputMode: 'numeric',
      autocomplete: 'off',
      'aria-label': label,
      'aria-describedby': 'play-result',
      oninput: play,
    }),
  );
  const fields = FIELDS.flatMap(({ label, unit }, at) => [
    element('span', { className: 'muted', textContent: label }),
    element('span', { className: 'fit-field' }, inputs[at], element('span', { textContent: unit })),
  ]);
  const close = element('button', {
    className: 'button',
    type: 'button',
    textContent: 'Close',
    onclick: () => dialog.close(),
  });
  const dialog = createDialog(
    { id: 'play-dialog', title: 'Simulate the table', onSubmit: (event) => event.preventDefault() },
    element('p', {
      className: 'muted fit-about',
      textContent:
        'As a gauge library plays it: a target may change in flight, and the gauge stops before it turns. ' +
        'Computed only; no device moves.',
    }),
    element('div', { className: 'fit-wishes play-fields' }, ...fields),
    chart.element,
    result,
    dialogFoot(null, close),
  );

  const playing = createQuestion({
    ask: (/** @type {{table: object, range_steps: number, targets: Target[]}} */ request, ended) => playTable(request, ended),
    take: (played, { targets }) => show(played, '', targets),
    refuse: ({ message }) => show(null, message),
    miss: (_, error) => show(null, laterText(error)),
    isOnlyNewest: true,
  });
  dialog.element.addEventListener('close', playing.cancel);

  function play() {
    const entries = inputs.map((input) => parseEntry(input.value));
    inputs.forEach((input, at) => input.setAttribute('aria-invalid', String(!isWhole(entries[at]))));
    const problem = problemWith(entries);
    if (problem !== '' || !design?.table) {
      playing.cancel();
      show(null, problem);
      return;
    }
    const [first, after, second] = entries.map(Number);
    const targets = [
      { at_us: 0, target: first },
      { at_us: after * 1000, target: second },
    ];
    const { rows: own, interval_unit } = design.table;
    const { rows } = interval_unit === 'us' ? { rows: own } : convertedRows(own, 'us', Number(design.timer.frequency_hz));
    playing.want({ table: { rows }, range_steps: Math.max(first, second) + 1, targets });
  }

  /** Why nothing can be played; '' if it can.
   * @param {import('../../model/types.js').Entry[]} entries */
  function problemWith(entries) {
    if (!design?.table) return 'The design has no table.';
    const wrong = FIELDS.findIndex((_, at) => !isWhole(entries[at]));
    if (wrong >= 0) return `“${inputs[wrong].value}” is not a whole number from 0 on.${pointHint(inputs[wrong].value)}`;
    const { rows, interval_unit } = design.table;
    return interval_unit === 'us' ? '' : conversionProblem(rows, 'us', design.timer.frequency_hz);
  }

  /** @param {PlayedTable | null} played @param {string} problem @param {Target[]} [targets] */
  function show(played, problem, targets = []) {
    if (played === null) {
      chart.show(null, targets);
      result.replaceChildren(messageLine({ text: problem, isWarning: false }));
      return;
    }
    const told = played.stops.map(
      ({ at_us, position }) => `at step ${formatEntry(position)} after ${formatFixed(at_us / 1000, 1)} ms`,
    );
    const { position } = played.steps;
    const back = position.findIndex((step, at) => at > 0 && step < position[at - 1]);
    const turn = back < 0 ? '' : `It turns at step ${formatEntry(position[back - 1])}. `;
    const text = told.length === 0 ? 'It has nowhere to go.' : `${turn}At rest ${told.join(', then ')}.`;
    chart.show(played, targets, text);
    result.replaceChildren(element('p', { textContent: text }));
  }

  return {
    /** @param {Design} present @param {number} of the axis it is that of */
    open(present, of) {
      [design, axis] = [present, of];
      const steps = Math.abs(Number(present.move.steps)) || 100;
      const first = [steps, 300, Math.round(steps / 4)];
      inputs.forEach((input, at) => {
        if (input.value === '') input.value = formatEntry(first[at]);
      });
      dialog.open(inputs[0]);
      play();
    },
    /** What is in hand: the table that is played is that of the axis that it was opened for, as it is now.
     * @param {Design} present @param {number} of the axis it is that of */
    show(present, of) {
      if (!dialog.isOpen() || of !== axis || (present.table === design?.table && present.timer === design.timer)) return;
      design = present;
      play();
    },
    /** The server is back. */
    again: playing.again,
    axis: () => axis,
    close: dialog.close,
  };
}

/** @param {import('../../model/types.js').Entry} entry */
function isWhole(entry) {
  return typeof entry === 'number' && Number.isInteger(entry) && entry >= 0;
}
