// @ts-check
// The lookup table: rows can be typed, added, deleted, fitted, pasted and copied, in µs or in ticks.

import { selectRow } from '../../app/commands/view.js';
import { setTable } from '../../app/commands/work.js';
import { axisOf, designOf, machineOf, messagesOf } from '../../app/selectors.js';
import { whenChanged, whenever } from '../../app/state.js';
import { tableAsC, tableAsCsv } from '../../documents/c_table.js';
import { openTableFile } from '../../documents/files.js';
import { readTables } from '../../documents/table_text.js';
import { Refusal } from '../../server/api.js';
import { copyText } from '../../ui/clipboard.js';
import { conversionProblem, convertedRows, rowAfter, rowSpeed } from '../../model/design.js';
import { textOf } from '../../model/messages.js';
import { methodOf } from '../../model/methods.js';
import { counted } from '../../model/numbers.js';
import { STEPS_AND_SECONDS, shownValue, unitWord } from '../../model/units.js';
import { DELAY_UNITS, rowProblems } from '../../model/table_rows.js';
import { idsOf, tablesOf } from '../../model/workbench.js';
import { element, icon, messageLine, picker } from '../../ui/dom.js';
import { createChecks } from './checks.js';
import { createFitDialog } from './fit_dialog.js';
import { fitKey } from './fits.js';
import { createFoot } from './foot.js';
import { createGrid } from './grid.js';
import { createOrigins } from './origins.js';
import { createPasteDialog } from './paste_dialog.js';
import { createPlayDialog } from './play_dialog.js';
import { createReplaced } from './replaced.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').Entry} Entry */
/** @typedef {import('../../model/design.js').Rows} Rows */
/** @typedef {import('../../model/messages.js').Messages} Messages */

/** Whose table it becomes, and whether it becomes the method as well.
 * @typedef {import('./purpose.js').Purpose} Purpose */

/**
 * @param {HTMLElement} root
 * @param {import('../../app/state.js').Dispatch} dispatch
 * @param {Pick<typeof import('../../server/api.js').api, 'fitTable' | 'fitCurve' | 'checkTable' | 'playTable'>} ask
 */
