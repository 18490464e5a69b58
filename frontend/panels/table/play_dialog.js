// @ts-check
// The dialog that plays the table: what a gauge does when its target changes in flight. Nothing is sent to a device.

import { createQuestion, laterText } from '../../app/effects/question.js';
import { conversionProblem, convertedRows } from '../../model/design.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, messageLine } from '../../ui/dom.js';
import { textOf } from '../../model/messages.js';
import { formatEntry, formatFixed } from '../../model/numbers.js';
import { createPlayChart } from './play_chart.js';
import { createPlayFields } from './play_fields.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').PlayedTable} PlayedTable */
/** @typedef {import('./play_chart.js').Target} Target */

/** @param {(request: object, ended: AbortSignal) => Promise<PlayedTable>} playTable */
export function createPlayDialog(playTable) {
  /** @type {Design | null} */
  let design = null;
  /** That of the design. */
  let axis = -1;
  const chart = createPlayChart();
  const result = element('div', { className: 'fit-result', id: 'play-result', role: 'status' });
  const fields = createPlayFields(result.id, play);
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
    fields.element,
    chart.element,
    result,
    dialogFoot(null, close),
  );

  const playing = createQuestion({
    ask: (/** @type {{table: object, range_steps: number, targets: Target[]}} */ request, ended) => playTable(request, ended),
    take: (played, { targets }) => show(played, '', targets),
    refuse: ({ rejections }, { targets }) => show(null, textOf(fields.reject(rejections, targets))),
    miss: (_, error) => show(null, laterText(error)),
    isOnlyNewest: true,
  });
  dialog.element.addEventListener('close', playing.cancel);

  function play() {
    const targets = fields.targets();
    const problem = tableProblem();
    if (targets === null || problem !== '' || !design?.table) {
      playing.cancel();
      show(null, problem);
      return;
    }
    const { rows: own, interval_unit } = design.table;
    const { rows } = interval_unit === 'us' ? { rows: own } : convertedRows(own, 'us', Number(design.timer.frequency_hz));
    playing.want({ table: { rows }, range_steps: Math.max(...targets.map(({ target }) => target)) + 1, targets });
  }

  /** Why the table can't be played; '' if it can. */
  function tableProblem() {
    if (!design?.table) return 'The design has no table.';
    const { rows, interval_unit } = design.table;
    return interval_unit === 'us' ? '' : conversionProblem(rows, 'us', design.timer.frequency_hz);
  }

  /** @param {PlayedTable | null} played @param {string} problem empty: a field says it @param {Target[]} [targets] */
  function show(played, problem, targets = []) {
    if (played === null) {
      chart.show(null, targets);
      result.replaceChildren(...(problem === '' ? [] : [messageLine({ text: problem, isWarning: false })]));
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
      fields.propose([steps, 300, Math.round(steps / 4)]);
      dialog.open(fields.first);
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
