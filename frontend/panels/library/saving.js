// @ts-check
// The form that saves the design in hand: as another revision of the one that it began with, or as a new one.

import { tagsOf } from '../../model/library.js';
import { quoted } from '../../model/quoted.js';
import { element, segmented, showText } from '../../ui/dom.js';
import { nameField, textArea, textField, whileSaving } from './rows.js';

/** @typedef {import('../../model/library.js').About} About */
/** @typedef {import('../../model/library.js').Link} Link */

/** @param {{saveRevision: (note: string) => unknown, saveNew: (about: About & {note: string}) => unknown, onCancel: () => void}} act */
export function createSaving({ saveRevision, saveNew, onCancel }) {
  /** @type {'revision' | 'new'} */
  let as = 'new';
  /** @type {Link | null} */
  let linked = null;
  let ownName = '';
  const choice = segmented('Save as', /** @type {['revision' | 'new', string][]} */ ([['revision', 'Another revision'], ['new', 'A new design']]), choose); // prettier-ignore
  const of = element('p', { className: 'muted', id: 'library-save-of' });
  const name = nameField('library-save-name');
  const tags = textField('library-save-tags', 'Tags, with commas between', { placeholder: 'x axis, quiet' });
  const notes = textArea('library-save-notes', 'Notes: what is to be known of the design');
  const note = textField('library-save-note', 'Note: what is new in this revision', { maxLength: 1000 });
  const save = element('button', { className: 'button primary', id: 'library-save', type: 'submit' });
  const cancel = element('button', { className: 'button', type: 'button', textContent: 'Cancel', onclick: onCancel });
  const form = element(
    'form',
    { className: 'library-form', id: 'library-saving', onsubmit: submit, noValidate: true },
    element('h3', { textContent: 'Save this design' }),
    choice.element,
    of,
    name.element,
    tags.element,
    notes.element,
    note.element,
    element('div', { className: 'library-foot' }, cancel, save),
  );

  /** @param {'revision' | 'new'} wanted */
  function choose(wanted) {
    as = wanted;
    choice.press(as);
    choice.element.hidden = linked === null;
    const isNew = as === 'new';
    for (const field of [name, tags, notes]) field.element.hidden = !isNew;
    if (!save.disabled) showText(save, saveText());
    showText(of, isNew ? 'Kept as revision 1 of a design of its own.' : `Kept as the next revision of ${quoted(linked?.name ?? '')}; those before stay as they are.`);
  }

  const saveText = () => (as === 'new' ? 'Save as new' : 'Save revision');

  /** @param {SubmitEvent} event */
  function submit(event) {
    event.preventDefault();
    const about = note.input.value.trim();
    if (as === 'revision') return whileSaving(save, saveText, () => saveRevision(about));
    if (!name.isGood(ownName)) return;
    return whileSaving(save, saveText, () => saveNew({ name: name.input.value.trim(), tags: tagsOf(tags.input.value), notes: notes.input.value.trim(), note: about }));
  }

  choose(as);
  return {
    element: form,
    /** @param {Link | null} link what the design in hand began with @param {string} called the design's own name */
    begin(link, called) {
      linked = link;
      ownName = called;
      name.input.value = called;
      tags.input.value = notes.input.value = note.input.value = '';
      choose(link === null ? 'new' : 'revision');
      (link === null ? name : note).input.focus();
    },
  };
}
