// @ts-check
// One choice of a few words, with its message beneath.

import { valueAt } from '../../model/design.js';
import { element, segmented, showMessage, showText } from '../../ui/dom.js';
import { CHOICES } from '../../model/fields.js';

/** @typedef {import('../../model/types.js').Design} Design */

/**
 * @param {string} path where it stands in the design
 * @param {[string, string][]} values and what each is called
 * @param {(path: string, value: unknown) => void} onEdit
 * @param {string} [usual] what holds where the design has none; empty: nothing does
 */
export function createChoice(path, values, onEdit, usual = values[0][0]) {
  const { label, help } = CHOICES[path];
  const control = segmented(label, values, (value) => onEdit(path, value));
  control.element.classList.add('fill');
  control.element.id = label.toLowerCase().replaceAll(' ', '-');
  control.element.setAttribute('aria-description', help);
  const name = element('span', { textContent: label });
  const box = element('div', { className: 'messages' });
  const note = element('p', { className: 'muted choice-note', hidden: true });
  return {
    explanation: CHOICES[path],
    name,
    element: element('div', { className: 'choice' }, name, control.element, box, note),
    /** @param {Design} design @param {string[]} [offered] */
    show(design, offered) {
      for (const button of control.element.querySelectorAll('button')) {
        button.hidden = offered !== undefined && !offered.includes(button.dataset.value ?? '');
      }
      control.press(valueAt(design, path) ?? usual);
    },
    /** What comes of the choice; empty: nothing to say.
     * @param {string} text */
    showNote(text) {
      note.hidden = text === '';
      showText(note, text);
    },
    /** @param {import('../../model/messages.js').Messages['fields']} messages */
    showMessage: (messages) => showMessage(control.element, box, messages.get(path)),
  };
}
