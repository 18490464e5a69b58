// @ts-check
// The dialog for fitting rows to the ramp: the size or the error wished for, what comes of it, and only then the rows.

import { createQuestion, laterText } from '../../app/effects/question.js';
import { linearTableAsC } from '../../documents/c_table.js';
import { quoted } from '../../model/quoted.js';
import { copyText } from '../../ui/clipboard.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, messageLine, segmented } from '../../ui/dom.js';
import { methodOf, REFERENCE } from '../../model/methods.js';
import { counted, formatEntry, formatFigures, parseEntry } from '../../model/numbers.js';
import { createFitChart } from './fit_chart.js';
import { fitKey, problemOf, rowsPreview } from './fits.js';
import { createPurpose } from './purpose.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').Entry} Entry */
/** @typedef {import('../../model/types.js').FitCurve} FitCurve */
/** @typedef {import('../../model/types.js').FittedTable} FittedTable */
/** @typedef {import('./fits.js').Wish['name']} WishName */
/** @typedef {'constant' | 'linear'} Kind */
/** @typedef {import('../../model/types.js').FitTo} FitTo */
/** Rows with what they were fitted to, and by what wish.
 * @typedef {{rows: [number, number][], unit: string, design: Design, wish: import('../../model/types.js').FitWish}} Fit */

/** @type {import('./fits.js').Wish[]} */
const WISHES = [
  { name: 'rows', label: 'Rows', unit: 'rows', factor: 1 },
  { name: 'largest_relative_error', label: 'Error', unit: '%', factor: 100 },
  { name: 'bytes', label: 'Bytes', unit: 'bytes', factor: 1 },
];
/** @type {Record<FitTo, string>} */
const PLAYER_NOTES = {
  played: 'For gauge libraries and this page’s plots: they play steps up from index 2, and steps down to index 0.',
  ramp_index: 'For programs that play step k at index k, speeding up and slowing down. The plots play it otherwise.',
};
const LINEAR_NOTE =
  'A linear row takes 6 bytes: last index, delay at its first step, and what is added each step. The table of a design ' +
  'has rows of constant delay; linear ones can be copied for a program that adds.';

/**
 * @param {Pick<typeof import('../../server/api.js').api, 'fitTable' | 'fitCurve'>} ask
 * @param {(fit: Fit, purpose: import('./purpose.js').Purpose) => void} onRows
 */
