// @ts-check
// A number that the guide asks for: its name, its unit, where to find it, and what is wrong with it.

import { valueAt } from '../../model/design.js';
import { GROUPS } from '../../model/fields.js';
import { inUnit } from '../../model/rejection_text.js';
import { factorOf, readEntry, shownEntry, unitOf } from '../../model/shown_entry.js';
import { element, showMessage, showText } from '../../ui/dom.js';
import { selectOnFocus } from '../../ui/select_on_focus.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/units.js').Units} Units */
/** How a number is told: what it is called, its unit, and how many of that one of the design's is.
 * @typedef {{label: string, unit: string, factor: number}} Manner */

const FIELDS = GROUPS.flatMap((group) => group.fields);

/** @param {string} path in the design @param {string} hint where to find it
 * @param {(path: string, value: unknown) => void} onAnswer
 * @param {string} [ending] of its id, where a path is asked for in several ways */
export function createGuideNumber(path, hint, onAnswer, ending = '') {
  const field = /** @type {import('../../model/fields.js').Field} */ (FIELDS.find((one) => one.path === path));
  const id = `guide-${path.replaceAll('.', '-')}${ending}`;
  /** @type {Manner} */
  let manner = { label: field.label, unit: field.unit, factor: 1 };
  const input = element('input', {
    id,
    className: 'number',
    inputMode: 'decimal',
    autocomplete: 'off',
    spellcheck: false,
    oninput: () => onAnswer(path, readEntry(field, input.value, manner.factor).entry),
  });
  selectOnFocus(input);
  const label = element('label', { htmlFor: id });
  const unit = element('span', { className: 'unit' });
  const box = element('div', { className: 'messages' });
  const note = element('p', { className: 'guide-hint', textContent: hint });

  return {
    element: element('div', { className: 'guide-number' }, label, element('span', { className: 'field' }, input, unit), note, box),
    /** @param {Design} design @param {Units} units @param {import('../../model/messages.js').Messages['fields']} messages
     * @param {Partial<Manner>} [told] otherwise than the field is */
    show(design, units, messages, told = {}) {
      manner = { label: field.label, unit: unitOf(units, design, field), factor: factorOf(units, design, field), ...told };
      showText(label, manner.label);
      showText(unit, manner.unit);
      const value = valueAt(design, path);
      // What is being typed stays as it is typed.
      const isHere = document.activeElement === input && readEntry(field, input.value, manner.factor).entry === value;
      if (!isHere) input.value = shownEntry(value, manner.factor);
      const message = messages.get(path);
      const factor = told.factor ?? factorOf(units, message?.design ?? design, field);
      showMessage(input, box, message && inUnit(message, { label: manner.label }, manner.unit, factor));
    },
  };
}
