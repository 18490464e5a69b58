// @ts-check
// The dialog of the library: designs that the server keeps, searched, opened, saved and compared, what was pushed where, and all
// of it as a file. What is shown is this panel's own; what is in hand knows only which revision it began with.

import { measuredFrom } from '../../devices/traces.js';
import { stallMapCame } from '../../app/commands/answers.js';
import { showMeasured } from '../../app/commands/device.js';
import { tell } from '../../app/commands/told.js';
import { deviceOf } from '../../app/devices.js';
import { isAsLinked, linkOf, mayKeep } from '../../app/library.js';
import { axisOf, designOf, machineOf } from '../../app/selectors.js';
import { whenever } from '../../app/state.js';
import { conflictText, importedText, inHandText, outOfReachText, pinnedText, RECORD_NAMES } from '../../model/library.js';
import { quoted } from '../../model/quoted.js';
import { mapKey } from '../../model/stall_map.js';
import { duplicateOf, MOST_AXES } from '../../model/workbench.js';
import { measuredIn } from '../../plotting/captured.js';
import { CHANGED_MEANWHILE, isForLater, Refusal, ServerGone } from '../../server/api.js';
import { library, MOST_LIBRARY_BYTES } from '../../server/library.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, messageLine, segmented, showText } from '../../ui/dom.js';
import { download } from '../../ui/download.js';
import { createConflict } from './conflict.js';
import { createDetail } from './detail.js';
import { createList } from './list.js';
import { createPushes } from './pushes.js';
import { button } from './rows.js';
import { createSaving } from './saving.js';

/** @typedef {import('../../model/library.js').About} About */
/** @typedef {import('../../model/library.js').Kept} Kept */
/** @typedef {import('../../app/effects/library.js').Mine} Mine */
/** @typedef {import('../../model/library.js').KeptRecord} KeptRecord */
/** @typedef {import('../../model/library.js').KeptWithRevisions} KeptWithRevisions */
/** No move has as many steps, or lasts as many seconds. */
const LARGEST_DRAWN = 1e12;

/** @typedef {'designs' | 'pushes'} Page */
/** What the right side shows.
 * @typedef {'nothing' | 'one' | 'saving' | 'conflict'} Pane */

/** @param {Pick<import('../../app/state.js').Store, 'state' | 'dispatch'>} store
 * @param {import('../../app/effects/library.js').LibraryActions & {openBackups: () => void, openMap: (over: import('../../model/types.js').Over) => void}} act
 * @param {typeof library} [server] */
