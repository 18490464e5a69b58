// @ts-check
// The menu of the head of the page: the examples, and where there is no room for buttons, all that they do.

import { element, icon, messageLine } from '../../dom.js';

/** @typedef {import('../../types.js').Example} Example */
/** @typedef {{name: string, act: () => void, button: HTMLButtonElement}} Action */

/**
 * @param {object} handlers
 * @param {(example: Example) => void} handlers.onExample
 * @param {() => void} handlers.onBack
 * @param {[string, () => void][]} actions those that a phone has no room for elsewhere
 */
export function createMenu(handlers, actions) {
  const large = icon('more');
  large.classList.add('large', 'phone-only');
  const arrow = icon('down');
  arrow.classList.add('not-phone');
  const list = element('div', { className: 'menu-list', id: 'menu-list', hidden: true });
  const opener = element(
    'button',
    {
      className: 'button quiet',
      id: 'examples',
      type: 'button',
      'aria-expanded': 'false',
      'aria-controls': 'menu-list',
      onclick: () => open(Boolean(list.hidden)),
    },
    element('span', { className: 'not-phone', textContent: 'Examples' }),
    element('span', { className: 'phone-only unseen', textContent: 'Menu' }),
    arrow,
    large,
  );
  const whole = element('div', { className: 'menu' }, opener, list);
  /** @type {Map<string, HTMLButtonElement>} */
  const items = new Map(actions.map(([name, act]) => [name, item(name, '', act, 'phone-only')]));

  /** @param {boolean} isOpen */
  function open(isOpen) {
    list.hidden = !isOpen;
    opener.setAttribute('aria-expanded', String(isOpen));
    if (isOpen) inReach()[0]?.focus();
  }

  function inReach() {
    return [...list.querySelectorAll('button')].filter((one) => one.offsetParent !== null && !one.disabled);
  }

  /** @param {string} title @param {string} text @param {() => void} onChoose @param {string} [className] */
  function item(title, text, onChoose, className = '') {
    const choose = () => {
      open(false);
      opener.focus();
      onChoose();
    };
    return element(
      'button',
      { type: 'button', className, onclick: choose },
      element('b', { textContent: title }),
      text !== '' && element('span', { textContent: text }),
    );
  }

  whole.addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && !list.hidden) {
      open(false);
      opener.focus();
    }
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step === undefined || list.hidden) return;
    event.preventDefault();
    const there = inReach();
    const at = there.findIndex((one) => one === document.activeElement);
    there[(at + step + there.length) % there.length].focus();
  });
  addEventListener('pointerdown', (event) => {
    if (!list.hidden && event.target instanceof Node && !whole.contains(event.target)) open(false);
  });

  return {
    element: whole,
    opener,
    /** @param {string} name @param {boolean} isPossible */
    enable(name, isPossible) {
      const button = items.get(name);
      if (button) button.disabled = !isPossible;
    },
    /** @param {Example[]} examples @param {string | null} replaced name of the design that can be had back */
    showExamples(examples, replaced) {
      const none = { text: 'The examples come with the server, which does not answer.', isWarning: true };
      const back = item(
        `Back to your “${replaced || 'unnamed'}”`,
        'The design that something else took the place of.',
        handlers.onBack,
      );
      list.replaceChildren(
        element('div', { className: 'menu-actions phone-only' }, ...items.values()),
        element('hr', { className: 'phone-only' }),
        ...examples.map((example) => item(example.title, example.description, () => handlers.onExample(example))),
        ...(examples.length === 0 ? [messageLine(none)] : []),
        ...(replaced === null ? [] : [element('hr'), back]),
      );
    },
  };
}