export function createFitDialog(ask, onRows) {
  /** @type {Design | null} */
  let design = null;
  /** That of the design. */
  let axis = 0;
  /** @type {WishName} */
  let wish = 'rows';
  /** What each wish's field holds.
   * @type {Record<WishName, Entry>} */
  const wanted = { rows: 8, largest_relative_error: 30, bytes: 64 };
  /** @type {Kind} */
  let kind = 'constant';
  /** @type {FitTo} */
  let fitTo = 'played';
  /** The curves of the present design, as they come in.
   * @type {Partial<Record<`${Kind} ${FitTo}`, FitCurve>>} */
  let curves = {};
  /** @type {FittedTable | null} */
  let fitted = null;
  /** What the rows would be used as.
   * @type {Fit | null} */
  let usable = null;

  const about = element('p', { className: 'muted fit-about' });
  const wishes = segmented(
    'Fit to',
    WISHES.map(({ name, label }) => [name, label]),
    chooseWish,
  );
  const kinds = segmented(
    'Kind of row',
    [
      ['constant', 'Constant'],
      ['linear', 'Linear'],
    ],
    chooseKind,
  );
  const players = segmented(
    'Player of the table',
    [
      ['played', 'As played'],
      ['ramp_index', 'By index'],
    ],
    choosePlayer,
  );
  const playerNote = element('span', { className: 'muted' });
  const input = element('input', {
    id: 'fit-wish',
    'aria-label': WISHES[0].label,
    inputMode: 'decimal',
    autocomplete: 'off',
    'aria-describedby': 'fit-result',
    oninput: () => {
      wanted[wish] = parseEntry(input.value);
      fit();
    },
  });
  const unitWord = element('span', { className: 'unit' });
  const chart = createFitChart((rows) => {
    wanted.rows = rows;
    wish = 'rows';
    fit();
  });
  const result = element('div', { className: 'fit-result', id: 'fit-result', role: 'status' });
  const preview = element('div', { className: 'preview', tabIndex: 0, role: 'group', 'aria-label': 'Fitted rows' });
  const purpose = createPurpose('fit');
  const use = element('button', { className: 'button primary', type: 'submit', textContent: 'Use the rows' });
  const copy = element('button', {
    className: 'button primary',
    type: 'button',
    textContent: 'Copy as C',
    onclick: copyLinear,
  });
  const dialog = createDialog(
    { id: 'fit-dialog', title: 'Fit to the ramp', onSubmit: submitted },
    about,
    element(
      'div',
      { className: 'fit-wishes' },
      wishes.element,
      element('span', { className: 'fit-field' }, input, unitWord),
      kinds.element,
    ),
    element('div', { className: 'fit-wishes' }, players.element, playerNote),
    chart.element,
    result,
    preview,
    purpose.element,
    dialogFoot(() => dialog.close(), copy, use),
  );

  dialog.element.addEventListener('close', () => {
    fitting.cancel();
    drawing.cancel();
  });

  /** @param {WishName} chosen */
  function chooseWish(chosen) {
    wish = chosen;
    fit();
    input.focus();
    input.select();
  }

  /** @param {Kind} chosen */
  function chooseKind(chosen) {
    kind = chosen;
    forget();
    fit();
    fetchCurve();
  }

  /** @param {FitTo} chosen */
  function choosePlayer(chosen) {
    fitTo = chosen;
    forget();
    fit();
    fetchCurve();
  }

  const chosenWish = () => /** @type {import('./fits.js').Wish} */ (WISHES.find(({ name }) => name === wish));

  /** Show what is wished for, and ask for it. */
  function fit() {
    const { label, unit } = chosenWish();
    wishes.press(wish);
    kinds.press(kind);
    players.press(fitTo);
    playerNote.textContent = PLAYER_NOTES[fitTo];
    unitWord.textContent = unit;
    input.setAttribute('aria-label', label);
    if (parseEntry(input.value) !== wanted[wish]) input.value = formatEntry(wanted[wish]);
    fitNewest();
  }

  const intervalUnit = () => design?.table?.interval_unit ?? 'us';
  const presentCurve = () => curves[`${kind} ${fitTo}`] ?? null;

  const fitting = createQuestion({
    ask: (/** @type {{to: Design, unit: string, requested: import('../../model/types.js').FitWish}} */ { to, requested }, ended) =>
      ask.fitTable(to, requested, ended),
    take(answer, { to, unit, requested }) {
      show(answer);
      usable = answer.table && { rows: answer.table.rows, unit, design: to, wish: requested };
    },
    refuse: (refusal) => show(null, problemOf(refusal, chosenWish(), wanted[wish])),
    miss: (_, error) => show(null, laterText(error)),
    isOnlyNewest: true,
  });

  function fitNewest() {
    const value = wanted[wish];
    if (design === null || !dialog.isOpen()) return;
    // What is no number goes as it is: the server says what is allowed, as of any other field.
    const [size, unit] = [typeof value === 'number' ? value / chosenWish().factor : value, intervalUnit()];
    fitting.want({ to: design, unit, requested: { [wish]: size, row_kind: kind, interval_unit: unit, fit_to: fitTo } });
  }

  const showCurve = () => chart.show(presentCurve(), fitted?.rows ?? 0);
  const drawing = createQuestion({
    ask: (/** @type {{to: Design, kindOfRow: {row_kind: Kind, interval_unit: string, fit_to: FitTo}}} */ { to, kindOfRow }, ended) =>
      ask.fitCurve(to, kindOfRow, ended),
    take(curve, { to, kindOfRow }) {
      if (to === design) curves[`${kindOfRow.row_kind} ${kindOfRow.fit_to}`] = curve;
      showCurve();
    },
    // Without the curve a size can still be typed; what is wrong with the design the fit says.
    refuse: showCurve,
  });

  function fetchCurve() {
    if (design === null || !dialog.isOpen() || presentCurve()) return;
    drawing.want({ to: design, kindOfRow: { row_kind: kind, interval_unit: intervalUnit(), fit_to: fitTo } });
  }

  /** @param {FittedTable | null} shown @param {string} [problem] why there is none */
  function show(shown, problem = '') {
    [fitted, usable] = [shown, null];
    chart.show(presentCurve(), shown?.rows ?? 0);
    input.setAttribute('aria-invalid', String(shown === null));
    use.disabled = copy.disabled = shown === null;
    use.hidden = kind === 'linear';
    copy.hidden = !use.hidden;
    purpose.element.hidden = use.hidden;
    copy.textContent = 'Copy as C';
    use.textContent = shown === null ? 'Use the rows' : `Use ${counted(shown.rows, 'row')}`;
    if (shown === null) {
      result.replaceChildren(messageLine({ text: problem, isWarning: false }));
      preview.replaceChildren();
      return;
    }
    const figure = (/** @type {string} */ text) => element('b', { textContent: text });
    result.replaceChildren(
      element(
        'p',
        {},
        figure(counted(shown.rows, 'row')),
        ` · ${formatEntry(shown.bytes)} bytes · largest error `,
        figure(`± ${formatFigures(shown.largest_relative_error * 100, 3)} %`),
      ),
      element('p', { className: 'muted', textContent: floorNote(shown.floor) }),
      ...(kind === 'linear' ? [element('p', { className: 'muted', textContent: LINEAR_NOTE })] : []),
    );
    preview.replaceChildren(rowsPreview(shown, intervalUnit() === 'us' ? 'µs' : 'ticks'));
  }

  /** @param {import('../../model/types.js').Floor} floor */
  function floorNote({ relative_error, ramp_index }) {
    const least = formatFigures(relative_error * 100, 3);
    const unit = intervalUnit() === 'us' ? 'µs' : 'ticks';
    const why =
      fitTo === 'played' ? 'one whole delay has to do for steps up and down' : `the delay is rounded to whole ${unit}`;
    return `No number of rows does better than ± ${least} %: at index ${formatEntry(ramp_index)} ${why}.`;
  }

  async function copyLinear() {
    if (!fitted?.linear_rows) return;
    const isCopied = await copyText(linearTableAsC(fitted.linear_rows, intervalUnit()));
    copy.textContent = isCopied ? 'Copied' : 'The browser does not let the page copy';
  }

  /** @param {SubmitEvent} event */
  function submitted(event) {
    const meant = purpose.purpose();
    if (usable && meant) onRows(usable, meant);
    else event.preventDefault();
  }

  /** What was fitted is of another ramp, kind of row or player: it can't be used any more. */
  function forget() {
    [fitted, usable] = [null, null];
    use.disabled = copy.disabled = true;
  }

  /** @param {Design} to */
  function begin(to) {
    design = to;
    curves = {};
    forget();
    chart.show(null, 0);
    const own = methodOf(to.method.name);
    const method = own.plays_table ? methodOf(REFERENCE) : own;
    const speed = formatEntry(to.ramp.slew_speed_steps_per_s);
    about.textContent = `The best rows for the ramp of ${quoted(to.name || 'unnamed')} by ${method.label} up to ${speed} steps/s.`;
  }

  return {
    /** @param {Design} present @param {number} of the axis it is that of */
    open(present, of) {
      axis = of;
      begin(present);
      purpose.open(present, of);
      dialog.open(input);
      fit();
      fetchCurve();
    },
    /** What is in hand: the fit follows the ramp of the axis that it was opened for, and stays with it.
     * @param {Design} present @param {number} of the axis it is that of */
    show(present, of) {
      purpose.show(of);
      if (!dialog.isOpen() || of !== axis || design === null || fitKey(present) === fitKey(design)) return;
      begin(present);
      fit();
      fetchCurve();
    },
    /** The server is back. */
    again() {
      fitting.again();
      drawing.again();
    },
    axis: () => axis,
    close: dialog.close,
  };
}
