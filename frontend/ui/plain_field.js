// @ts-check
// A field for a number in a unit that is always the same.

import { element } from './dom.js';
import { selectOnFocus } from './select_on_focus.js';
import { formatEntry, parseEntry } from '../model/numbers.js';

/** @param {{id: string, label: string, unit: string, value: string, onChange?: (text: string) => void}} what */
export function plainField({ id, label, unit, value, onChange }) {
  const input = element('input', {
    id,
    value,
    inputMode: 'decimal',
    autocomplete: 'off',
    'aria-label': label,
    onchange: () => onChange?.(input.value),
    onblur: () => {
      input.value = formatEntry(parseEntry(input.value));
    },
  });
  selectOnFocus(input);
  return {
    input,
    /** The number, or the text that is none. */
    value: () => parseEntry(input.value),
    element: element(
      'span',
      { className: 'field grow' },
      input,
      element('span', { className: 'unit', textContent: unit }),
    ),
  };
}
