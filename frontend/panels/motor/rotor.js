// @ts-check
// The dialog that shows what the rotor does of the planned move: how far the field leads it, how fast it turns, and how it comes
// to rest, with each damping.

import { createQuestion, laterText } from '../../app/effects/question.js';
import { designOf, shownCurvesOf } from '../../app/selectors.js';
import { whenChanged } from '../../app/state.js';
import { textOf } from '../../model/messages.js';
import { causeText, notCoveredText, VERDICTS } from '../../model/motor_words.js';
import { runRows } from '../../model/rotor_runs.js';
import { activeProfile } from '../../plotting/curves.js';
import { api } from '../../server/api.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, messageLine, segmented } from '../../ui/dom.js';
import { createRotorCharts } from './rotor_charts.js';

/** @typedef {import('../../model/types.js').Answer} Answer */
/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').MotorAnswer} MotorAnswer */
/** @typedef {import('../../model/units.js').Units} Units */

export function createRotor(ask = api.simulateRotor) {
  /** @type {{design: Design, units: Units} | null} */
  let present = null;
  /** @type {{answer: MotorAnswer, design: Design} | null} */
  let played = null;
  /** @type {Answer | null} */
  let curves = null;
  /** @type {import('./rotor_charts.js').Against} */
  let against = 'time';
  const choice = segmented('Over', [['time', 'Time'], ['step', 'Step']], (chosen) => {
    against = chosen;
    draw();
  }); // prettier-ignore
  const charts = createRotorCharts();
  const verdict = element('p', { className: 'verdict', role: 'status' });
  const table = element('table', { className: 'rotor-runs' });
  const notCovered = element('p', { className: 'muted' });
  const problem = element('div', { role: 'status' });
  const answer = element('div', { className: 'motor-answer', id: 'rotor-answer' }, verdict, charts.element, table, notCovered);
  const close = element('button', { className: 'button', type: 'button', textContent: 'Close', onclick: () => dialog.close() });
  const dialog = createDialog(
    { id: 'rotor-dialog', title: 'What the rotor does' },
    element('div', { className: 'dialog-row' }, element('span', { className: 'muted', textContent: 'Computed only; no device moves.' }), choice.element),
    answer,
    problem,
    dialogFoot(null, close),
  );
  const playing = createQuestion({
    ask: (/** @type {Design} */ design, ended) => ask(design, ended),
    take(found, design) {
      played = { answer: found, design };
      draw();
    },
    refuse: ({ rejections }) => tell(textOf(rejections)),
    miss: (_, error) => tell(laterText(error)),
    isOnlyNewest: true,
  });
  dialog.element.addEventListener('close', playing.cancel);

  function play() {
    if (present === null || !dialog.isOpen()) return;
    answer.setAttribute('aria-busy', 'true');
    if (present.design.motor === undefined) tell('The design has no motor.');
    else playing.want(present.design);
  }

  /** What was played before is over: drawn again, it would stand in for what is refused.
   * @param {string} text why there is nothing to show */
  function tell(text) {
    played = null;
    answer.hidden = true;
    problem.replaceChildren(messageLine({ text, isWarning: false }));
  }

  function draw() {
    choice.press(against);
    if (present === null || played === null || !dialog.isOpen()) return;
    const { answer: found, design } = played;
    problem.replaceChildren();
    answer.hidden = false;
    answer.setAttribute('aria-busy', String(design !== present.design));
    verdict.dataset.verdict = found.verdict;
    verdict.textContent = `${VERDICTS[found.verdict]}${causeText(found)}.`;
    notCovered.textContent = notCoveredText(found);
    charts.show(found, curves?.design === design ? activeProfile(curves) : null, against, present.units, design);
    showRuns(found);
  }

  /** @param {MotorAnswer} found */
  function showRuns(found) {
    const { runs } = found;
    const head = element('tr', {}, element('th', { scope: 'col', textContent: 'Damping ζ' }), ...runs.map(({ damping }) => element('th', { scope: 'col', textContent: String(damping) })));
    const rows = runRows(found).map(({ label, texts }) =>
      element('tr', {}, element('th', { scope: 'row', textContent: label }), ...texts.map((textContent) => element('td', { textContent }))),
    );
    table.replaceChildren(element('caption', { className: 'muted', textContent: 'The damping is the least-known number: the move is played with three.' }), head, ...rows);
  }

  const shows = [
    whenChanged((state) => [shownCurvesOf(state)], (shown) => {
      curves = shown;
      draw();
    }), // prettier-ignore
    whenChanged((state) => [designOf(state), state.units], (design, units) => {
      if (design === null) return;
      const isSame = design === present?.design;
      present = { design, units };
      if (isSame) draw();
      else play();
    }), // prettier-ignore
    whenChanged((state) => [state.devices.link], (link) => link === 'there' && playing.again()),
  ];

  return {
    open() {
      dialog.open();
      draw();
      play();
    },
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      for (const show of shows) show(state);
    },
  };
}
