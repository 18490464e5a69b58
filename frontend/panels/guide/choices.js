// @ts-check
// A few answers to choose one of, each with a line about it where it needs one.

import { element } from '../../ui/dom.js';

/** @template {string} Value
 * @param {string} name of the group @param {string} label
 * @param {[Value, {label: string, help?: string}][]} choices @param {(value: Value) => void} onChoose */
export function createChoices(name, label, choices, onChoose) {
  const inputs = choices.map(([value, { help }]) =>
    element('input', {
      type: 'radio',
      name,
      value,
      'aria-labelledby': `${name}-${value}`,
      'aria-describedby': help ? `${name}-${value}-help` : null,
      onchange: () => onChoose(value),
    }),
  );
  const items = choices.map(([value, choice], at) => {
    const called = element('b', { id: `${name}-${value}`, textContent: choice.label });
    const help = choice.help ? element('small', { id: `${name}-${value}-help`, textContent: choice.help }) : null;
    return element('label', { className: 'guide-choice' }, inputs[at], element('span', {}, called, help));
  });
  const title = element('legend', { textContent: label });
  return {
    element: element('fieldset', { className: 'guide-choices', id: name }, title, ...items),
    /** @param {Value | null} value */
    press(value) {
      for (const input of inputs) input.checked = input.value === value;
    },
  };
}
