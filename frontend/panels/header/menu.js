// @ts-check
// The menu of the head of the page: designs to begin with, those of other tabs, and where there is no room for buttons,
// all that they do.

import { quoted } from '../../model/quoted.js';
import { element, icon, messageLine } from '../../ui/dom.js';

/** @typedef {import('../../model/types.js').Example} Example */
/** @typedef {import('../../app/state.js').OtherTab} OtherTab */
/** @typedef {{name: string, act: () => void, button: HTMLButtonElement}} Action */

/**
 * @param {object} handlers
 * @param {() => void} handlers.onNew
 * @param {() => void} handlers.onDuplicate
 * @param {(example: Example) => void} handlers.onExample
 * @param {(other: OtherTab) => void} handlers.onOther
 * @param {() => void} handlers.onBack
 * @param {[string, () => void][]} actions those that a phone has no room for elsewhere
 * @param {[string, () => void][]} others   those that are nowhere else
 */
export function createMenu(handlers, actions, others) {
  const large = icon('more');
  large.classList.add('large', 'cramped');
  const arrow = icon('down');
  arrow.classList.add('roomy');
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
    element('span', { className: 'roomy', textContent: 'Designs' }),
    element('span', { className: 'cramped unseen', textContent: 'Menu' }),
    arrow,
    large,
  );
  const whole = element('div', { className: 'menu' }, opener, list);
  /** @type {Map<string, HTMLButtonElement>} */
  const items = new Map(actions.map(([name, act]) => [name, item(name, '', act, 'cramped')]));
  const otherItems = others.map(([name, act]) => item(name, '', act));

  const begin = [
    item('New', 'An unnamed design to begin with.', handlers.onNew),
    item('Duplicate', 'A copy of this one to go on with.', handlers.onDuplicate),
  ];

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
    /** @param {Example[]} examples @param {OtherTab[]} others
     * @param {string | null} replaced name of the design that can be had back */
    showDesigns(examples, others, replaced) {
      const none = { text: 'The examples come with the server, which does not answer.', isWarning: true };
      const back = item(
        `Back to your ${quoted(replaced || 'unnamed')}`,
        'The design that something else took the place of.',
        handlers.onBack,
      );
      begin[0].disabled = examples.length === 0;
      list.replaceChildren(
        ...begin,
        element('hr'),
        element('div', { className: 'menu-actions cramped' }, ...items.values()),
        element('hr', { className: 'cramped' }),
        ...otherItems,
        element('hr'),
        ...examples.map((example) => item(example.title, example.description, () => handlers.onExample(example))),
        ...(examples.length === 0 ? [messageLine(none)] : []),
        ...(replaced === null && others.length === 0 ? [] : [element('hr')]),
        ...(replaced === null ? [] : [back]),
        ...others.map((other) => item(quoted(namesOf(other)), placeOf(other), () => handlers.onOther(other))),
      );
    },
  };
}

/** @param {OtherTab} other */
const namesOf = ({ machine }) => machine.axes.map(({ name }) => name || 'unnamed').join(', ');

/** Where a design of another tab is, and since when as it is.
 * @param {OtherTab} other */
function placeOf({ isOpen, at_ms }) {
  const time = new Date(at_ms).toLocaleString('en-GB', { day: 'numeric', month: 'short', hour: '2-digit', minute: '2-digit' });
  const since = at_ms > 0 ? `, last changed ${time}` : '';
  return isOpen ? 'In another tab, which keeps it: a copy opens here.' : `From a tab that was closed${since}.`;
}
