// @ts-check
// The box under the parameters that explains what is pointed at, in focus, or, on a phone, tapped on.

import { element, icon } from '../../ui/dom.js';
import { SHORT } from '../../ui/layouts.js';

/** @typedef {{label: string, formula: string, help: string}} Explanation */

/** @param {Explanation} first */
export function createInfo(first) {
  const head = element('b');
  const text = element('span');
  const close = element(
    'button',
    {
      className: 'close',
      type: 'button',
      'aria-label': 'Close the explanation',
      onclick: () => open(false),
    },
    icon('remove'),
  );
  const box = element('div', { className: 'info', id: 'parameter-info' }, close, head, text);
  show(first);

  /** @param {boolean} isOpen */
  function open(isOpen) {
    box.classList.toggle('open', isOpen);
  }

  /** @param {Explanation} explanation */
  function show({ label, formula, help }) {
    const list = formula.split(', ').map((number) => `(${number})`);
    const formulas = formula === '' ? '' : `formula${list.length > 1 ? 's' : ''} ${list.join(' ')}`;
    head.replaceChildren(label, element('span', { textContent: formulas }));
    text.textContent = help;
  }

  return {
    element: box,
    show,
    /** @param {HTMLElement} part @param {() => Explanation} explanation @param {HTMLElement} [label] */
    explain(part, explanation, label) {
      part.addEventListener('pointerenter', () => show(explanation()));
      part.addEventListener('focusin', () => show(explanation()));
      // A finger points at nothing: there a tap on the name explains, and leaves the keyboard where it is.
      label?.addEventListener('click', (event) => {
        if (!SHORT.matches) return;
        event.preventDefault();
        show(explanation());
        open(true);
      });
    },
  };
}
