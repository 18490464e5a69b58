// @ts-check
// The axes of one machine: a tab each, one in hand, and whether they move each by itself or along a line.

import { showAll } from '../../app/commands/view.js';
import { addAxis, choose, removeAxis, setTogether } from '../../app/commands/work.js';
import { refusedAxesOf } from '../../app/devices.js';
import { areAxesShown, machineOf } from '../../app/selectors.js';
import { whenChanged } from '../../app/state.js';
import { element, icon, segmented } from '../../ui/dom.js';
import { watchStrip } from '../../ui/strip.js';
import { MOST_AXES } from '../../model/workbench.js';

/** @typedef {import('../../model/workbench.js').Machine} Machine */
/** @typedef {import('../../model/workbench.js').Together} Together */

/** @param {HTMLElement} root @param {import('../../app/state.js').Dispatch} dispatch */
export function createAxes(root, dispatch) {
  const list = element('div', { className: 'axis-tabs', role: 'tablist', 'aria-label': 'Axes', onkeydown: walked });
  const add = element(
    'button',
    {
      className: 'button quiet square',
      id: 'add-axis',
      type: 'button',
      'aria-label': 'Add an axis',
      title: 'Another axis of the same machine, up to four',
      onclick: () => dispatch(addAxis),
    },
    icon('plus'),
  );
  const together = segmented(
    'How the axes move',
    /** @type {[Together, string][]} */ ([
      ['independent', 'Each by itself'],
      ['line', 'Along a line'],
    ]),
    (value) => dispatch(setTogether, value),
  );
  together.element.id = 'together-choice';
  const all = segmented(
    'Plots of',
    /** @type {['one' | 'all', string][]} */ ([
      ['one', 'This axis'],
      ['all', 'All axes'],
    ]),
    (value) => dispatch(showAll, value === 'all'),
  );
  all.element.id = 'axes-choice';
  const several = element('span', { className: 'several' }, together.element, all.element);
  root.replaceChildren(list, add, element('span', { className: 'grow' }), several);
  for (const strip of [list, root]) watchStrip(strip);

  /** @param {Machine} machine @param {number} axis its number @param {boolean} isRefused */
  function createTab(machine, axis, isRefused) {
    const { name } = machine.axes[axis];
    const id = machine.ids[axis];
    const isChosen = axis === machine.active;
    const tab = element(
      'button',
      {
        className: 'axis-tab',
        type: 'button',
        role: 'tab',
        'aria-selected': String(isChosen),
        tabIndex: isChosen ? 0 : -1,
        'data-id': String(id),
        onclick: () => dispatch(choose, id),
      },
      element('i', { className: 'axis-number', 'data-axis': String(axis), textContent: String(axis) }),
      element('span', { textContent: name || 'unnamed' }),
      isRefused && icon('error'),
      isRefused && element('span', { className: 'unseen', textContent: ', with values that are refused' }),
    );
    tab.classList.toggle('refused', isRefused);
    const remove =
      machine.axes.length > 1 &&
      element(
        'button',
        {
          className: 'remove',
          type: 'button',
          'aria-label': `Remove axis ${axis}, ${name || 'unnamed'}`,
          title: 'Remove this axis',
          onclick() {
            dispatch(removeAxis, id);
            /** @type {HTMLElement | null} */ (list.querySelector('[aria-selected=true]'))?.focus();
          },
        },
        icon('remove'),
      );
    return element('span', { className: 'axis', role: 'presentation' }, tab, remove);
  }

  /** @param {KeyboardEvent} event */
  function walked(event) {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (by === undefined) return;
    const tabs = /** @type {HTMLElement[]} */ ([...list.querySelectorAll('[role=tab]')]);
    const next = (tabs.findIndex((tab) => tab.ariaSelected === 'true') + by + tabs.length) % tabs.length;
    dispatch(choose, Number(tabs[next].dataset.id));
    /** @type {HTMLElement} */ (list.querySelectorAll('[role=tab]')[next]).focus();
  }

  let known = '';
  /** @param {Machine | null} machine @param {boolean} areAllShown @param {number[]} refused axes, by their ids */
  function show(machine, areAllShown, refused) {
    if (machine === null) return;
    // The tabs are rebuilt only when they differ, so that the focus stays in them.
    const shown = JSON.stringify([machine.active, machine.ids, machine.axes.map((design) => design.name), refused]);
    if (shown !== known) list.replaceChildren(...machine.axes.map((_, axis) => createTab(machine, axis, refused.includes(machine.ids[axis]))));
    known = shown;
    add.disabled = machine.axes.length === MOST_AXES;
    several.hidden = machine.axes.length === 1;
    together.press(machine.together);
    all.press(areAllShown ? 'all' : 'one');
    list.classList.toggle('coloured', areAllShown);
  }

  return { show: whenChanged((state) => [machineOf(state), areAxesShown(state), refusedAxesOf(state)], show) };
}
