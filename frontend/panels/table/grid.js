// @ts-check
// The grid of the lookup table: two numbers a row that can be typed, the speed they give, and what is wrong with them.

import { element, icon, messageLine } from '../../ui/dom.js';
import { formatEntry, formatFigures, parseEntry } from '../../model/numbers.js';

/** @typedef {import('../../model/types.js').Entry} Entry */
/** @typedef {import('../../model/design.js').Rows} Rows */

/** @typedef {import('../../model/messages.js').RowMessage} RowMessage */

const INDEX_HELP =
  'Last ramp index that the row holds for. The first step of a ramp is at index 2, so a row ends with the step before; ' +
  'slowing down, the last step is at index 0.';
const COLUMNS = ['last index', 'delay'];

/**
 * @param {object} handlers
 * @param {(index: number, column: number, entry: Entry) => void} handlers.onTyped
 * @param {(index: number) => void} handlers.onRemove
 * @param {(after: number) => void} handlers.onInsert
 * @param {(index: number) => void} handlers.onSelect
 */
export function createGrid({ onTyped, onRemove, onInsert, onSelect }) {
  let selected = -1;
  /** @type {Map<number, RowMessage>} */
  let messages = new Map();
  /** What is said of rows now, as a text: while a slider moves that is asked many times a second.
   * @type {WeakMap<Element, string>} */
  const said = new WeakMap();
  /** Write the rows again, as numbers are written. */
  let settle = () => {};
  const delayHead = element('span', { textContent: 'delay' });
  const speedHead = element('span', { textContent: 'speed' });
  const body = element('tbody');

  /** Enter and the arrows go along a column, Insert makes a row.
   * @param {KeyboardEvent} event @param {number} index
   * @param {number} column the one after the numbers is that of the buttons */
  function walked(event, index, column) {
    const by = { ArrowDown: 1, Enter: 1, ArrowUp: -1 }[event.key];
    const isButton = column === COLUMNS.length;
    if (event.key === 'Insert') onInsert(index);
    else if (isButton && (event.key === 'Delete' || event.key === 'Backspace')) onRemove(index);
    else if (by !== undefined && !(isButton && event.key === 'Enter')) focusCell(index + by, column);
    else return;
    event.preventDefault();
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
      { className: 'row', onclick: () => choose(index) },
      element('td', {}, icon('warning'), String(index + 1)),
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
            onkeydown: (/** @type {KeyboardEvent} */ event) => walked(event, index, COLUMNS.length),
          },
          icon('remove'),
        ),
      ),
    );
    row.addEventListener('focusin', () => choose(index));
    return [row, element('tr', { className: 'row-message', hidden: true }, element('td', { colSpan: 5 }))];
  }

  /** @param {number} index */
  function choose(index) {
    if (selected === index) return;
    select(index);
    onSelect(index);
  }

  /** @param {number} index -1: none */
  function select(index) {
    selected = index;
    body.querySelectorAll('tr.row').forEach((row, at) => {
      row.classList.toggle('selected', at === index);
      if (at === index) row.scrollIntoView({ block: 'nearest' });
    });
    showMessages();
  }

  /** @param {number} index @param {number} column */
  function focusCell(index, column) {
    const row = body.querySelectorAll('tr.row')[index];
    const cell = /** @type {HTMLElement | undefined} */ (row?.querySelectorAll('input, button')[column]);
    cell?.focus();
    if (cell instanceof HTMLInputElement) cell.select();
  }

  /** @param {Rows} rows @param {string} unit @param {(interval: Entry) => number} speedOf NaN where there is none
   * @param {string} speedUnit that it is in */
  function show(rows, unit, speedOf, speedUnit) {
    // A row that goes lets go of the focus, which settles: not in the midst of this.
    settle = () => {};
    const focused = focusedCell();
    speedHead.textContent = `speed, ${speedUnit}`;
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
      const text = Number.isFinite(speed) ? formatFigures(speed) : '–';
      if (cell.textContent !== text) cell.textContent = text;
    });
    settle = () => show(rows, unit, speedOf, speedUnit);
    if (focused !== null && focused.index >= rows.length && rows.length > 0) focusCell(rows.length - 1, focused.column);
  }

  /** The place of the cell that has the focus; null: none has. */
  function focusedCell() {
    const cell = document.activeElement;
    const row = cell?.closest('tr.row') ?? null;
    if (cell === null || row === null || !body.contains(row)) return null;
    const cells = [...row.querySelectorAll('input, button')];
    return { index: [...body.querySelectorAll('tr.row')].indexOf(row), column: cells.indexOf(cell) };
  }

  function showMessages() {
    const boxes = body.querySelectorAll('tr.row-message');
    body.querySelectorAll('tr.row').forEach((row, index) => {
      const message = messages.get(index);
      const saying = message === undefined ? '' : JSON.stringify([message, index === selected]);
      if ((said.get(row) ?? '') === saying) return;
      said.set(row, saying);
      const box = /** @type {HTMLTableRowElement} */ (boxes[index]);
      // A remark is marked in any case, and told where the row is selected: most rows may have one.
      box.hidden = message === undefined || (message.isRemark === true && index !== selected);
      row.classList.toggle('remarked', message?.isWarning === true);
      /** @type {HTMLElement} */ (row).title = message?.isRemark ? message.text : '';
      row.querySelectorAll('input').forEach((input, column) => {
        const isMeant = message !== undefined && (message.column ?? column) === column;
        input.setAttribute('aria-invalid', String(isMeant && !message.isWarning));
        if (isMeant) input.setAttribute('aria-describedby', `table-${index}-message`);
        else input.removeAttribute('aria-describedby');
      });
      box.cells[0].replaceChildren(...(message ? [messageLine(message, `table-${index}-message`)] : []));
    });
  }

  return {
    element: gridOf(body, delayHead, speedHead),
    show,
    focusCell,
    select,
    /** Index of the row last touched; -1: none. */
    selected: () => Math.min(selected, body.children.length / 2 - 1),
    /** @param {Map<number, RowMessage>} rowMessages */
    showMessages(rowMessages) {
      messages = rowMessages;
      showMessages();
    },
  };
}

/** @param {HTMLElement} body @param {HTMLElement} delayHead @param {HTMLElement} speedHead */
function gridOf(body, delayHead, speedHead) {
  const indexHead = element('abbr', { textContent: 'last index', title: INDEX_HELP });
  const names = ['#', indexHead, delayHead, speedHead, element('span', { className: 'unseen', textContent: 'delete' })];
  const head = element('tr', {}, ...names.map((name) => element('th', { scope: 'col' }, name)));
  const table = element('table', { 'aria-label': 'Rows of the lookup table' }, element('thead', {}, head), body);
  return element('div', { className: 'rows', id: 'table-rows', tabIndex: -1 }, table);
}