export function createTable(root, dispatch, ask) {
  /** @type {Design | null} */
  let design = null;
  /** The id of the axis whose table it is. */
  let axis = -1;
  /** All axes.
   * @type {import('../../model/workbench.js').Machine | null} */
  let machine = null;
  /** @type {import('../../model/workbench.js').History | null} */
  let history = null;
  let unit = 'us';
  /** What speeds are shown in. */
  let shownIn = STEPS_AND_SECONDS;
  const replaced = createReplaced();
  let note = '';
  /** The rows and unit that the note is about. */
  let noted = '';
  /** Why something asked of the rows was not done. */
  let problem = '';
  /** What is wrong with the table as a whole.
   * @type {import('../../model/messages.js').Message | undefined} */
  let whole;
  /** What is wrong with rows.
   * @type {Messages['rows']} */
  let rejected = new Map();
  const origins = createOrigins();

  const grid = createGrid({ onTyped: typed, onRemove: remove, onInsert: insert, onSelect: (row) => dispatch(selectRow, row) });
  const dialog = createPasteDialog(
    (rows, pastedUnit, purpose, rounded) => {
      const how = rounded > 0 ? `, ${counted(rounded, 'delay')} rounded to whole ${DELAY_UNITS[pastedUnit]}` : '';
      replace(rows, pastedUnit, `pasted${how}`, purpose);
    },
    openTableFile,
  );
  const fitDialog = createFitDialog(ask, useFit);
  const playDialog = createPlayDialog(ask.playTable);
  const checks = createChecks(ask.checkTable, showRowMessages);
  const units = picker('Unit of the delays', changeUnit);
  units.element.classList.add('quiet');
  units.select.id = 'interval-unit';
  const add = button('add-row', 'Add a row', 'plus', addRow);
  const paste = button('paste-table', 'Paste rows', 'paste', () => openText(''), 'Paste rows from C, CSV or a sheet');
  const fit = element(
    'button',
    {
      className: 'button quiet small',
      id: 'fit-table',
      type: 'button',
      title: 'Find the best rows for the ramp',
      onclick: () => design && fitDialog.open(design, axis),
    },
    icon('fit'),
    'Fit',
  );
  const foot = createFoot({
    simulate: () => design && playDialog.open(design, axis),
    copyC: () => copy(tableAsC, 'C'),
    copyCsv: () => copy(tableAsCsv, 'CSV'),
    refit,
    putBack,
  });
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
    foot.element,
  );
  root.addEventListener('paste', pasted);

  /** @returns {Rows} */
  const rows = () => design?.table?.rows ?? [];

  /** @param {Rows} changed @param {string} [gesture] */
  function edit(changed, gesture) {
    dispatch(setTable, changed, unit, gesture, axis);
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
    problem = conversionProblem(rows(), wanted, design?.timer.frequency_hz ?? '');
    showGeneral();
    if (problem !== '') {
      units.select.value = unit;
      return;
    }
    const { rows: converted, rounded } = convertedRows(rows(), wanted, Number(design?.timer.frequency_hz));
    unit = wanted;
    tell(rounded > 0 ? `${counted(rounded, 'delay')} rounded to whole ${DELAY_UNITS[wanted]}` : '', converted);
    edit(converted);
  }

  /** Other rows for an axis, which is the one in hand or not.
   * @param {Rows} taken @param {string} takenUnit @param {string} how @param {Purpose} purpose */
  function replace(taken, takenUnit, how, purpose) {
    const table = machine?.axes[machine.ids.indexOf(purpose.axis)]?.table;
    replaced.keep(purpose.axis, { rows: table?.rows ?? [], unit: table?.interval_unit ?? takenUnit });
    if (purpose.axis === axis) {
      unit = takenUnit;
      tell(`${counted(taken.length, 'row')} ${how}`, taken);
      dispatch(selectRow, -1);
    }
    dispatch(setTable, taken, takenUnit, undefined, purpose.axis, purpose.asMethod);
  }

  /** @param {import('./fit_dialog.js').Fit} fit @param {Purpose} purpose */
  function useFit({ rows: fitted, unit: fittedUnit, design: of, wish }, purpose) {
    // Each fit notes its rows: those that can't come back are forgotten.
    if (history) origins.prune(tablesOf(history), idsOf(history));
    origins.fitted({ rows: fitted, interval_unit: fittedUnit }, of, wish);
    replace(fitted, fittedUnit, 'fitted', purpose);
  }

  /** Whether the table and the ramp of an axis are those still.
   * @param {Design} of @param {number} at its id */
  function isAsAsked(of, at) {
    const now = machine?.axes[machine.ids.indexOf(at)];
    return now !== undefined && now.table === of.table && fitKey(now) === fitKey(of);
  }

  /** Fit again as the rows were, to the ramp of now. */
  async function refit() {
    const [of, at] = [design, axis];
    const stale = of && origins.staleWish(of);
    if (!of || !stale) return;
    try {
      const { table } = await ask.fitTable(of, stale.wish);
      // Rows or a ramp that came meanwhile are not those that were asked about: the foot offers to fit them.
      if (!isAsAsked(of, at)) return;
      const unitThen = stale.wish.interval_unit;
      if (table) useFit({ rows: table.rows, unit: unitThen, design: of, wish: stale.wish }, { axis: at, asMethod: false });
    } catch (error) {
      if (!(error instanceof Error)) throw error;
      if (at !== axis || !isAsAsked(of, at)) return;
      problem = `The rows were not fitted. ${error instanceof Refusal ? textOf(error.rejections) : error.message}`;
      showGeneral();
    }
  }

  /** @param {(rows: Rows, unit: string) => string} written @param {string} name */
  async function copy(written, name) {
    const copied = JSON.stringify([rows(), unit]);
    const isCopied = await copyText(written(rows(), unit));
    // Of rows that came meanwhile it says nothing.
    if (JSON.stringify([rows(), unit]) !== copied) return;
    tell(isCopied ? `copied as ${name}` : 'the browser does not let the page copy', rows());
    showFoot();
  }

  function putBack() {
    const before = replaced.take(axis);
    if (before === undefined) return;
    unit = before.unit;
    note = '';
    edit(before.rows);
  }

  /** A table pasted anywhere in the panel takes the place of the rows; a lone number stays an ordinary paste. Where there
   * is something to choose or to refuse, it is shown first.
   * @param {ClipboardEvent} event */
  function pasted(event) {
    const text = event.clipboardData?.getData('text/plain') ?? '';
    const isInText = event.target instanceof HTMLTextAreaElement;
    if (event.defaultPrevented || isInText || !/[{};\t\n]/.test(text.trim())) return;
    event.preventDefault();
    const { tables } = readTables(text);
    const [table] = tables ?? [];
    const isMethod = design !== null && methodOf(design.method.name).plays_table;
    const isUsable = table?.rows && rowProblems(table.rows, table.unit ?? unit).length === 0;
    if (!isMethod || tables?.length !== 1 || !isUsable) openText(text);
    else replace(table.rows, table.unit ?? unit, 'pasted', { axis, asMethod: false });
  }

  /** @param {string} text in which there may be tables */
  function openText(text) {
    if (design) dialog.open(design, axis, unit, text);
  }

  /** @param {Design | null} shown @param {number | null} of the axis that it is of
   * @param {import('../../model/units.js').Units} inUnits */
  function showDesign(shown, of, inUnits) {
    if (shown === null || of === null) return;
    checks.check(shown, of);
    // Rows that are shown already stay: sliders of the ramp don't touch them.
    const isSameTable = shown.table === design?.table && shown.timer === design.timer && of === axis;
    const isKnown = isSameTable && shown.axis === design?.axis && inUnits === shownIn;
    shownIn = inUnits;
    origins.shown(shown, of);
    [design, axis] = [shown, of];
    dialog.showAxis(of);
    fitDialog.show(shown, of);
    playDialog.show(shown, of);
    if (!isKnown) showRows(shown);
    showFoot();
  }

  /** @param {Design} shown */
  function showRows(shown) {
    unit = shown.table?.interval_unit ?? unit;
    units.offer(Object.entries(DELAY_UNITS), unit);
    if (noted !== JSON.stringify([rows(), unit])) note = '';
    problem = '';
    showGeneral();
    replaced.shown(axis, { rows: rows(), unit });
    const speedOf = (/** @type {import('../../model/types.js').Entry} */ interval) =>
      shownValue(shownIn, shown, 'speed', rowSpeed(shown, interval, unit));
    grid.show(rows(), unit, speedOf, unitWord(shownIn, shown, 'speed'));
  }

  function showFoot() {
    const stale = design && origins.staleWish(design);
    const change = stale ? (stale.isFit ? 'fitted for another ramp' : 'the ramp has changed since') : '';
    foot.show({
      rows: rows().length,
      note: [note, note !== '' && design && methodOf(design.method.name).plays_table ? 'the method' : '', change].filter((text) => text !== '').join(' · '),
      canRefit: stale !== null,
      replaced: replaced.count(axis),
    });
  }

  function showGeneral() {
    const asked = problem === '' ? [] : [messageLine({ text: problem, isWarning: true })];
    general.replaceChildren(...(whole ? [messageLine(whole)] : []), ...asked);
  }

  /** The remarks of the check beside what is wrong, which comes first. */
  function showRowMessages() {
    grid.showMessages(new Map([...checks.found(), ...rejected]));
  }

  /** @param {Messages} messages */
  function showMessages({ fields, rows: rowMessages }) {
    whole = fields.get('table');
    showGeneral();
    rejected = rowMessages;
    showRowMessages();
  }

  /** @param {import('../../model/workbench.js').Machine | null} shown */
  function showMachine(shown) {
    machine = shown;
    // What was opened for an axis that is gone has nowhere to go.
    for (const one of [dialog, fitDialog, playDialog]) if (!shown?.ids.includes(one.axis())) one.close();
  }

  /** Forget the axes that can't come back.
   * @param {import('../../app/state.js').State} state */
  function forget(state) {
    const ids = state.history === null ? new Set() : idsOf(state.history);
    replaced.prune(ids);
    if (state.history) origins.prune(tablesOf(state.history), ids);
  }

  const shows = [
    whenever(({ opened }) => [opened], forget),
    whenChanged((state) => [state.history], (now) => (history = now)),
    whenChanged((state) => [machineOf(state)], showMachine),
    whenChanged((state) => [designOf(state), axisOf(state), state.units], showDesign),
    whenChanged((state) => [messagesOf(state)], showMessages),
    whenChanged(({ row }) => [row], grid.select),
    whenChanged(({ devices }) => [devices.link], (link) => {
      if (link === 'there') for (const one of [checks, fitDialog, playDialog]) one.again();
    }),
    whenChanged(({ told }) => [told.tableText], (given) => given && openText(given.text)),
  ];

  return {
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      for (const show of shows) show(state);
    },
  };
}

/** @param {string} id @param {string} label @param {'plus' | 'paste'} sign @param {() => void} onclick
 * @param {string} [title] */
function button(id, label, sign, onclick, title = label) {
  const properties = { className: 'button quiet square small', id, type: 'button', 'aria-label': label, title, onclick };
  return element('button', properties, icon(sign));
}
