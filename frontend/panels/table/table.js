// @ts-check
// The lookup table: rows can be typed, added, deleted and pasted, in µs or in ticks.

import { parseTable } from '../../c_table.js';
import { convertedRows, rowAfter, rowSpeed } from '../../design.js';
import { element, icon, messageLine, picker } from '../../dom.js';
import { createGrid } from './grid.js';
import { createPasteDialog } from './paste_dialog.js';

/** @typedef {import('../../types.js').Design} Design */
/** @typedef {import('../../types.js').Entry} Entry */
/** @typedef {import('../../design.js').Rows} Rows */

/**
 * @param {HTMLElement} root
 * @param {(rows: Rows, unit: string) => void} onEdit
 */
export function createTable(root, onEdit) {
  /** @type {Design | null} */
  let design = null;
  let unit = 'us';
  /** The rows that a paste took the place of. @type {{rows: Rows, unit: string} | null} */
  let replaced = null;
  let note = '';

  const grid = createGrid({ onTyped: typed, onRemove: remove });
  const dialog = createPasteDialog((rows) => replace(rows));
  const units = picker('Unit of the delays', changeUnit);
  units.element.classList.add('quiet');
  units.select.id = 'interval-unit';
  const add = element(
    'button',
    {
      className: 'button quiet square small',
      id: 'add-row',
      type: 'button',
      'aria-label': 'Add a row',
      title: 'Add a row',
      onclick: addRow,
    },
    icon('plus'),
  );
  const paste = element(
    'button',
    {
      className: 'button quiet small',
      id: 'paste-table',
      type: 'button',
      title: 'Paste rows from C or from a sheet',
      onclick: () => dialog.open(),
    },
    icon('paste'),
    'Paste',
  );
  const foot = element('div', { className: 'table-foot' });
  const general = element('div', { className: 'messages' });
  root.replaceChildren(
    element(
      'div',
      { className: 'panel-head' },
      element('h2', { textContent: 'Lookup table' }),
      units.element,
      add,
      paste,
    ),
    general,
    grid.element,
    foot,
  );
  root.addEventListener('paste', pasted);

  /** @returns {Rows} */
  const rows = () => design?.table?.rows ?? [];

  /** @param {Rows} changed */
  function edit(changed) {
    onEdit(changed, unit);
  }

  /** @param {number} index @param {number} column @param {Entry} entry */
  function typed(index, column, entry) {
    const changed = structuredClone(rows());
    changed[index][column] = entry;
    edit(changed);
  }

  function addRow() {
    const after = grid.selected() < 0 ? rows().length - 1 : grid.selected();
    const added = rowAfter(rows(), after, unit, design?.timer.frequency_hz ?? 1e6);
    edit([...rows().slice(0, after + 1), added, ...rows().slice(after + 1)]);
    grid.focusCell(after + 1, 0);
  }

  /** @param {number} index */
  function remove(index) {
    edit(rows().filter((_, at) => at !== index));
    if (rows().length > 0) grid.focusCell(Math.min(index, rows().length - 1), 0);
    else add.focus();
  }

  /** @param {string} wanted */
  function changeUnit(wanted) {
    const { rows: converted, rounded } = convertedRows(rows(), wanted, Number(design?.timer.frequency_hz));
    unit = wanted;
    note =
      rounded > 0
        ? `${rounded} delay${rounded === 1 ? '' : 's'} rounded to whole ${wanted === 'us' ? 'µs' : 'ticks'}`
        : '';
    edit(converted);
  }

  /** @param {Rows} taken */
  function replace(taken) {
    replaced = { rows: rows(), unit };
    note = `${taken.length} row${taken.length === 1 ? '' : 's'} pasted`;
    grid.select(-1);
    edit(taken);
  }

  function putBack() {
    if (replaced === null) return;
    unit = replaced.unit;
    const { rows: before } = replaced;
    [replaced, note] = [null, ''];
    edit(before);
  }

  /** A table pasted anywhere in the panel takes the place of the rows; a lone number stays an ordinary paste.
   * @param {ClipboardEvent} event */
  function pasted(event) {
    const text = event.clipboardData?.getData('text/plain') ?? '';
    if (event.defaultPrevented || !/[{};\t\n]/.test(text.trim())) return;
    event.preventDefault();
    const reading = parseTable(text);
    if (reading.rows === null) dialog.open(text);
    else replace(reading.rows);
  }

  /** @param {Design} shown */
  function show(shown) {
    design = shown;
    unit = design.table?.interval_unit ?? unit;
    units.offer(
      [
        ['us', 'µs'],
        ['ticks', 'ticks'],
      ],
      unit,
    );
    grid.show(rows(), unit, (interval) => rowSpeed(shown, interval, unit));
    showFoot();
  }

  function showFoot() {
    const count = rows().length;
    const summary =
      count === 0
        ? 'No rows: add one, or paste a table from C.'
        : `${count} row${count === 1 ? '' : 's'} · ${count * 4} bytes`;
    foot.replaceChildren(
      element('span', { textContent: [summary, note].filter((text) => text !== '').join(' · ') }),
      ...(replaced === null || replaced.rows.length === 0
        ? []
        : [
            element('button', {
              className: 'button quiet small',
              type: 'button',
              textContent: `Put the ${replaced.rows.length} before back`,
              onclick: putBack,
            }),
          ]),
    );
  }

  return {
    show,
    /** @param {import('../../messages.js').Messages} messages */
    showMessages({ fields, rows: rowMessages }) {
      const whole = fields.get('table');
      general.replaceChildren(...(whole ? [messageLine(whole)] : []));
      grid.showMessages(rowMessages);
    },
    /** Forget what a paste replaced: another design is shown. */
    forget() {
      [replaced, note] = [null, ''];
      grid.select(-1);
    },
  };
}
