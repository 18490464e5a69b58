// @ts-check
// The tabs of the narrow layouts: which of the side panels is in sight.

import { element } from '../../dom.js';

/** @type {[string, string][]} */
const TABS = [
  ['parameters', 'Parameters'],
  ['table', 'Table'],
  ['device', 'Device'],
];

/** @param {HTMLElement} root @param {(name: string) => void} onChoose */
export function createTabs(root, onChoose) {
  const buttons = TABS.map(([name, label]) =>
    element('button', {
      type: 'button',
      role: 'tab',
      'aria-controls': name,
      'data-value': name,
      textContent: label,
      onclick: () => pick(name),
    }),
  );
  root.replaceChildren(
    element(
      'div',
      { className: 'segmented fill', role: 'tablist', 'aria-label': 'Panels', onkeydown: walk },
      ...buttons,
    ),
  );

  /** @param {string} name */
  function choose(name) {
    document.body.dataset.tab = name;
    for (const button of buttons) {
      const isChosen = button.dataset.value === name;
      button.setAttribute('aria-selected', String(isChosen));
      button.tabIndex = isChosen ? 0 : -1;
    }
  }

  /** @param {KeyboardEvent} event */
  function walk(event) {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (step === undefined) return;
    const next = (TABS.findIndex(([name]) => name === document.body.dataset.tab) + step + TABS.length) % TABS.length;
    pick(TABS[next][0]);
    buttons[next].focus();
  }

  /** @param {string} name */
  function pick(name) {
    choose(name);
    onChoose(name);
  }

  choose('parameters');
}
