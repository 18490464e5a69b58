// @ts-check
// The axes of one machine: a tab each, one in hand, and whether they move each by itself or along a line.

import { element, icon, segmented } from '../../dom.js';
import { MOST_AXES } from '../../workbench.js';

/** @typedef {import('../../workbench.js').State} State */
/** @typedef {import('../../workbench.js').Together} Together */

/**
 * @param {HTMLElement} root
 * @param {object} handlers
 * @param {(axis: number) => void} handlers.onChoose
 * @param {() => void} handlers.onAdd
 * @param {(axis: number) => void} handlers.onRemove
 * @param {(together: Together) => void} handlers.onTogether
 * @param {(all: boolean) => void} handlers.onAll whether the plots show all axes or the one in hand
 */
export function createAxes(root, { onChoose, onAdd, onRemove, onTogether, onAll }) {
  const list = element('div', { className: 'axis-tabs', role: 'tablist', 'aria-label': 'Axes', onkeydown: walked });
  const add = element(
    'button',
    {
      className: 'button quiet square',
      id: 'add-axis',
      type: 'button',
      'aria-label': 'Add an axis',
      title: 'Another axis of the same machine, up to four',
      onclick: onAdd,
    },
    icon('plus'),
  );
  const together = segmented(
    'How the axes move',
    /** @type {[Together, string][]} */ ([
      ['independent', 'Each by itself'],
      ['line', 'Along a line'],
    ]),
    onTogether,
  );
  together.element.id = 'together-choice';
  const all = segmented(
    'Plots of',
    /** @type {['one' | 'all', string][]} */ ([
      ['one', 'This axis'],
      ['all', 'All axes'],
    ]),
    (value) => onAll(value === 'all'),
  );
  all.element.id = 'axes-choice';
  const several = element('span', { className: 'several' }, together.element, all.element);
  root.replaceChildren(list, add, element('span', { className: 'grow' }), several);

  /** @param {State} state @param {number} axis */
  function createTab(state, axis) {
    const { name } = state.axes[axis];
    const isChosen = axis === state.active;
    const tab = element(
      'button',
      {
        className: 'axis-tab',
        type: 'button',
        role: 'tab',
        'aria-selected': String(isChosen),
        tabIndex: isChosen ? 0 : -1,
        onclick: () => onChoose(axis),
      },
      element('i', { className: 'axis-number', 'data-axis': String(axis), textContent: String(axis) }),
      element('span', { textContent: name || 'unnamed' }),
    );
    const remove =
      state.axes.length > 1 &&
      element(
        'button',
        {
          className: 'remove',
          type: 'button',
          'aria-label': `Remove axis ${axis}, ${name || 'unnamed'}`,
          title: 'Remove this axis',
          onclick: () => onRemove(axis),
        },
        icon('remove'),
      );
    return element('span', { className: 'axis', role: 'presentation' }, tab, remove);
  }

  /** @param {KeyboardEvent} event */
  function walked(event) {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (by === undefined) return;
    const tabs = [...list.querySelectorAll('[role=tab]')];
    const next = (tabs.findIndex((tab) => tab.ariaSelected === 'true') + by + tabs.length) % tabs.length;
    onChoose(next);
    /** @type {HTMLElement} */ (list.querySelectorAll('[role=tab]')[next]).focus();
  }

  let known = '';
  return {
    /** @param {State} state @param {boolean} areAllShown */
    show(state, areAllShown) {
      // The tabs are rebuilt only when they differ, so that the focus stays in them.
      const shown = JSON.stringify([state.active, state.axes.map((design) => design.name)]);
      if (shown !== known) list.replaceChildren(...state.axes.map((_, axis) => createTab(state, axis)));
      known = shown;
      add.disabled = state.axes.length === MOST_AXES;
      several.hidden = state.axes.length === 1;
      together.press(state.together);
      all.press(areAllShown ? 'all' : 'one');
      list.classList.toggle('coloured', areAllShown && state.axes.length > 1);
    },
  };
}