export function createLibraryPanel({ state, dispatch }, act, server = library) {
  /** @type {Page} */
  let page = 'designs';
  /** @type {KeptWithRevisions | null} */
  let chosen = null;
  /** Which choice is the newest: an answer about another one comes too late. */
  let asked = 0;
  /** How many forms were begun: what was saved before the newest one leaves that as it is. */
  let begun = 0;
  const list = createList({
    search(text, tags) {
      say(''); // What was said of an earlier action.
      return reached(() => server.search(text, tags));
    },
    onChoose: ({ id }) => look(id),
  });
  const saving = createSaving({ saveRevision, saveNew, onCancel: () => back() });
  const detail = createDetail({
    open: (kept, number, where) => told(() => act.openRevision(kept, number, where), `${quoted(kept.name)}, revision ${number}, is in hand now. What it took the place of can be had back by undo and from the menu.`),
    describe,
    duplicate,
    showRecord,
    saveRecord,
    onEdit: beginForm,
    onBack() {
      showPane('nothing');
      handFocus(list.words);
    },
    compare: (kept, one, other) => compared(kept, one, other),
    pin,
    units: () => state().units,
    openPush,
    openBackups: act.openBackups,
  });
  const conflict = createConflict({
    openTheirs: (theirs) => told(() => act.openRevision(theirs, theirs.revisions, 'beside'), 'Theirs is another axis now; mine is the axis before it, and is saved nowhere yet.'),
    look: ({ id }) => look(id),
    saveMine: (mine, theirs, note) => saveRevision(mine, note, theirs),
    saveCopy: (mine, theirs, note) => saveNew(mine, { name: duplicateName(theirs.name), notes: theirs.notes, tags: theirs.tags, note }),
  });
  const pushes = createPushes({
    devices: async () => (await reached(() => server.devices()))?.devices ?? null,
    pushes: (device) => reached(() => server.pushes(device === '' ? {} : { device_id: device })),
    present: () => deviceOf(state()),
    openPush,
    openBackups: act.openBackups,
  });

  const pages = segmented('Shown', /** @type {[Page, string][]} */ ([['designs', 'Designs'], ['pushes', 'Pushes']]), choosePage); // prettier-ignore
  const present = element('p', { className: 'muted library-present', id: 'library-present' });
  const save = element('button', { className: 'button primary', id: 'library-save-design', type: 'button', textContent: 'Save this design …', onclick: beginSaving });
  const trouble = element('div', { className: 'library-trouble', id: 'library-trouble', role: 'alert', hidden: true });
  const note = element('p', { className: 'library-note', id: 'library-note', role: 'status', hidden: true });
  const empty = element('p', { className: 'muted library-empty', textContent: 'Choose a design to see its revisions, or save the one in hand.' });
  const right = element('div', { className: 'library-detail' }, empty, detail.element, saving.element, conflict.element);
  const panes = element('div', { className: 'library-panes', id: 'library-panes' }, list.element, right);
  const upload = element('button', { className: 'button', id: 'library-import', type: 'button', textContent: 'Import a file …', onclick: chooseFile });
  const whole = element('button', { className: 'button', id: 'library-export', type: 'button', textContent: 'Export all', title: 'All designs, revisions, measurements and pushes as one file', onclick: exportAll });
  const dialog = createDialog(
    { id: 'library-dialog', title: 'Library' },
    element('div', { className: 'library-bar' }, pages.element, present, save),
    trouble,
    note,
    panes,
    pushes.element,
    dialogFoot(null, upload, whole),
  );

  // ---- what is asked ----

  /** Ask the library; null: it can't be asked, or said no, which is told then.
   * @template T @param {() => Promise<T>} ask @returns {Promise<T | null>} */
  async function reached(ask) {
    try {
      const answer = await ask();
      trouble.hidden = true;
      return answer;
    } catch (error) {
      if (!(error instanceof Refusal || error instanceof ServerGone)) throw error;
      tellTrouble(error);
      return null;
    }
  }

  /** @param {Refusal | ServerGone} error */
  function tellTrouble(error) {
    const { message } = error;
    const isAway = isForLater(error);
    const again = button('Try again', () => (page === 'pushes' ? pushes.open() : refresh()), { id: 'library-again' });
    trouble.replaceChildren(messageLine({ text: isAway ? outOfReachText(message) : message, isWarning: false }), ...(isAway ? [again] : []));
    trouble.hidden = false;
    say('');
    // Whoever has closed the dialog meanwhile is told, too.
    if (!dialog.isOpen()) dispatch(tell, message, true);
  }

  /** Do something, and say so once it is done.
   * @param {() => Promise<unknown>} ask @param {string} text */
  async function told(ask, text) {
    const done = await reached(async () => {
      await ask();
      return true;
    });
    if (done) say(text);
  }

  /** @param {string} text */
  function say(text) {
    showText(note, text);
    note.hidden = text === '';
    if (text !== '' && !dialog.isOpen()) dispatch(tell, text, false);
  }

  // ---- what is shown ----

  /** @param {Page} wanted */
  function choosePage(wanted) {
    page = wanted;
    pages.press(page);
    panes.hidden = page !== 'designs';
    pushes.element.hidden = page !== 'pushes';
    say('');
    return page === 'pushes' ? pushes.open() : list.find();
  }

  /** @param {Pane} pane */
  function showPane(pane) {
    if (pane !== 'one') {
      asked += 1;
      chosen = null;
      list.choose(null);
    }
    panes.dataset.pane = pane;
    const shown = { nothing: empty, one: detail.element, saving: saving.element, conflict: conflict.element };
    for (const [name, part] of Object.entries(shown)) part.hidden = name !== pane;
  }

  /** The keyboard must not lose its place when what had the focus gives way.
   * @param {HTMLElement | null} next */
  function handFocus(next) {
    const focused = /** @type {HTMLElement | null} */ (document.activeElement);
    if (dialog.isOpen() && focused?.offsetParent === null) next?.focus();
  }

  /** Show a design, with what was measured of it and its pushes.
   * @param {string} id */
  async function look(id) {
    asked += 1;
    const mine = asked;
    say('');
    const found = await reached(async () => {
      const [kept, { records }, { pushes: made }] = await Promise.all([server.design(id), server.records(id), server.pushes({ design_id: id })]);
      return { kept, records, pushes: made };
    });
    if (found === null || mine !== asked) return;
    chosen = found.kept;
    showPane('one');
    list.choose(id);
    detail.show(found, { mayKeep: mayKeep(state()), axes: machineOf(state())?.axes.length ?? 0, mostAxes: MOST_AXES, inHand: numberInHand(id) });
    handFocus(detail.element.querySelector('#library-open'));
  }

  /** Which revision of a design the axis in hand is of; null: none.
   * @param {string} id */
  function numberInHand(id) {
    const linked = linkOf(state());
    return linked?.id === id && isAsLinked(state()) ? linked.number : null;
  }

  async function refresh() {
    await list.find();
    const isTyped = panes.dataset.pane === 'saving' || detail.isEdited();
    if (chosen !== null && !isTyped) await look(chosen.id);
  }

  function back() {
    if (chosen === null) showPane('nothing');
    else showPane('one');
    save.focus();
  }

  function showPresent() {
    const [design, linked] = [designOf(state()), linkOf(state())];
    showText(present, design === null ? '' : inHandText(design.name, linked, isAsLinked(state())));
    save.hidden = upload.hidden = !mayKeep(state());
    save.disabled = design === null;
  }

  // ---- what is done ----

  /** What is still being asked for takes a form from nobody who types into it. */
  function beginForm() {
    begun += 1;
    asked += 1;
  }

  function beginSaving() {
    choosePage('designs');
    beginForm();
    panes.dataset.pane = 'saving';
    for (const part of [empty, detail.element, conflict.element]) part.hidden = true;
    saving.element.hidden = false;
    saving.begin(act.inHand());
  }

  /** @param {string} text @param {Kept} kept @param {number} form how many were begun when it was to be saved */
  async function savedAs(text, kept, form) {
    if (form === begun) saving.end();
    await list.find();
    if (form === begun) await look(kept.id);
    say(text);
  }

  /** @param {Mine} mine @param {About & {note: string}} about */
  async function saveNew(mine, about) {
    const form = begun;
    const kept = await reached(() => act.saveNew(mine, about));
    if (kept) await savedAs(`Saved as ${quoted(kept.name)}, revision 1.`, kept, form);
  }

  /** @param {Mine} mine @param {string} text of the revision @param {Kept} [seen] what somebody else has saved, where that is known */
  async function saveRevision(mine, text, seen) {
    const form = begun;
    const answer = await reached(() => act.saveRevision(mine, text, seen));
    if (answer === null) return;
    if ('kept' in answer) return savedAs(`Saved as revision ${answer.kept.revisions} of ${quoted(answer.kept.name)}.`, answer.kept, form);
    const { linked } = mine;
    if (linked === null) return;
    if (form !== begun) return say(conflictText(answer.conflict, linked));
    showPane('conflict');
    say('');
    conflict.show(mine, answer.conflict, linked, text, (machineOf(state())?.axes.length ?? 0) < MOST_AXES);
    handFocus(conflict.element.querySelector('button'));
  }

  /** @param {KeptWithRevisions} kept @param {About} about */
  async function describe(kept, about) {
    const form = begun;
    try {
      const now = await server.describe(kept.id, kept.version, about);
      act.described(now, kept.version);
      detail.endEdit();
      await savedAs('Saved.', now, form);
    } catch (error) {
      if (!(error instanceof Refusal || error instanceof ServerGone)) throw error;
      if (!(error instanceof Refusal) || error.status !== CHANGED_MEANWHILE || form !== begun) return tellTrouble(error);
      detail.endEdit();
      await look(kept.id);
      if (chosen?.id === kept.id && form === begun) detail.editAgain(chosen, about);
    }
  }

  /** @param {KeptWithRevisions} kept */
  async function duplicate(kept) {
    const form = begun;
    const copy = await reached(() => server.duplicate(kept.id, duplicateName(kept.name)));
    if (copy) await savedAs(`${quoted(copy.name)} is a copy of ${quoted(kept.name)}, and a design of its own.`, copy, form);
  }

  /** @param {KeptWithRevisions} kept @param {number[]} numbers */
  async function pin(kept, numbers) {
    const gone = await reached(async () => {
      const labels = [];
      for (const number of numbers) labels.push(await act.pin(kept, number));
      return labels.flatMap((label) => label ?? []);
    });
    if (gone !== null) say(pinnedText(kept.name, numbers, gone));
  }

  /** @param {KeptWithRevisions} kept @param {number} one @param {number} other */
  async function compared(kept, one, other) {
    return reached(async () => {
      const [{ differences }, before, after] = await Promise.all([
        server.differences(kept.id, one, other),
        server.revision(kept.id, one),
        server.revision(kept.id, other),
      ]);
      return { differences, before: before.design, after: after.design };
    });
  }

  /** @param {import('../../model/library.js').PushTold} push */
  function openPush({ id, device }) {
    return told(() => act.openPush(id), `What was pushed to ${device} is in hand now. What it took the place of can be had back by undo and from the menu.`);
  }

  /** @param {KeptWithRevisions} kept @param {KeptRecord} record */
  async function showRecord(kept, { id, kind, revision }) {
    const found = await reached(async () => {
      const [{ document }, content] = await Promise.all([server.record(kept.id, id), server.revision(kept.id, revision)]);
      return { document, design: act.readDesign(content.design) };
    });
    const axis = axisOf(state());
    if (found === null || axis === null) return;
    const { document, design } = found;
    try {
      return showDocument(kind, document, design, axis, `${RECORD_NAMES[kind]} of ${quoted(kept.name || 'unnamed')}, revision ${revision}`);
    } catch {
      say('It can be downloaded, but not shown: it is not as StepRamp itself answers it.');
    }
  }

  /** @param {KeptRecord['kind']} kind @param {any} document as another program may have made it @param {import('../../model/types.js').Design} design @param {number} axis
   * @param {string} record what it is */
  function showDocument(kind, document, design, axis, record) {
    if (kind === 'capture' && document.move === null) return say('No move was found in that capture: there is nothing to lay over the plots.');
    if (kind !== 'stall_map') {
      const move = kind === 'trace' ? measuredFrom(document) : measuredIn(document.move);
      if (!isDrawable(move)) throw new Error('no move');
      dispatch(showMeasured, { of: { axis: null, design }, move, record });
      return say(`The ${RECORD_NAMES[kind].toLowerCase()} lies over the plots now.`);
    }
    const { over } = document;
    dispatch(tell, `Shown: ${record}. It is grey where the design in hand is another one.`, false);
    dispatch(stallMapCame, axis, over, { key: mapKey(design, over), over, id: null, stage: 'done', waitsFor: '', progress: 1, rejections: [], result: document });
    act.openMap(over);
  }

  /** @param {KeptWithRevisions} kept @param {KeptRecord} record */
  async function saveRecord(kept, { id, kind, revision }) {
    const found = await reached(() => server.record(kept.id, id));
    if (found) download(new Blob([JSON.stringify(found.document)], { type: 'application/json' }), `${kept.name} revision ${revision} ${RECORD_NAMES[kind].toLowerCase()}.json`);
  }

  async function exportAll() {
    const found = await reached(() => server.file());
    if (found === null) return;
    download(found.file, found.name);
    const isTooLarge = found.file.size > MOST_LIBRARY_BYTES;
    say(`All of the library is saved as ${found.name}.${isTooLarge ? ' It is larger than what can be imported again: have the database itself copied, too.' : ''}`);
  }

  function chooseFile() {
    const input = element('input', { type: 'file', accept: '.jsonl', className: 'unseen', tabIndex: -1, id: 'library-file' });
    input.addEventListener('change', () => {
      const file = input.files?.[0];
      input.remove();
      if (file) importFile(file);
    });
    input.addEventListener('cancel', () => input.remove());
    document.body.append(input);
    input.click();
  }

  /** @param {File} file */
  async function importFile(file) {
    say(`${quoted(file.name)} is being added …`);
    const added = await reached(() => server.importFile(file));
    if (added === null) return;
    await list.find();
    say(importedText(added));
  }

  showPane('nothing');
  const shows = [
    whenever((/** @type {import('../../app/state.js').State} */ now) => [designOf(now), linkOf(now), now.devices.role], showPresent),
    whenever((/** @type {import('../../app/state.js').State} */ now) => [now.units], () => dialog.isOpen() && detail.draw()),
    whenever((/** @type {import('../../app/state.js').State} */ now) => [now.devices.link], (now) => {
      if (dialog.isOpen() && now.devices.link === 'there' && !trouble.hidden) refresh();
    }),
  ];
  return {
    open() {
      dialog.open(list.words);
      showPresent();
      return choosePage(page);
    },
    /** @param {import('../../app/state.js').State} now */
    show(now) {
      for (const one of shows) one(now);
    },
  };
}

/** Whether a move can be drawn: any program may have kept anything.
 * @param {{step: number[], time_s: number[]}} move */
const isDrawable = ({ step, time_s: time }) =>
  step.every(Number.isFinite) && time.some(Number.isFinite) && [...step, ...time].every((one) => !(Math.abs(one) >= LARGEST_DRAWN));

/** What a copy is called.
 * @param {string} name */
const duplicateName = (name) => duplicateOf({ axes: [/** @type {any} */ ({ name })], together: 'independent' }).axes[0].name;
