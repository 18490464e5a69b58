// @ts-check
// The dialog that plays the design's ramp to what the motor is told in flight. Nothing is sent to a device.

import { createQuestion, laterText } from '../../app/effects/question.js';
import { tellInFlight } from '../../app/commands/view.js';
import { designOf, shownCurvesOf } from '../../app/selectors.js';
import { whenChanged } from '../../app/state.js';
import { commandsOf, flightOf, flightText, MS_PER_S } from '../../model/flight.js';
import { textOf } from '../../model/messages.js';
import { activeProfile } from '../../plotting/curves.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, icon, messageLine } from '../../ui/dom.js';
import { createCharts } from './charts.js';
import { createRows } from './rows.js';

/** @typedef {import('../../model/flight.js').Flight} Flight */
/** @typedef {import('../../model/flight.js').Told} Told */
/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').Rejection} Rejection */
/** @typedef {import('../../model/units.js').Units} Units */

/** More than a chart can show: a long play comes thinned. */
const MOST_POINTS = 4_000;
const USUAL_STEPS = 100;
const USUAL_DURATION_S = 1;
/** So long a time's text is, when it is proposed. */
const FIGURES = 3;

/** @param {(play: object, ended: AbortSignal) => Promise<import('../../model/types.js').InFlight>} ask
 * @param {import('../../app/state.js').Dispatch} dispatch */
export function createFlight(ask, dispatch) {
  /** @type {{design: Design, units: Units} | null} */
  let present = null;
  /** Of the planned move. */
  let durationS = USUAL_DURATION_S;
  /** What a person has said; null: the rows are proposed.
   * @type {Told[] | null} */
  let told = null;
  /** What is drawn.
   * @type {{flight: Flight, told: Told[]} | null} */
  let drawn = null;
  const rows = createRows(keep);
  const charts = createCharts();
  const result = element('div', { className: 'flight-result', id: 'flight-result', role: 'status' });
  const answer = element('div', { className: 'flight-answer', id: 'flight-answer' }, charts.element, result);
  const addRow = element(
    'button',
    { className: 'button quiet small', id: 'flight-add', type: 'button', onclick: add },
    icon('plus'),
    'Add a command',
  );
  const close = element('button', { className: 'button', type: 'button', textContent: 'Close', onclick: () => dialog.close() });
  const dialog = createDialog(
    { id: 'flight-dialog', title: 'In flight', onSubmit: (event) => event.preventDefault() },
    element('p', {
      className: 'muted',
      textContent:
        'What the motor does when its target or speed changes while it moves, from rest at position 0, as a controller plays ' +
        'the ramp that is pushed. Computed only; no device moves.',
    }),
    rows.element,
    element('div', {}, addRow),
    answer,
    dialogFoot(null, close),
  );

  const playing = createQuestion({
    ask: ({ design, told }, ended) => ask({ design, commands: commandsOf(told), max_points: MOST_POINTS }, ended),
    take(found, /** @type {{design: Design, told: Told[]}} */ { told }) {
      rows.reject([]);
      drawn = { flight: flightOf(found, told), told };
      draw();
    },
    refuse: ({ rejections }) => showProblem(textOf(rows.reject(rejections))),
    miss: (_, error) => showProblem(laterText(error)),
    isOnlyNewest: true,
  });
  dialog.element.addEventListener('close', playing.cancel);

  function keep() {
    told = rows.told();
    dispatch(tellInFlight, told);
    play();
  }

  function play() {
    if (present === null || !dialog.isOpen()) return;
    answer.setAttribute('aria-busy', 'true');
    playing.want({ design: present.design, told: rows.told() });
  }

  function add() {
    const last = Number(rows.told().at(-1)?.atMs) || 0;
    const row = rows.add({ atMs: rounded(last + halfMs()), kind: 'target', value: 0 });
    row.input.focus();
    keep();
  }

  const halfMs = () => rounded((durationS * MS_PER_S) / 2);

  function propose() {
    const steps = Number(present?.design.move.steps) || USUAL_STEPS;
    rows.set([
      { atMs: 0, kind: 'target', value: steps },
      { atMs: halfMs(), kind: 'target', value: 0 },
    ]);
  }

  function draw() {
    if (present === null || drawn === null) return;
    const { design, units } = present;
    const text = flightText(drawn.flight, units, design);
    charts.show(drawn.flight, drawn.told, units, design, text);
    result.replaceChildren(element('p', { textContent: text }));
    answer.setAttribute('aria-busy', 'false');
  }

  /** @param {string} problem empty: it is said at a row */
  function showProblem(problem) {
    drawn = null;
    if (present) charts.show(null, [], present.units, present.design, '');
    result.replaceChildren(...(problem === '' ? [] : [messageLine({ text: problem, isWarning: false })]));
    answer.setAttribute('aria-busy', 'false');
  }

  const shows = [
    whenChanged(
      (state) => [state.inFlight],
      (kept) => {
        if (kept !== null && kept !== told) rows.set((told = kept));
      },
    ),
    whenChanged(
      (state) => [shownCurvesOf(state)],
      (curves) => {
        if (curves) durationS = activeProfile(curves).summary.duration_s;
      },
    ),
    whenChanged(
      (state) => [designOf(state), state.units],
      (design, units) => {
        if (design === null) return;
        const isSame = design === present?.design;
        present = { design, units };
        rows.show(units, design);
        if (isSame) draw();
        else play();
      },
    ),
    whenChanged(
      (state) => [state.devices.link],
      (link) => link === 'there' && playing.again(),
    ),
  ];

  return {
    open() {
      if (told === null) propose();
      dialog.open(rows.element.querySelector('input'));
      play();
    },
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      for (const show of shows) show(state);
    },
  };
}

/** @param {number} ms */
const rounded = (ms) => Number(ms.toPrecision(FIGURES));
