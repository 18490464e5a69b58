// @ts-check
// The keys of the page: the list of them, and those that the head of the page acts on.

import { createDialog } from '../../ui/dialog.js';
import { element } from '../../ui/dom.js';

const isMac = /Mac|iP(ad|hone|od)/.test(navigator.platform);
const CTRL = isMac ? '⌘' : 'Ctrl';
const ALT = isMac ? '⌥' : 'Alt';

/** @type {[string, [string[], string][]][]} */
const KEYS = [
  [
    'Everywhere',
    [
      [['Esc'], 'Stop every motor along its ramp; once more: halt at once'],
      [[`${CTRL} Z`], 'Undo'],
      [[`${CTRL} Shift Z`, `${CTRL} Y`], 'Redo'],
      [[`${CTRL} S`], 'Save as a file'],
      [[`${CTRL} O`], 'Open a file'],
      [['?'], 'This list'],
    ],
  ],
  [
    'Numbers and sliders',
    [
      [['↑', '↓'], 'Step up or down, by about 1 %'],
      [['Shift', 'Page ↑', 'Page ↓'], 'Coarse: ten times as far'],
      [[ALT], 'Fine: a tenth of it'],
      [['Home', 'End'], 'A slider’s ends'],
      [['Wheel'], 'Steps what has the focus'],
    ],
  ],
  [
    'Plots',
    [
      [['←', '→'], 'Walk along the curves; Shift ten at a time'],
      [['+', '−'], 'Zoom'],
      [['0'], 'Show all'],
    ],
  ],
  [
    'Points of the table, in the plot',
    [
      [['Tab'], 'The next point'],
      [['← →', '↑ ↓'], 'Move it: its step, its delay; Shift coarse'],
      [[ALT], 'By one'],
      [['Delete'], 'Remove it'],
    ],
  ],
];

/** @param {{onSave: () => void, onOpen: () => void}} handlers */
export function createShortcuts({ onSave, onOpen }) {
  const lists = KEYS.map(([title, keys]) =>
    element('section', {}, element('h3', { textContent: title }), element('dl', {}, ...keys.flatMap(line))),
  );
  const dialog = createDialog(
    { id: 'shortcuts', title: 'Keyboard' },
    element('div', { className: 'shortcut-lists' }, ...lists),
  );

  addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey) pressedWithCtrl(event);
    else if (event.key === '?' && !event.altKey && !isTyping(event.target)) dialog.open();
  });

  /** @param {KeyboardEvent} event */
  function pressedWithCtrl(event) {
    const act = event.altKey || event.shiftKey ? undefined : { s: onSave, o: onOpen }[event.key.toLowerCase()];
    if (act === undefined) return;
    event.preventDefault();
    if (!event.repeat) act();
  }

  return { open: () => dialog.open() };
}

/** @param {[string[], string]} line */
function line([keys, text]) {
  const caps = keys.map((key) => element('kbd', { textContent: key }));
  return [element('dt', {}, ...caps), element('dd', { textContent: text })];
}

/** @param {EventTarget | null} target */
function isTyping(target) {
  return target instanceof Element && target.matches('input:not([type="range"]), textarea, select');
}
