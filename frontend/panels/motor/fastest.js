// @ts-check
// The dialog that finds the fastest ramp of each shape that keeps a part of the motor's torque back, beside the design as it is.

import { mend } from '../../app/commands/work.js';
import { createQuestion, laterText } from '../../app/effects/question.js';
import { axisOf, designOf } from '../../app/selectors.js';
import { whenChanged } from '../../app/state.js';
import { figuresOf, isInUse } from '../../model/fastest_ramps.js';
import { refusalText, textOf } from '../../model/messages.js';
import { NOT_COVERED, VERDICTS } from '../../model/motor_words.js';
import { parseEntry } from '../../model/numbers.js';
import { SHAPES } from '../../model/shapes.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, icon, messageLine } from '../../ui/dom.js';
import { plainField } from '../../ui/plain_field.js';
import { showAtPlaces } from '../../ui/refusal.js';
import { createTimeChart } from '../../ui/time_chart.js';
import { askFastest, rampsAsCharts } from './fastest_ramps.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').FastestFigures} FastestFigures */
/** @typedef {import('../../model/types.js').FastestRamp} FastestRamp */
/** @typedef {import('../../model/types.js').Rejection} Rejection */
/** @typedef {import('./fastest_ramps.js').FoundRamps} FoundRamps */
/** @typedef {{design: Design, axis: number, units: import('../../model/units.js').Units}} Present */

const MARGIN = 'Part of the torque';
const USUAL_MARGIN = '0.6';
const CHART_HEIGHT = 96;

