// @ts-check
// The lookup table: rows can be typed, added, deleted, fitted, pasted and copied, in µs or in ticks.

import { parseTable, tableAsC, tableAsCsv } from '../../c_table.js';
import { copyText } from '../../clipboard.js';
import { convertedRows, rowAfter, rowSpeed } from '../../design.js';
import { element, icon, messageLine, picker } from '../../dom.js';
import { createChecks } from './checks.js';
import { createFitDialog } from './fit_dialog.js';
import { createGrid } from './grid.js';
import { createPasteDialog } from './paste_dialog.js';
import { createPlayDialog } from './play_dialog.js';

/** @typedef {import('../../types.js').Design} Design */
/** @typedef {import('../../types.js').Entry} Entry */
/** @typedef {import('../../design.js').Rows} Rows */
/** @typedef {import('../../messages.js').Messages} Messages */

const BYTES_PER_ROW = 4;

/**
 * @param {HTMLElement} root
 * @param {object} handlers
 * @param {(rows: Rows, unit: string, gesture?: string) => void} handlers.onEdit  edits with the same gesture are one
 * @param {(row: number) => void} handlers.onSelect
 * @param {Pick<typeof import('../../api.js').api, 'fitTable' | 'fitCurve' | 'checkTable' | 'playTable'>} handlers.ask
 */
