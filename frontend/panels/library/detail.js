// @ts-check
// One design of the library: what is said of it, its revisions, what was measured of it, and its pushes.

import { RECORD_NAMES, revisionsText, tagsOf, whenText } from '../../model/library.js';
import { isolated, quoted } from '../../model/quoted.js';
import { element, icon, messageLine, picker } from '../../ui/dom.js';
import { createCompare } from './compare.js';
import { pushRow } from './pushes.js';
import { button, iconButton, nameField, row, section, tagList, textArea, textField, whileSaving } from './rows.js';

/** @typedef {import('../../model/library.js').About} About */
/** @typedef {import('../../model/library.js').KeptRecord} KeptRecord */
/** @typedef {import('../../model/library.js').KeptWithRevisions} KeptWithRevisions */
/** @typedef {import('../../model/library.js').PushTold} PushTold */
/** @typedef {import('../../app/effects/library.js').Where} Where */

/** @typedef {{kept: KeptWithRevisions, records: KeptRecord[], pushes: PushTold[]}} Whole */
/** What decides which buttons there are. axes: how many are in hand. inHand: number of the revision that the axis in hand is of.
 * @typedef {{mayKeep: boolean, axes: number, mostAxes: number, inHand: number | null}} Situation */

/** @param {{open: (kept: KeptWithRevisions, number: number, where: Where) => void, describe: (kept: KeptWithRevisions, about: About) => unknown,
 *   duplicate: (kept: KeptWithRevisions) => void, showRecord: (kept: KeptWithRevisions, record: KeptRecord) => void,
 *   saveRecord: (kept: KeptWithRevisions, record: KeptRecord) => void, onEdit: () => void, onBack: () => void}
 *   & Parameters<typeof createCompare>[0] & Parameters<typeof pushRow>[1]} act */