/** @param {import('../../app/state.js').Dispatch} dispatch */
export function createFastest(dispatch, ask = askFastest) {
  /** @type {Present | null} */
  let present = null;
  /** @type {{found: FoundRamps, design: Design, axis: number} | null} */
  let known = null;
  const margin = plainField({ id: 'fastest-margin', label: MARGIN, unit: 'of the torque', value: USUAL_MARGIN });
  margin.input.addEventListener('input', () => {
    // What was said of it was said of what stood there before.
    showAtPlaces([], [place]);
    find();
  });
  const marginProblem = element('div', { role: 'status' });
  const place = { path: /^margin$/, input: margin.input, problem: marginProblem, text: (/** @type {Rejection} */ one) => refusalText(one, MARGIN) };
  const problem = element('div', { role: 'status' });
  const words = element('p', { className: 'fastest-words', id: 'fastest-words', role: 'status' });
  const cards = element('div', { className: 'fastest-cards' });
  const notCovered = element('p', { className: 'muted', textContent: NOT_COVERED });
  const answer = element('div', { className: 'motor-answer', id: 'fastest-answer', hidden: true }, words, cards, notCovered);
  const close = element('button', { className: 'button', type: 'button', textContent: 'Close', onclick: () => dialog.close() });
  const dialog = createDialog(
    { id: 'fastest-dialog', title: 'Fastest safe ramp' },
    element('p', {
      className: 'muted',
      textContent:
        'The fastest ramp of each shape that asks for no more than a part of the motor’s torque, and whose move, played through the model, is safe. The slew speed stays, unless the move can’t reach it. Computed only; no device moves.',
    }),
    element('div', { className: 'dialog-row' }, element('label', { htmlFor: 'fastest-margin', textContent: 'The ramp may ask for' }), margin.element),
    marginProblem,
    problem,
    answer,
    dialogFoot(null, close),
  );
  const finding = createQuestion({
    ask: (/** @type {{design: Design, axis: number, part: import('../../model/types.js').Entry}} */ { design, part }, ended) => ask(design, part, ended),
    take(found, { design, axis }) {
      known = { found, design, axis };
      tell('');
      draw();
    },
    refuse: ({ rejections }) => tell('', rejections),
    miss: (_, error) => tell(laterText(error)),
    isOnlyNewest: true,
  });
  dialog.element.addEventListener('close', finding.cancel);

  function find() {
    if (present === null || !dialog.isOpen()) return;
    answer.setAttribute('aria-busy', 'true');
    if (present.design.motor === undefined) tell('The design has no motor.');
    else finding.want({ design: present.design, axis: present.axis, part: parseEntry(margin.input.value) });
  }

  /** Tell why there is nothing to show; nothing of both: there is. The field is marked for what is wrong with it alone.
   * @param {string} reason @param {Rejection[]} [rejections] */
  function tell(reason, rejections = []) {
    const others = showAtPlaces(rejections, [place]);
    const text = reason || textOf(others);
    answer.hidden = text !== '' || rejections.length > 0;
    problem.replaceChildren(...(text === '' ? [] : [messageLine({ text, isWarning: false })]));
  }

  function draw() {
    if (present === null || known === null || !dialog.isOpen()) return;
    const { found, design, axis } = known;
    const { candidates, present: own } = found.answer;
    const isOfAxis = axis === present.axis;
    const isOfPresent = isOfAxis && design === present.design;
    answer.setAttribute('aria-busy', String(!isOfPresent));
    words.textContent = found.answer.words;
    const [now, shown] = [present.design, { design, units: present.units }];
    const charts = rampsAsCharts(found, shown.units, design);
    cards.replaceChildren(
      card('As it is', own, charts[0], shown, null),
      ...candidates.map((one, index) => {
        const title = SHAPES.find(({ name }) => name === one.shape)?.label ?? one.shape;
        const inUse = isOfAxis && isInUse(now, one.changes);
        return card(title, one, charts[index + 1], shown, useButton(title, one, axis, inUse, isOfPresent));
      }),
    );
  }

  /** @param {string} title @param {FastestFigures & {is_fastest: boolean}} figures @param {import('../../ui/time_chart.js').TimeChart | null} chart
   * @param {Pick<Present, 'design' | 'units'>} shown @param {HTMLElement | null} use the button that uses it */
  function card(title, figures, chart, shown, use) {
    const head = element('h3', {}, title, figures.is_fastest && element('span', { className: 'fastest-badge' }, icon('ok'), 'fastest'));
    const box = element('section', { className: 'fastest-card', 'aria-label': title }, head);
    if (figures.verdict === null) {
      box.append(messageLine({ text: rejectedText(figures.rejections ?? []), isWarning: true }));
      return box;
    }
    const drawing = createTimeChart(CHART_HEIGHT);
    drawing.show(chart, `Speed over time of the beginning of the ramp. ${title}; dashed: as it is.`);
    const verdict = element('p', { className: 'verdict', textContent: VERDICTS[figures.verdict] });
    verdict.dataset.verdict = figures.verdict;
    const rows = figuresOf(figures, shown.units, shown.design).flatMap(([name, text]) => [element('dt', { textContent: name }), element('dd', { textContent: text })]);
    box.append(drawing.element, verdict, element('dl', {}, ...rows));
    if (use) box.append(use);
    return box;
  }

  /** @param {Rejection[]} rejections of a shape, by itself or for the part of the torque */
  function rejectedText(rejections) {
    const ofMargin = rejections.filter(({ field }) => place.path.test(field ?? ''));
    return [...ofMargin.map(place.text), textOf(rejections.filter((one) => !ofMargin.includes(one)))].join(' ').trim();
  }

  /** What was found for another axis, or before the design changed, waits for its own answer.
   * @param {string} title @param {FastestRamp} ramp @param {number} axis that it was found for @param {boolean} inUse
   * @param {boolean} isOfPresent */
  function useButton(title, { changes }, axis, inUse, isOfPresent) {
    return element('button', {
      className: 'button small',
      type: 'button',
      textContent: inUse ? 'In use' : 'Use this',
      'aria-label': inUse ? `In use: ${title}` : `Use this: ${title}`,
      disabled: inUse || !isOfPresent,
      onclick() {
        dispatch(mend, axis, { text: title, changes });
        margin.input.focus();
      },
    });
  }

  const shows = [
    whenChanged((state) => [designOf(state), axisOf(state), state.units], (design, axis, units) => {
      if (design === null || axis === null) return;
      // An axis that was added has the same design as the one that it was made of.
      const isSame = design === present?.design && axis === present.axis;
      present = { design, axis, units };
      draw();
      if (!isSame) find();
    }), // prettier-ignore
    whenChanged((state) => [state.devices.link], (link) => link === 'there' && finding.again()),
  ];

  return {
    open() {
      dialog.open(margin.input);
      draw();
      find();
    },
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      for (const show of shows) show(state);
    },
  };
}
