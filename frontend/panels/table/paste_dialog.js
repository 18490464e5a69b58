// @ts-check
// The dialog for pasting a table: the text, what was understood of it, and only then the rows.

import { parseTable } from '../../c_table.js';
import { element, icon, messageLine } from '../../dom.js';
import { formatEntry } from '../../numbers.js';

const EXAMPLE = 'unsigned short accelTable[][2] = {\n  { 10, 5000 },\n  { 30, 1500 }\n};';

/** @param {(rows: [number, number][]) => void} onRows */
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
  const cancel = element('button', {
    className: 'button',
    type: 'button',
    textContent: 'Cancel',
    onclick: () => dialog.close(),
  });
  const dialog = element(
    'dialog',
    { className: 'paste-dialog', id: 'paste-dialog', 'aria-labelledby': 'paste-title' },
    element(
      'form',
      { method: 'dialog', onsubmit: submitted },
      element(
        'div',
        { className: 'dialog-head' },
        element('h2', { id: 'paste-title', textContent: 'Paste a lookup table' }),
        element(
          'button',
          {
            className: 'button quiet square small',
            type: 'button',
            'aria-label': 'Close',
            onclick: () => dialog.close(),
          },
          icon('remove'),
        ),
      ),
      element('label', {
        htmlFor: 'paste-text',
        textContent: 'A C initialiser, whole or in part, or two numbers a line: last step, delay.',
      }),
      text,
      shown,
      element('div', { className: 'dialog-foot' }, cancel, use),
    ),
  );
  dialog.addEventListener('keydown', (event) => {
    if (event.key === 'Escape') dialog.close();
  });
  dialog.addEventListener('close', () => opener?.focus());
  document.body.append(dialog);

  function preview() {
    const { rows, problem } = parseTable(text.value);
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
    const lines = rows.map(([step, interval], index) =>
      element(
        'tr',
        {},
        ...[String(index + 1), formatEntry(step), formatEntry(interval)].map((cell) =>
          element('td', { textContent: cell }),
        ),
      ),
    );
    shown.replaceChildren(
      element(
        'table',
        {},
        element(
          'thead',
          {},
          element(
            'tr',
            {},
            ...['#', 'to step', 'delay'].map((name) => element('th', { scope: 'col', textContent: name })),
          ),
        ),
        element('tbody', {}, ...lines),
      ),
    );
  }

  /** What had the focus before, and gets it back. @type {HTMLElement | null} */
  let opener = null;

  /** @param {SubmitEvent} event */
  function submitted(event) {
    const { rows } = parseTable(text.value);
    if (rows === null) event.preventDefault();
    else onRows(rows);
  }

  return {
    /** @param {string} [pasted] text to begin with */
    open(pasted = '') {
      opener = /** @type {HTMLElement | null} */ (document.activeElement);
      text.value = pasted;
      preview();
      dialog.show();
      text.focus();
    },
  };
}
