// @ts-check
// The dialog that plays the table: what a gauge does when its target changes in flight. Nothing is sent to a device.

import { convertedRows } from '../../design.js';
import { createDialog, dialogFoot } from '../../dialog.js';
import { element, messageLine } from '../../dom.js';
import { newestWins } from '../../newest.js';
import { formatEntry, formatFixed, parseEntry } from '../../numbers.js';
import { createPlayChart } from './play_chart.js';

/** @typedef {import('../../types.js').Design} Design */
/** @typedef {import('../../types.js').PlayedTable} PlayedTable */

const FIELDS = /** @type {const} */ ([
  { name: 'first', label: 'Go to', unit: 'step' },
  { name: 'after', label: 'and after', unit: 'ms' },
  { name: 'second', label: 'to', unit: 'step' },
]);

/** @param {(request: object) => Promise<PlayedTable>} playTable */
export function createPlayDialog(playTable) {
  /** @type {Design | null} */
  let design = null;
  const chart = createPlayChart();
  const result = element('div', { className: 'fit-result', id: 'play-result', role: 'status' });
  const inputs = FIELDS.map(({ name, label }) =>
    element('input', {
      id: `play-${name}`,
      inputMode: 'numeric',
      autocomplete: 'off',
      'aria-label': label,
      'aria-describedby': 'play-result',
      oninput: () => play(),
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
    { id: 'play-dialog', title: 'Play the table', onSubmit: (event) => event.preventDefault() },
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

  const play = newestWins(async () => {
    if (design?.table === undefined || design?.table === null || !dialog.isOpen()) return;
    const entries = inputs.map((input) => parseEntry(input.value));
    inputs.forEach((input, at) => input.setAttribute('aria-invalid', String(!isWhole(entries[at]))));
    const wrong = FIELDS.findIndex((_, at) => !isWhole(entries[at]));
    if (wrong >= 0) return show(null, `“${inputs[wrong].value}” is not a whole number from 0 on.`);
    const [first, after, second] = entries.map(Number);
    const targets = [
      { at_us: 0, target: first },
      { at_us: after * 1000, target: second },
    ];
    const { rows } =
      design.table.interval_unit === 'us'
        ? design.table
        : convertedRows(design.table.rows, 'us', Number(design.timer.frequency_hz));
    try {
      show(await playTable({ table: { rows }, range_steps: Math.max(first, second) + 1, targets }), '', targets);
    } catch (error) {
      if (!(error instanceof Error)) throw error;
      show(null, error.message);
    }
  });

  /** @param {PlayedTable | null} played @param {string} problem @param {{at_us: number, target: number}[]} [targets] */
  function show(played, problem, targets = []) {
    chart.show(played, targets);
    if (played === null) {
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
    chart.element.setAttribute('aria-label', `Position over time. ${text}`);
    result.replaceChildren(element('p', { textContent: text }));
  }

  return {
    /** @param {Design} present */
    open(present) {
      design = present;
      const steps = Math.abs(Number(present.move.steps)) || 100;
      const first = [steps, 300, Math.round(steps / 4)];
      inputs.forEach((input, at) => {
        if (input.value === '') input.value = formatEntry(first[at]);
      });
      dialog.open(inputs[0]);
      play();
    },
  };
}

/** @param {import('../../types.js').Entry} entry */
function isWhole(entry) {
  return typeof entry === 'number' && Number.isInteger(entry) && entry >= 0;
}
