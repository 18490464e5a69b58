// @ts-check
// The form that saves the design in hand: as another revision of the one that it began with, or as a new one.

import { tagsOf } from '../../model/library.js';
import { quoted } from '../../model/quoted.js';
import { element, segmented, showText } from '../../ui/dom.js';
import { nameField, textArea, textField, whileSaving } from './rows.js';

/** @typedef {import('../../model/library.js').About} About */
/** @typedef {import('../../app/effects/library.js').Mine} Mine */

/** @param {{saveRevision: (mine: Mine, note: string) => unknown, saveNew: (mine: Mine, about: About & {note: string}) => unknown,
 *   onCancel: () => void}} act */
export function createSaving({ saveRevision, saveNew, onCancel }) {
  /** @type {'revision' | 'new'} */
  let as = 'new';
  /** What is saved, whatever is in hand by then.
   * @type {Mine | null} */
  let mine = null;
  let isSaved = false;
  const choice = segmented('Save as', /** @type {['revision' | 'new', string][]} */ ([['revision', 'Another revision'], ['new', 'A new design']]), choose); // prettier-ignore
  const heading = element('h3', {});
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
    heading,
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
    choice.element.hidden = !mine?.linked;
    const isNew = as === 'new';
    for (const field of [name, tags, notes]) field.element.hidden = !isNew;
    if (!save.disabled) showText(save, saveText());
    showText(of, isNew ? 'Kept as revision 1 of a design of its own.' : `Kept as the next revision of ${quoted(mine?.linked?.name ?? '')}; those before stay as they are.`);
  }

  const saveText = () => (as === 'new' ? 'Save as new' : 'Save revision');

  /** @param {SubmitEvent} event */
  function submit(event) {
    event.preventDefault();
    if (mine === null) return;
    const [saved, about] = [mine, note.input.value.trim()];
    if (as === 'revision') return whileSaving(save, saveText, () => saveRevision(saved, about));
    if (!name.isGood(saved.design.name ?? '')) return;
    return whileSaving(save, saveText, () => saveNew(saved, { name: name.input.value.trim(), tags: tagsOf(tags.input.value), notes: notes.input.value.trim(), note: about }));
  }

  choose(as);
  return {
    element: form,
    /** @param {Mine} wanted */
    begin(wanted) {
      const { design, linked } = wanted;
      // What was typed, and isn't saved yet, is of the same design.
      const isSame = !isSaved && mine?.axis === wanted.axis && mine.linked?.version === linked?.version && mine.linked?.id === linked?.id;
      [mine, isSaved] = [wanted, false];
      showText(heading, `Save ${quoted(design.name || 'unnamed')}`);
      if (isSame) {
        choose(as);
        (as === 'new' ? name : note).input.focus();
        return;
      }
      name.input.value = design.name ?? '';
      tags.input.value = notes.input.value = note.input.value = '';
      choose(linked === null ? 'new' : 'revision');
      (linked === null ? name : note).input.focus();
    },
    /** What was typed is saved. */
    end() {
      isSaved = true;
    },
  };
}
