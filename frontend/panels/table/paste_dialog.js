// @ts-check
// The dialog for tables that come as text, pasted or from a file: the text, what was understood of it, and only then the
// rows.

import { TABLE_FILES } from '../../documents/kinds.js';
import { readTables } from '../../documents/table_text.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, messageLine } from '../../ui/dom.js';
import { counted, formatEntry } from '../../model/numbers.js';
import { DELAY_UNITS, roundedRows, rowProblems } from '../../model/table_rows.js';
import { previewTable } from './preview_table.js';
import { createPurpose } from './purpose.js';

/** @typedef {import('../../documents/table_text.js').Table} Table */
/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('./purpose.js').Purpose} Purpose */

const EXAMPLE = 'unsigned short accelTable[][2] = {\n  { 10, 5000 },\n  { 30, 1500 }\n};';
/** So many refused numbers are told one by one. */
const MOST_TOLD = 5;

/**
 * @param {(rows: [number, number][], unit: string, purpose: Purpose, rounded: number) => void} onRows
 *   rounded: how many of the delays are, as it was asked for
 * @param {(onText: (text: string) => void, onProblem: (problem: string) => void) => void} chooseFile
 */
export function createPasteDialog(onRows, chooseFile) {
  /** @type {Table[]} */
  let tables = [];
  /** Index of the table to use. */
  let chosen = 0;
  /** The unit of delays where the text has none. */
  let ownUnit = 'us';

  const text = element('textarea', {
    id: 'paste-text',
    'aria-describedby': 'paste-preview',
    rows: 9,
    spellcheck: false,
    placeholder: EXAMPLE,
    oninput: read,
  });
  const choice = element('div', { className: 'table-choice', role: 'radiogroup', 'aria-label': 'Table', hidden: true });
  const shown = element('div', { className: 'preview', id: 'paste-preview', 'aria-live': 'polite' });
  const round = element('input', { type: 'checkbox', id: 'paste-round', onchange: () => showChosen() });
  const roundWords = element('span');
  const rounding = element('label', { className: 'as-method', htmlFor: round.id, hidden: true }, round, roundWords);
  const purpose = createPurpose('paste');
  const use = element('button', { className: 'button primary', type: 'submit', textContent: 'Use the rows' });
  const file = element('button', {
    className: 'button',
    type: 'button',
    textContent: 'Open a file…',
    title: `C or CSV: ${TABLE_FILES.join(', ')}`,
    onclick: () => chooseFile(put, showProblem),
  });
  const dialog = createDialog(
    { id: 'paste-dialog', title: 'Paste a lookup table', onSubmit: submitted },
    element('label', {
      htmlFor: 'paste-text',
      textContent:
        'C, an initialiser or a whole file, CSV, or cells of a sheet: last index and delay, with or without a heading.',
    }),
    text,
    choice,
    shown,
    rounding,
    purpose.element,
    dialogFoot(() => dialog.close(), file, use),
  );

  /** @param {string} given */
  function put(given) {
    text.value = given;
    read();
  }

  function read() {
    const reading = readTables(text.value);
    tables = reading.tables ?? [];
    if (tables[chosen]?.rows == null) {
      chosen = Math.max(
        0,
        tables.findIndex((table) => table.rows !== null),
      );
    }
    showChoice();
    if (reading.tables !== null) showChosen();
    else if (text.value.trim() !== '') showProblem(reading.problem);
    else {
      showNone();
      shown.replaceChildren(element('p', { className: 'muted', textContent: 'The rows found are shown here.' }));
    }
  }

  /** Where there are several, one of them: by its name, its size and its ends. */
  function showChoice() {
    choice.hidden = tables.length < 2;
    choice.replaceChildren(...(choice.hidden ? [] : tables.map(choiceOf)));
  }

  /** @param {Table} table @param {number} index */
  function choiceOf({ name, line, rows, problem }, index) {
    const ends = [rows?.[0], rows?.at(-1)].map((row) => row?.map(formatEntry).join(', '));
    const about = rows === null ? problem : `${counted(rows.length, 'row')}, from {${ends[0]}} to {${ends[1]}}`;
    const radio = element('input', {
      type: 'radio',
      name: 'paste-table-choice',
      checked: index === chosen,
      disabled: rows === null,
      onchange: () => {
        chosen = index;
        showChosen();
      },
    });
    const words = element('span', { className: 'muted', textContent: `line ${line}: ${about}` });
    return element('label', {}, radio, element('b', { textContent: name }), words);
  }

  function showChosen() {
    const { rows, unit = ownUnit, problem } = tables[chosen];
    if (rows === null) return showProblem(problem);
    const { rounded } = roundedRows(rows);
    rounding.hidden = rounded === 0;
    roundWords.textContent = `Round ${counted(rounded, 'delay')} to whole ${DELAY_UNITS[unit]}`;
    const meant = meantRows(rows);
    const problems = rowProblems(meant, unit);
    use.disabled = problems.length > 0;
    use.textContent = `Use ${counted(rows.length, 'row')}`;
    const lines = meant.map((row, index) => [index + 1, ...row].map(formatEntry));
    const heads = ['#', 'last index', `delay, ${DELAY_UNITS[unit]}`];
    shown.replaceChildren(...refused(problems), previewTable(heads, lines));
  }

  /** The rows as they would be used: nothing is rounded unasked.
   * @param {[number, number][]} rows */
  const meantRows = (rows) => (round.checked ? roundedRows(rows).rows : rows);

  function showNone() {
    use.disabled = rounding.hidden = true;
    use.textContent = 'Use the rows';
  }

  /** @param {string} problem */
  function showProblem(problem) {
    showNone();
    shown.replaceChildren(messageLine({ text: problem, isWarning: false }));
  }

  /** @param {SubmitEvent} event */
  function submitted(event) {
    const [table, meant] = [tables[chosen], purpose.purpose()];
    if (use.disabled || !table?.rows || meant === null) event.preventDefault();
    else onRows(meantRows(table.rows), table.unit ?? ownUnit, meant, round.checked ? roundedRows(table.rows).rounded : 0);
  }

  return {
    /** @param {Design} design @param {number} axis @param {string} unit of the delays where the text names none
     * @param {string} [given] text to begin with */
    open(design, axis, unit, given = '') {
      [ownUnit, chosen, round.checked] = [unit, 0, false];
      purpose.open(design, axis);
      put(given);
      dialog.open(given === '' || use.disabled ? text : use);
    },
    showAxis: purpose.show,
    axis: purpose.axis,
    close: dialog.close,
  };
}

/** What the table would refuse, the first of it in full.
 * @param {string[]} problems */
function refused(problems) {
  const more = problems.length - MOST_TOLD;
  const told = [...problems.slice(0, MOST_TOLD), ...(more > 0 ? [`${counted(more, 'more number')} can’t be used.`] : [])];
  return told.map((text) => messageLine({ text, isWarning: false }));
}