export function createDetail(act) {
  const compare = createCompare(act);
  /** @type {Where} */
  let where = 'all';
  let isEdited = false;
  /** What somebody types of a design, and hasn't saved: it is there again when they come back to it.
   * @type {{id: string, version: number, read: () => About} | null} */
  let draft = null;
  const place = picker('Where designs are opened', (value) => (where = /** @type {Where} */ (value)));
  place.select.id = 'library-where';
  const root = element('div', { className: 'library-one', id: 'library-one' });

  /** @param {Whole} whole @param {Situation} situation */
  function show({ kept, records, pushes }, situation) {
    const { mayKeep, axes, mostAxes } = situation;
    const places = /** @type {[Where, string][]} */ ([
      ['all', axes > 1 ? 'in the place of all axes' : 'in the place of what is in hand'],
      ...(axes > 1 ? [['axis', 'in the place of this axis']] : []),
      ...(axes < mostAxes ? [['beside', 'as another axis']] : []),
    ]);
    if (!places.some(([one]) => one === where)) where = 'all';
    place.offer(places, where);
    compare.show(kept);
    const about = element('div', { className: 'library-about' });
    showAbout(about, kept, mayKeep);
    root.replaceChildren(
      element('button', { className: 'button quiet small library-back', type: 'button', onclick: act.onBack }, icon('left'), 'All designs'),
      about,
      element(
        'div',
        { className: 'library-line library-main' },
        element('button', { className: 'button primary', id: 'library-open', type: 'button', textContent: 'Open', onclick: () => act.open(kept, kept.revisions, where) }),
        place.element,
        element('span', { className: 'grow' }),
        mayKeep && button('Edit', () => edit(about, kept), { id: 'library-edit', title: 'Another name, other notes and tags' }),
        mayKeep && button('Duplicate', () => act.duplicate(kept), { title: 'A copy of the newest revision, as a design of its own' }),
      ),
      section('Revisions', kept.history.map((one) => revisionRow(kept, one, situation.inHand)), ''),
      compare.element,
      section('Measured and computed', records.map((one) => recordRow(kept, one)), 'Traces, captures and stall maps can be kept here from where they are shown.'),
      section('Pushes', pushes.map((one) => pushRow(one, act, true)), 'None of its revisions was pushed to a controller.'),
    );
    if (mayKeep && draft?.id === kept.id) edit(about, kept, draft.read(), draft.version !== kept.version);
  }

  /** @param {HTMLElement} about @param {KeptWithRevisions} kept @param {boolean} mayKeep */
  function showAbout(about, kept, mayKeep) {
    isEdited = false;
    about.replaceChildren(
      element('h3', { textContent: kept.name || 'unnamed', id: 'library-name' }),
      element('p', { className: 'muted', textContent: `${revisionsText(kept.revisions)}, changed last on ${whenText(kept.saved_at)}` }),
      ...(kept.tags.length > 0 ? [tagList(kept.tags)] : []),
      ...(kept.notes !== '' ? [element('p', { className: 'library-notes', textContent: kept.notes })] : []),
    );
    if (!mayKeep) about.append(element('p', { className: 'muted', textContent: 'You look on: designs can be searched and opened, not changed.' }));
  }

  /** @param {HTMLElement} about @param {KeptWithRevisions} kept @param {About} [typed] @param {boolean} [isChanged] by somebody else, meanwhile */
  function edit(about, kept, typed = kept, isChanged = false) {
    isEdited = true;
    act.onEdit();
    const name = nameField('library-edit-name', { value: typed.name });
    const tags = textField('library-edit-tags', 'Tags, with commas between', { value: typed.tags.join(', ') });
    const notes = textArea('library-edit-notes', 'Notes', { value: typed.notes, rows: 3 });
    const theirs = [quoted(kept.name), kept.tags.length > 0 && `tags ${kept.tags.map(isolated).join(', ')}`, kept.notes !== '' && `notes ${quoted(kept.notes)}`].filter((one) => one !== false).join('; ');
    const read = () => ({ name: name.input.value.trim(), tags: tagsOf(tags.input.value), notes: notes.input.value.trim() });
    draft = { id: kept.id, version: kept.version, read };
    const submit = (/** @type {SubmitEvent} */ event) => {
      event.preventDefault();
      if (!name.isGood()) return;
      whileSaving(save, () => 'Save', () => act.describe(kept, read()));
    };
    const save = element('button', { className: 'button small primary', id: 'library-describe', type: 'submit', textContent: 'Save' });
    const back = () => {
      draft = null;
      showAbout(about, kept, true);
      document.getElementById('library-edit')?.focus();
    };
    about.replaceChildren(
      element(
        'form',
        { className: 'library-form', onsubmit: submit, noValidate: true },
        isChanged && messageLine({ text: `Somebody else has changed it meanwhile: ${theirs}. Nothing was overwritten; save yours over that, or cancel.`, isWarning: true }),
        name.element,
        tags.element,
        notes.element,
        element('div', { className: 'library-foot' }, button('Cancel', back), save),
      ),
    );
    name.input.focus();
  }

  /** @param {KeptWithRevisions} kept @param {import('../../model/library.js').Revision} revision @param {number | null} inHand */
  function revisionRow(kept, { number, note, saved_at: at }, inHand) {
    return row(
      `Revision ${number}`,
      note,
      `${whenText(at)}${number === inHand ? ' · in hand' : ''}`,
      iconButton('pin', `Pin revision ${number}: draw it into the plots`, () => act.pin(kept, [number])),
      button('Open', () => act.open(kept, number, where), { 'aria-label': `Open revision ${number}` }),
    );
  }

  /** @param {KeptWithRevisions} kept @param {KeptRecord} record */
  function recordRow(kept, record) {
    const what = RECORD_NAMES[record.kind];
    const named = `${what.toLowerCase()} of revision ${record.revision}`;
    return row(
      `${what}, revision ${record.revision}`,
      record.note,
      whenText(record.kept_at),
      iconButton('export', `Download the ${named}`, () => act.saveRecord(kept, record)),
      button('Show', () => act.showRecord(kept, record), { 'aria-label': `Show the ${named}` }),
    );
  }

  return {
    element: root,
    show,
    draw: compare.draw,
    isEdited: () => isEdited,
    /** What somebody typed is offered again, beside what somebody else has made of it.
     * @param {KeptWithRevisions} kept @param {About} typed */
    editAgain(kept, typed) {
      const about = root.querySelector('.library-about');
      if (about instanceof HTMLElement) edit(about, kept, typed, true);
    },
    /** What was typed is saved, or is offered again. */
    endEdit() {
      draft = null;
    },
  };
}
