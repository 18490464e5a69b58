// @ts-check
// The dialog for fitting rows to the ramp: the size or the error wished for, what comes of it, and only then the rows.

import { Refusal } from '../../api.js';
import { linearTableAsC } from '../../c_table.js';
import { copyText } from '../../clipboard.js';
import { createDialog, dialogFoot } from '../../dialog.js';
import { element, messageLine, segmented } from '../../dom.js';
import { methodOf, REFERENCE } from '../../methods.js';
import { newestWins } from '../../newest.js';
import { formatEntry, formatFigures, parseEntry } from '../../numbers.js';
import { createFitChart } from './fit_chart.js';
import { previewTable } from './preview_table.js';

/** @typedef {import('../../types.js').Design} Design */
/** @typedef {import('../../types.js').Entry} Entry */
/** @typedef {import('../../types.js').FitCurve} FitCurve */
/** @typedef {import('../../types.js').FittedTable} FittedTable */
/** @typedef {'rows' | 'largest_relative_error' | 'bytes'} WishName */
/** @typedef {'constant' | 'linear'} Kind */
/** @typedef {import('../../types.js').FitTo} FitTo */

/** @type {{name: WishName, label: string, unit: string}[]} */
const WISHES = [
  { name: 'rows', label: 'Rows', unit: 'rows' },
  { name: 'largest_relative_error', label: 'Error', unit: '%' },
  { name: 'bytes', label: 'Bytes', unit: 'bytes' },
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
 * @param {Pick<typeof import('../../api.js').api, 'fitTable' | 'fitCurve'>} ask
 * @param {(rows: [number, number][], unit: string) => void} onRows
 */
export function createFitDialog(ask, onRows) {
  /** @type {Design | null} */
  let design = null;
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
    dialogFoot(() => dialog.close(), copy, use),
  );

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
    fit();
    fetchCurve();
  }

  /** @param {FitTo} chosen */
  function choosePlayer(chosen) {
    fitTo = chosen;
    fit();
    fetchCurve();
  }

  /** Show what is wished for, and ask for it. */
  function fit() {
    const { label, unit } = /** @type {typeof WISHES[0]} */ (WISHES.find(({ name }) => name === wish));
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

  const fitNewest = newestWins(async () => {
    const value = wanted[wish];
    if (design === null || !dialog.isOpen()) return;
    if (typeof value !== 'number') {
      show(null, value === '' ? 'Nothing is wished for.' : `“${value}” is not a number.`);
      return;
    }
    const size = wish === 'largest_relative_error' ? value / 100 : value;
    try {
      const requested = { [wish]: size, row_kind: kind, interval_unit: intervalUnit(), fit_to: fitTo };
      show(await ask.fitTable(design, requested));
    } catch (error) {
      show(null, problemOf(error));
    }
  });

  const fetchCurve = newestWins(async () => {
    const [requested, requestedKind, requestedFor] = [design, kind, fitTo];
    if (requested === null || !dialog.isOpen() || presentCurve()) return;
    try {
      const kindOfRow = { row_kind: requestedKind, interval_unit: intervalUnit(), fit_to: requestedFor };
      const curve = await ask.fitCurve(requested, kindOfRow);
      if (requested === design) curves[`${requestedKind} ${requestedFor}`] = curve;
    } catch (error) {
      // Without the curve a size can still be typed; what is wrong with the design the fit says.
      if (!(error instanceof Refusal)) show(null, problemOf(error));
    }
    chart.show(presentCurve(), fitted?.rows ?? 0);
  });

  /** @param {FittedTable | null} shown @param {string} [problem] why there is none */
  function show(shown, problem = '') {
    fitted = shown;
    chart.show(presentCurve(), shown?.rows ?? 0);
    input.setAttribute('aria-invalid', String(shown === null));
    use.disabled = copy.disabled = shown === null;
    use.hidden = kind === 'linear';
    copy.hidden = !use.hidden;
    copy.textContent = 'Copy as C';
    use.textContent = shown === null ? 'Use the rows' : `Use ${shown.rows} row${shown.rows === 1 ? '' : 's'}`;
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
        figure(`${shown.rows} row${shown.rows === 1 ? '' : 's'}`),
        ` · ${formatEntry(shown.bytes)} bytes · largest error `,
        figure(`± ${formatFigures(shown.largest_relative_error * 100, 3)} %`),
      ),
      element('p', { className: 'muted', textContent: floorNote(shown.floor) }),
      ...(kind === 'linear' ? [element('p', { className: 'muted', textContent: LINEAR_NOTE })] : []),
    );
    preview.replaceChildren(rowsPreview(shown, intervalUnit() === 'us' ? 'µs' : 'ticks'));
  }

  /** @param {import('../../types.js').Floor} floor */
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
    if (fitted?.table) onRows(fitted.table.rows, fitted.table.interval_unit);
    else event.preventDefault();
  }

  return {
    /** @param {Design} present */
    open(present) {
      design = present;
      [curves, fitted] = [{}, null];
      chart.show(null, 0);
      const own = methodOf(present.method.name);
      const method = own.plays_table ? methodOf(REFERENCE) : own;
      const speed = formatEntry(present.ramp.slew_speed_steps_per_s);
      about.textContent = `The best rows for the ramp by ${method.label} up to ${speed} steps/s.`;
      dialog.open(input);
      fit();
      fetchCurve();
    },
  };
}

/** @param {FittedTable} fitted @param {string} unit */
function rowsPreview({ table, linear_rows, relative_errors }, unit) {
  const heads = ['#', 'to index', `delay, ${unit}`, ...(linear_rows ? ['each step'] : []), 'error'];
  const rows = (table?.rows ?? linear_rows ?? []).map((row, index) => [
    ...[index + 1, ...row].map(formatEntry),
    `${relative_errors[index] === 0 ? 0 : formatFigures(relative_errors[index] * 100, 3)} %`,
  ]);
  return previewTable(heads, rows);
}

/** @param {unknown} error */
function problemOf(error) {
  if (!(error instanceof Error)) throw error;
  const [rejection] = error instanceof Refusal ? error.rejections : [];
  if (rejection?.field !== 'largest_relative_error') return error.message;
  const percent = Number((Number(rejection.value) * 100).toPrecision(6));
  return `${formatEntry(percent)} % is refused: as a fraction, an error is ${rejection.allowed}.`;
}
