// @ts-check
// The dialog for pasting a table: the text, what was understood of it, and only then the rows.

import { parseTable } from '../../c_table.js';
import { createDialog, dialogFoot } from '../../dialog.js';
import { element, messageLine } from '../../dom.js';
import { formatEntry } from '../../numbers.js';
import { previewTable } from './preview_table.js';

const EXAMPLE = 'unsigned short accelTable[][2] = {\n  { 10, 5000 },\n  { 30, 1500 }\n};';
const UNIT_WORDS = { us: 'µs', ticks: 'ticks' };

/** @param {(rows: [number, number][], unit: 'us' | 'ticks' | undefined) => void} onRows  the unit, if the text has one */
export function createPasteDialog(onRows) {
  const text = element('textarea', {
    id: 'paste-text',
    'aria-describedby': 'paste-preview',
    rows: 9,
    spellcheck: false,
    placeholder: EXAMPLE,
    oninput: preview,
  });
  const shown = element('div', { className: 'preview', id: 'paste-preview', 'aria-live': 'polite' });
  const use = element('button', { className: 'button primary', type: 'submit', textContent: 'Use the rows' });
  const dialog = createDialog(
    { id: 'paste-dialog', title: 'Paste a lookup table', onSubmit: submitted },
    element('label', {
      htmlFor: 'paste-text',
      textContent:
        'A C initialiser, whole or in part, or CSV or cells of a sheet: last index and delay, with or without a heading.',
    }),
    text,
    shown,
    dialogFoot(() => dialog.close(), use),
  );

  function preview() {
    const { rows, problem, unit } = parseTable(text.value);
    use.disabled = rows === null;
    use.textContent = rows === null ? 'Use the rows' : `Use ${rows.length} row${rows.length === 1 ? '' : 's'}`;
    if (rows === null) {
      const isEmpty = text.value.trim() === '';
      shown.replaceChildren(
        isEmpty
          ? element('p', { className: 'muted', textContent: 'The rows found are shown here.' })
          : messageLine({ text: problem, isWarning: false }),
      );
      return;
    }
    const lines = rows.map((row, index) => [index + 1, ...row].map(formatEntry));
    shown.replaceChildren(previewTable(['#', 'to index', unit ? `delay, ${UNIT_WORDS[unit]}` : 'delay'], lines));
  }

  /** @param {SubmitEvent} event */
  function submitted(event) {
    const { rows, unit } = parseTable(text.value);
    if (rows === null) event.preventDefault();
    else onRows(rows, unit);
  }

  return {
    /** @param {string} [pasted] text to begin with */
    open(pasted = '') {
      text.value = pasted;
      preview();
      dialog.open(text);
    },
  };
}
