// @ts-check
// What is refused of what was answered in steps before, with a way to each.

import { element, messageLine } from '../../ui/dom.js';

/** What is refused, and the button that leads to where it is corrected.
 * @typedef {{text: string, button: string, act: () => void}} Refused */

export function createRefused() {
  const box = element('div', { className: 'guide-problem', role: 'status' });
  let shown = '';
  return {
    element: box,
    /** @param {Refused[]} list */
    show(list) {
      const told = JSON.stringify(list);
      if (told === shown) return;
      shown = told;
      box.replaceChildren(...list.flatMap(({ text, button, act }) => [messageLine({ text, isWarning: false }), wayButton(button, act)]));
    },
  };
}

/** @param {string} textContent @param {() => void} onclick */
const wayButton = (textContent, onclick) => element('button', { className: 'button small', type: 'button', textContent, onclick });
