// @ts-check
// What the parts of the library's dialog are made of: buttons, fields, and rows of lists.

import { nameProblem } from '../../model/library.js';
import { element, icon, showMessage } from '../../ui/dom.js';

/** @param {string} text @param {() => void} onclick @param {Record<string, unknown>} [more] */
export const button = (text, onclick, more = {}) =>
  element('button', { className: 'button small', type: 'button', textContent: text, onclick, ...more });

/** @param {Parameters<typeof icon>[0]} drawing @param {string} label @param {() => void} onclick */
export const iconButton = (drawing, label, onclick) =>
  element('button', { className: 'button quiet square small', type: 'button', 'aria-label': label, title: label, onclick }, icon(drawing));

/** A text with its name above it.
 * @param {string} id @param {string} label @param {Record<string, unknown>} [more] */
export function textField(id, label, more = {}) {
  const input = element('input', { id, type: 'text', autocomplete: 'off', spellcheck: false, ...more });
  return { element: labelled(id, label, input), input };
}

/** A design's name. Too long a one is told and not cut.
 * @param {string} id @param {Record<string, unknown>} [more] */
export function nameField(id, more = {}) {
  const { element: field, input } = textField(id, 'Name', more);
  const told = element('div');
  field.append(told);
  return {
    element: field,
    input,
    /** Whether it can be kept; if not, that is shown.
     * @param {string} [own] what it is called if none is typed */
    isGood(own) {
      const problem = nameProblem(input.value, own);
      showMessage(input, told, problem === null ? undefined : { text: problem, isWarning: false });
      if (problem !== null) input.focus();
      return problem === null;
    },
  };
}

/** Do what takes long once, however often it is pressed, and show that it is being done.
 * @param {HTMLButtonElement} button @param {() => string} text what it says once it is done @param {() => unknown} act */
export async function whileSaving(button, text, act) {
  if (button.disabled) return;
  button.disabled = true;
  button.textContent = 'saving …';
  try {
    await act();
  } finally {
    button.disabled = false;
    button.textContent = text();
  }
}

/** @param {string} id @param {string} label @param {Record<string, unknown>} [more] */
export function textArea(id, label, more = {}) {
  const input = element('textarea', { id, rows: 2, ...more });
  return { element: labelled(id, label, input), input };
}

/** @param {string} id @param {string} label @param {HTMLElement} input */
const labelled = (id, label, input) => element('div', { className: 'library-field' }, element('label', { htmlFor: id, textContent: label }), input);

/** A part of the detail with its title; empty, it says so.
 * @param {string} title @param {Node[]} rows @param {string} none
 * @param {'h3' | 'h4'} [level] of its title */
export function section(title, rows, none, level = 'h4') {
  const list = rows.length > 0 ? element('ul', { className: 'library-rows' }, ...rows) : element('p', { className: 'muted', textContent: none });
  return element('section', { className: 'library-section' }, element(level, { textContent: title }), list);
}

/** A row: what it is, what there is to say of it, and what can be done with it.
 * @param {string} what @param {string} said @param {string} when @param {...Node} acts */
export const row = (what, said, when, ...acts) =>
  element(
    'li',
    {},
    element(
      'span',
      { className: 'library-row-text' },
      element('b', { textContent: what }),
      element('span', { className: 'library-said', textContent: said }),
      element('span', { className: 'muted', textContent: when }),
    ),
    element('span', { className: 'library-acts' }, ...acts),
  );

/** @param {string[]} tags */
export const tagList = (tags) => element('span', { className: 'library-tags' }, ...tags.map((tag) => element('span', { className: 'library-tag', textContent: tag })));
