// @ts-check
// The grid of the lookup table: two numbers a row that can be typed, the speed they give, and what is wrong with them.

import { element, icon, messageLine } from '../../dom.js';
import { formatEntry, formatFixed, parseEntry } from '../../numbers.js';

/** @typedef {import('../../types.js').Entry} Entry */
/** @typedef {import('../../design.js').Rows} Rows */

const COLUMNS = ['last step', 'delay'];

/**
 * @param {object} handlers
 * @param {(index: number, column: number, entry: Entry) => void} handlers.onTyped
 * @param {(index: number) => void} handlers.onRemove
 */
export function createGrid({ onTyped, onRemove }) {
  let selected = -1;
  /** Write the rows again, as numbers are written. */
  let settle = () => {};
  const delayHead = element('span');
  const body = element('tbody');

  /** @param {KeyboardEvent} event @param {number} index @param {number} column */
  function walked(event, index, column) {
    const by = { ArrowDown: 1, Enter: 1, ArrowUp: -1 }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    focusCell(index + by, column);
  }

  /** @param {number} index */
  function createRow(index) {
    const inputs = COLUMNS.map((name, column) =>
      element('input', {
        id: `table-${index}-${column}`,
        inputMode: 'numeric',
        autocomplete: 'off',
        spellcheck: false,
        'aria-label': `Row ${index + 1}, ${name}`,
        oninput: (/** @type {Event} */ event) =>
          onTyped(index, column, parseEntry(/** @type {HTMLInputElement} */ (event.target).value)),
        onkeydown: (/** @type {KeyboardEvent} */ event) => walked(event, index, column),
        onblur: () => settle(),
      }),
    );
    const row = element(
      'tr',
      { className: 'row', onclick: () => select(index) },
      element('td', { textContent: String(index + 1) }),
      ...inputs.map((input) => element('td', {}, input)),
      element('td', { className: 'speed' }),
      element(
        'td',
        {},
        element(
          'button',
          {
            className: 'remove',
            type: 'button',
            'aria-label': `Delete row ${index + 1}`,
            title: `Delete row ${index + 1}`,
            onclick: () => onRemove(index),
          },
          icon('remove'),
        ),
      ),
    );
    row.addEventListener('focusin', () => select(index));
    return [row, element('tr', { className: 'row-message', hidden: true }, element('td', { colSpan: 5 }))];
  }

  /** @param {number} index */
  function select(index) {
    selected = index;
    body.querySelectorAll('tr.row').forEach((row, at) => row.classList.toggle('selected', at === index));
  }

  /** @param {number} index @param {number} column */
  function focusCell(index, column) {
    const cell = body.querySelectorAll('tr.row')[index]?.querySelectorAll('input')[column];
    cell?.focus();
    cell?.select();
  }

  /** @param {Rows} rows @param {string} unit @param {(interval: Entry) => number} speedOf NaN where there is none */
  function show(rows, unit, speedOf) {
    settle = () => show(rows, unit, speedOf);
    delayHead.textContent = unit === 'us' ? 'delay, µs' : 'delay, ticks';
    while (body.children.length / 2 > rows.length) body.lastElementChild?.remove();
    while (body.children.length / 2 < rows.length) body.append(...createRow(body.children.length / 2));
    body.querySelectorAll('tr.row').forEach((row, index) => {
      const inputs = row.querySelectorAll('input');
      inputs.forEach((input, column) => {
        const entry = rows[index][column];
        if (document.activeElement !== input || parseEntry(input.value) !== entry) input.value = formatEntry(entry);
      });
      const speed = speedOf(rows[index][1]);
      const cell = /** @type {HTMLElement} */ (row.querySelector('.speed'));
      cell.textContent = Number.isFinite(speed) ? formatFixed(speed, 1) : '–';
    });
  }

  return {
    element: gridOf(body, delayHead),
    show,
    focusCell,
    select,
    /** Index of the row last touched; -1: none. */
    selected: () => Math.min(selected, body.children.length / 2 - 1),
    /** @param {import('../../messages.js').Messages['rows']} rowMessages */
    showMessages(rowMessages) {
      const boxes = body.querySelectorAll('tr.row-message');
      body.querySelectorAll('tr.row').forEach((row, index) => {
        const message = rowMessages.get(index);
        const box = /** @type {HTMLTableRowElement} */ (boxes[index]);
        box.hidden = message === undefined;
        row.querySelectorAll('input').forEach((input, column) => {
          const isMeant = message !== undefined && (message.column ?? column) === column;
          input.setAttribute('aria-invalid', String(isMeant && !message.isWarning));
          if (isMeant) input.setAttribute('aria-describedby', `table-${index}-message`);
          else input.removeAttribute('aria-describedby');
        });
        box.cells[0].replaceChildren(...(message ? [messageLine(message, `table-${index}-message`)] : []));
      });
    },
  };
}

/** @param {HTMLElement} body @param {HTMLElement} delayHead */
function gridOf(body, delayHead) {
  const names = ['#', 'to step', delayHead, 'steps/s', element('span', { className: 'unseen', textContent: 'delete' })];
  const head = element('tr', {}, ...names.map((name) => element('th', { scope: 'col' }, name)));
  const table = element('table', { 'aria-label': 'Rows of the lookup table' }, element('thead', {}, head), body);
  return element('div', { className: 'rows', id: 'table-rows', tabIndex: -1 }, table);
}
