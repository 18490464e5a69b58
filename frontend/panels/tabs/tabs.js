// @ts-check
// The tabs of the narrow layouts: which of the side panels is in sight.

import { chooseTab } from '../../app/commands/view.js';
import { whenChanged } from '../../app/state.js';
import { element } from '../../ui/dom.js';
import { ONE_PLOT } from '../../ui/layouts.js';
import { watchSkips } from './skips.js';

/** @typedef {import('../../app/state.js').Tab} Tab */

/** @type {[Tab, string][]} */
const TABS = [
  ['parameters', 'Parameters'],
  ['table', 'Table'],
  ['device', 'Device'],
];

/** @param {HTMLElement} root @param {import('../../app/state.js').Dispatch} dispatch */
export function createTabs(root, dispatch) {
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

  /** @param {Tab} name @param {boolean} isGuided the guide is in their place */
  function show(name, isGuided) {
    document.body.dataset.tab = name;
    for (const button of buttons) {
      const isChosen = button.dataset.value === name;
      button.setAttribute('aria-selected', String(isChosen && !isGuided));
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

  /** @param {Tab} name */
  function pick(name) {
    dispatch(chooseTab, name, ONE_PLOT.matches);
  }

  watchSkips(/** @type {HTMLElement} */ (document.getElementById('skips')), (panel) => {
    const tab = TABS.find(([name]) => name === panel);
    if (tab) pick(tab[0]);
  });
  return { show: whenChanged(({ tab, guide }) => [tab, guide.isOpen], show) };
}
