// @ts-check
// The head of the page: whose design it is, its history, files and links, examples, theme, what the device does, and STOP.

import { element, icon, svgElement } from '../../dom.js';
import { createLinkDialog } from './link_dialog.js';
import { createMenu } from './menu.js';
import { createNotice } from './notice.js';
import { createShortcuts } from './shortcuts.js';

/** @typedef {import('../../types.js').Device} Device */
/** @typedef {import('../../types.js').Example} Example */
/** @typedef {Parameters<typeof icon>[0]} Drawing */

/**
 * @param {HTMLElement} root
 * @param {object} handlers
 * @param {(name: string) => void} handlers.onName
 * @param {() => void} handlers.onUndo
 * @param {() => void} handlers.onRedo
 * @param {() => void} handlers.onOpen
 * @param {() => void} handlers.onSave
 * @param {() => void} handlers.onShare
 * @param {() => void} handlers.onExport
 * @param {(example: Example) => void} handlers.onExample
 * @param {() => void} handlers.onBack
 * @param {() => void} handlers.onTheme
 * @param {() => void} handlers.onStop
 */
export function createHeader(root, handlers) {
  const name = element('input', {
    className: 'design-name',
    'aria-label': 'Design name',
    spellcheck: false,
    autocomplete: 'off',
    oninput: () => handlers.onName(name.value),
  });
  const shortcuts = createShortcuts(handlers);
  const notice = createNotice();
  const linkDialog = createLinkDialog();
  const undo = tool('undo', 'Undo', 'Undo (Ctrl+Z)', handlers.onUndo);
  const redo = tool('redo', 'Redo', 'Redo (Ctrl+Shift+Z)', handlers.onRedo);
  const theme = tool('theme', 'Switch between light and dark', 'Light or dark', handlers.onTheme);
  const keys = tool('keys', 'Keyboard shortcuts', 'Keyboard shortcuts (?)', shortcuts.open);
  for (const button of [redo, theme, keys]) button.classList.add('not-phone');
  undo.disabled = redo.disabled = true;
  const menu = createMenu(handlers, [
    ['Redo', handlers.onRedo],
    ['Open a file …', handlers.onOpen],
    ['Save as a file', handlers.onSave],
    ['Share a link', handlers.onShare],
    ['Export …', handlers.onExport],
    ['Light or dark', handlers.onTheme],
    ['Keyboard shortcuts', shortcuts.open],
  ]);
  const device = createDevice(handlers.onStop);
  root.replaceChildren(
    brand(),
    element('span', { className: 'rule not-phone' }),
    name,
    element('span', { className: 'tools', role: 'group', 'aria-label': 'History' }, undo, redo),
    element('span', { className: 'rule not-phone' }),
    element(
      'span',
      { className: 'tools not-phone', role: 'group', 'aria-label': 'Files and links' },
      wordTool('open', 'Open', 'Open a file (Ctrl+O), or drop one on the page', handlers.onOpen),
      wordTool('save', 'Save', 'Save as a file (Ctrl+S)', handlers.onSave),
      wordTool('link', 'Share', 'Copy a link that holds the whole design', handlers.onShare),
      wordTool('export', 'Export', 'Export as C, CSV, a report or pictures', handlers.onExport),
    ),
    menu.element,
    element('span', { className: 'grow not-phone' }),
    keys,
    theme,
    device.pill,
    device.stop,
    notice.element,
  );

  return {
    /** @param {string} text */
    showName(text) {
      // What is being typed is there already; an undo meanwhile is not.
      if (name.value !== text) name.value = text;
      document.title = text === '' ? 'StepRamp' : `${text} · StepRamp`;
    },
    /** @param {boolean} canUndo @param {boolean} canRedo */
    showHistory(canUndo, canRedo) {
      const focused = document.activeElement;
      undo.disabled = !canUndo;
      redo.disabled = !canRedo;
      menu.enable('Redo', canRedo);
      // A button that is disabled under the finger hands its focus on: the keyboard must not lose its place.
      const next = focused === undo && !canUndo ? redo : focused === redo && !canRedo ? undo : null;
      if (next !== null) (next.offsetParent === null ? menu.opener : next).focus();
    },
    showExamples: menu.showExamples,
    showDevice: device.show,
    showNotice: notice.show,
    showLink: linkDialog.open,
  };
}

/** A button with a drawing.
 * @param {Drawing} drawing @param {string} label @param {string} title @param {() => void} onclick */
function tool(drawing, label, title, onclick) {
  return element(
    'button',
    { className: 'button quiet square', id: `head-${drawing}`, type: 'button', 'aria-label': label, title, onclick },
    icon(drawing),
  );
}

/** A button with a drawing, and where there is room, its name.
 * @param {Drawing} drawing @param {string} text
 * @param {string} title @param {() => void} onclick */
function wordTool(drawing, text, title, onclick) {
  return element(
    'button',
    { className: 'button quiet word', id: `head-${drawing}`, type: 'button', 'aria-label': text, title, onclick },
    icon(drawing),
    element('span', { className: 'wide-only', textContent: text }),
  );
}

/** What the device does, and STOP.
 * @param {() => void} onStop */
function createDevice(onStop) {
  const who = element('span', { className: 'who not-phone' });
  const word = element('span');
  const pill = element('span', { className: 'pill', id: 'device-pill' }, who, word);
  const stopText = element('span');
  const stop = element(
    'button',
    { className: 'stop', id: 'stop', type: 'button', onclick: onStop },
    stopText,
    element('kbd', { className: 'not-phone', 'aria-hidden': 'true', textContent: 'Esc' }),
  );

  /** @param {Device | null} device @param {boolean} isHaltNext whether a press halts
   * @param {boolean} isLive whether the device is so now */
  function show(device, isHaltNext, isLive) {
    pill.dataset.state = isLive ? (device?.state ?? 'none') : 'old';
    who.textContent = device ? `${device.name} ·` : '';
    word.textContent = device ? (isLive ? device.state : `was ${device.state}`) : 'no device';
    stopText.textContent = isHaltNext ? 'HALT' : 'STOP';
    const label = isHaltNext ? 'Halt at once without slowing down (Escape)' : 'Stop every motor (Escape)';
    stop.setAttribute('aria-label', label);
  }

  show(null, false, true);
  return { pill, stop, show };
}

function brand() {
  const drawing = svgElement('svg', {
    viewBox: '0 0 24 24',
    'aria-hidden': 'true',
    fill: 'none',
    'stroke-width': 2.6,
    'stroke-linejoin': 'round',
    'stroke-linecap': 'round',
  });
  drawing.append(svgElement('path', { d: 'M2 20h4v-5h4v-5h4V5h8' }));
  return element(
    'div',
    { className: 'brand' },
    drawing,
    element('span', { className: 'not-phone', textContent: 'StepRamp' }),
  );
}