export function createTable(root, { onEdit, onSelect, ask }) {
  /** @type {Design | null} */
  let design = null;
  let unit = 'us';
  /** The rows that a paste took the place of.
   * @type {{rows: Rows, unit: string} | null} */
  let replaced = null;
  let note = '';
  /** The rows and unit that the note is about. */
  let noted = '';
  /** What is wrong with the design as a whole.
   * @type {Messages['rows']} */
  let rejected = new Map();

  const grid = createGrid({ onTyped: typed, onRemove: remove, onInsert: insert, onSelect });
  const dialog = createPasteDialog((rows, pastedUnit) => replace(rows, 'pasted', pastedUnit ?? unit));
  const fitDialog = createFitDialog(ask, (rows, fittedUnit) => replace(rows, 'fitted', fittedUnit));
  const playDialog = createPlayDialog(ask.playTable);
  const checks = createChecks(ask.checkTable, showRowMessages);
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
      className: 'button quiet square small',
      id: 'paste-table',
      type: 'button',
      'aria-label': 'Paste rows',
      title: 'Paste rows from C, CSV or a sheet',
      onclick: () => dialog.open(),
    },
    icon('paste'),
  );
  const fit = element(
    'button',
    {
      className: 'button quiet small',
      id: 'fit-table',
      type: 'button',
      title: 'Find the best rows for the ramp',
      onclick: () => design && fitDialog.open(design),
    },
    icon('fit'),
    'Fit',
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
      fit,
    ),
    general,
    grid.element,
    foot,
  );
  root.addEventListener('paste', pasted);

  /** @returns {Rows} */
  const rows = () => design?.table?.rows ?? [];

  /** @param {Rows} changed @param {string} [gesture] */
  function edit(changed, gesture) {
    onEdit(changed, unit, gesture);
  }

  /** @param {number} index @param {number} column @param {Entry} entry */
  function typed(index, column, entry) {
    const changed = structuredClone(rows());
    changed[index][column] = entry;
    edit(changed, `row:${index}.${column}`);
  }

  function addRow() {
    insert(grid.selected() < 0 ? rows().length - 1 : grid.selected());
  }

  /** A new row after another; after -1 the first.
   * @param {number} after */
  function insert(after) {
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

  /** Say something of the rows, for as long as they are the same.
   * @param {string} text @param {Rows} about */
  function tell(text, about) {
    [note, noted] = [text, JSON.stringify([about, unit])];
  }

  /** @param {string} wanted */
  function changeUnit(wanted) {
    const { rows: converted, rounded } = convertedRows(rows(), wanted, Number(design?.timer.frequency_hz));
    unit = wanted;
    const whole = wanted === 'us' ? 'µs' : 'ticks';
    tell(rounded > 0 ? `${rounded} delay${rounded === 1 ? '' : 's'} rounded to whole ${whole}` : '', converted);
    edit(converted);
  }

  /** @param {Rows} taken @param {string} how @param {string} [takenUnit] */
  function replace(taken, how, takenUnit = unit) {
    replaced = { rows: rows(), unit };
    unit = takenUnit;
    tell(`${counted(taken.length)} ${how}`, taken);
    select(-1);
    edit(taken);
  }

  /** @param {number} index */
  function select(index) {
    grid.select(index);
    onSelect(index);
  }

  /** @param {(rows: Rows, unit: string) => string} written @param {string} name */
  async function copy(written, name) {
    const isCopied = await copyText(written(rows(), unit));
    tell(isCopied ? `copied as ${name}` : 'the browser does not let the page copy', rows());
    showFoot();
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
    else replace(reading.rows, 'pasted', reading.unit ?? unit);
  }

  /** @param {Design} shown */
  function show(shown) {
    checks.check(shown);
    // Rows that are shown already stay: sliders of the ramp don't touch them.
    const isKnown = shown.table === design?.table && shown.timer === design.timer;
    design = shown;
    if (isKnown) return;
    unit = design.table?.interval_unit ?? unit;
    units.offer(
      [
        ['us', 'µs'],
        ['ticks', 'ticks'],
      ],
      unit,
    );
    if (noted !== JSON.stringify([rows(), unit])) note = '';
    // Undone: there is nothing to put back any more.
    if (replaced && JSON.stringify(replaced) === JSON.stringify({ rows: rows(), unit })) replaced = null;
    grid.show(rows(), unit, (interval) => rowSpeed(shown, interval, unit));
    showFoot();
  }

  function showFoot() {
    const count = rows().length;
    const summary =
      count === 0
        ? 'No rows: add one, fit them, or paste a table.'
        : `${counted(count)} · ${count * BYTES_PER_ROW} bytes`;
    const told = element('span', {
      className: 'grow',
      role: 'status',
      textContent: [summary, note].filter((text) => text !== '').join(' · '),
    });
    foot.replaceChildren(
      told,
      ...(replaced === null || replaced.rows.length === 0
        ? []
        : [footButton(`Put the ${replaced.rows.length} before back`, 'Put the rows before back', putBack)]),
      ...(count === 0
        ? []
        : [
            footButton(
              'Play',
              'See what a gauge does when its target changes in flight',
              () => design && playDialog.open(design),
            ),
            footButton('C', 'Copy the rows as C', () => copy(tableAsC, 'C'), icon('copy')),
            footButton('CSV', 'Copy the rows as CSV', () => copy(tableAsCsv, 'CSV'), icon('copy')),
          ]),
    );
  }

  /** The remarks of the check beside what is wrong, which comes first. */
  function showRowMessages() {
    grid.showMessages(new Map([...checks.found(), ...rejected]));
  }

  return {
    show,
    /** @param {Messages} messages */
    showMessages({ fields, rows: rowMessages }) {
      const whole = fields.get('table');
      general.replaceChildren(...(whole ? [messageLine(whole)] : []));
      rejected = rowMessages;
      showRowMessages();
    },
    /** @param {number} index of the row selected in the plot */
    select: (index) => grid.select(index),
    /** Forget what a paste replaced: another design is shown. */
    forget() {
      [replaced, note] = [null, ''];
      select(-1);
    },
  };
}

/** @param {number} count */
function counted(count) {
  return `${count} row${count === 1 ? '' : 's'}`;
}

/** @param {string} text @param {string} title @param {() => void} onclick @param {...Node} before */
function footButton(text, title, onclick, ...before) {
  const isPlain = before.length === 0;
  const label = isPlain ? {} : { 'aria-label': title };
  return element(
    'button',
    { className: 'button quiet small', type: 'button', title, ...label, onclick },
    ...before,
    text,
  );
}
