// @ts-check
// The head of the page: whose design it is, its history, files and links, examples, theme, what the device does, and STOP.

import { showCapture } from '../../app/commands/capture.js';
import { openGuide } from '../../app/commands/guide.js';
import { closeFault } from '../../app/commands/told.js';
import { setName } from '../../app/commands/work.js';
import { toldAgeOf, toldDeviceOf } from '../../app/devices.js';
import { designOf, messagesOf } from '../../app/selectors.js';
import { whenChanged } from '../../app/state.js';
import { element, icon, showText, svgElement } from '../../ui/dom.js';
import { nameText } from '../../model/messages.js';
import { agoText } from '../../devices/ages.js';
import { shownState } from '../../devices/state_words.js';
import { createLinkDialog } from './link_dialog.js';
import { createMenu } from './menu.js';
import { createNotice } from './notice.js';
import { createShortcuts } from './shortcuts.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').Example} Example */
/** @typedef {Parameters<typeof icon>[0]} Drawing */

/** What is said at the button of a STOP. */
const FATES = {
  answered: '',
  waiting: 'Not answered yet: nobody knows whether anything stops',
  undelivered: 'Not delivered: cut the motor’s power',
};

/**
 * @param {HTMLElement} root
 * @param {import('../../app/state.js').Dispatch} dispatch
 * @param {object} act  what can be asked for
 * @param {() => void} act.undo
 * @param {() => void} act.redo
 * @param {() => void} act.openFile
 * @param {() => void} act.saveFile
 * @param {() => void} act.shareLink
 * @param {(format?: string) => void} act.openExport
 * @param {() => void} act.openBackups
 * @param {() => void} act.openLibrary
 * @param {() => void} act.startNew
 * @param {() => void} act.duplicate
 * @param {(work: import('../../model/workbench.js').Work & {ids?: number[]}) => void} act.openWork
 * @param {() => void} act.goBack
 * @param {() => void} act.switchTheme
 * @param {() => void} act.stop
 */
export function createHeader(root, dispatch, act) {
  const name = element('input', {
    className: 'design-name',
    'aria-label': 'Design name',
    placeholder: 'unnamed',
    spellcheck: false,
    autocomplete: 'off',
    oninput: () => dispatch(setName, name.value),
  });
  const nameProblem = element('p', { className: 'name-problem', id: 'design-name-problem', hidden: true });
  const shortcuts = createShortcuts({ onSave: act.saveFile, onOpen: act.openFile });
  const notice = createNotice(() => dispatch(closeFault));
  const linkDialog = createLinkDialog();
  const undo = tool('undo', 'Undo', 'Undo (Ctrl+Z)', act.undo);
  const redo = tool('redo', 'Redo', 'Redo (Ctrl+Shift+Z)', act.redo);
  const theme = tool('theme', 'Switch between light and dark', 'Light or dark', act.switchTheme);
  const keys = tool('keys', 'Keyboard shortcuts', 'Keyboard shortcuts (?)', shortcuts.open);
  for (const button of [redo, theme, keys]) button.classList.add('roomy');
  undo.disabled = redo.disabled = true;
  const handlers = {
    onNew: act.startNew,
    onDuplicate: act.duplicate,
    onExample: (/** @type {Example} */ { design }) => act.openWork({ axes: [design], together: 'independent' }),
    onOther: (/** @type {import('../../app/state.js').OtherTab} */ { machine }) => act.openWork(machine),
    onBack: act.goBack,
  };
  const menu = createMenu(handlers, [
    ['Redo', act.redo],
    ['Open a file …', act.openFile],
    ['Measured steps …', () => dispatch(showCapture, true)],
    ['Save as a file', act.saveFile],
    ['Share a link', act.shareLink],
    ['Export …', () => act.openExport()],
    ['Light or dark', act.switchTheme],
    ['Keyboard shortcuts', shortcuts.open],
  ], [
    ['Library …', act.openLibrary],
    ['Guide: from the motor to the ramp', guide],
    ['Documentation', () => window.open('/help/', '_blank', 'noopener')],
    ['Report …', () => act.openExport('report_pdf')],
    ['Print …', () => window.print()],
    ['Backups of controllers …', act.openBackups],
  ]);
  function guide() {
    dispatch(openGuide);
    document.getElementById('guide')?.focus();
  }

  const device = createDevice(act.stop);
  root.replaceChildren(
    brand(),
    element('span', { className: 'rule roomy' }),
    element('span', { className: 'name-field' }, name, nameProblem),
    element('span', { className: 'tools', role: 'group', 'aria-label': 'History' }, undo, redo),
    element('span', { className: 'rule roomy' }),
    element(
      'span',
      { className: 'tools roomy', role: 'group', 'aria-label': 'Files and links' },
      wordTool('open', 'Open', 'Open a design, a table or a capture (Ctrl+O), or drop a file on the page', act.openFile),
      wordTool('save', 'Save', 'Save as a file (Ctrl+S)', act.saveFile),
      wordTool('link', 'Share', 'Copy a link that holds the whole design', act.shareLink),
      wordTool('export', 'Export', 'Export as C, CSV, a report or pictures', () => act.openExport()),
    ),
    menu.element,
    element('span', { className: 'grow roomy' }),
    keys,
    theme,
    device.pill,
    device.stopping,
    notice.element,
  );

  /** @param {string} text */
  function showName(text) {
    // What is being typed is there already; an undo meanwhile is not.
    if (name.value !== text) name.value = text;
    document.title = text === '' ? 'StepRamp' : `${text} · StepRamp`;
  }

  /** @param {import('../../model/messages.js').Message | undefined} problem */
  function showNameProblem(problem) {
    nameProblem.hidden = problem === undefined;
    showText(nameProblem, nameText(problem, name.value));
    name.setAttribute('aria-invalid', String(problem !== undefined));
    if (problem) name.setAttribute('aria-describedby', nameProblem.id);
    else name.removeAttribute('aria-describedby');
  }

  /** @param {boolean} canUndo @param {boolean} canRedo */
  function showHistory(canUndo, canRedo) {
    const focused = document.activeElement;
    undo.disabled = !canUndo;
    redo.disabled = !canRedo;
    menu.enable('Redo', canRedo);
    // A button that is disabled under the finger hands its focus on: the keyboard must not lose its place.
    const next = focused === undo && !canUndo ? redo : focused === redo && !canRedo ? undo : null;
    if (next !== null) (next.offsetParent === null ? menu.opener : next).focus();
  }

  const shows = [
    whenChanged((state) => [designOf(state)?.name ?? null], (text) => text !== null && showName(text)),
    whenChanged(({ history }) => [(history?.past.length ?? 0) > 0, (history?.future.length ?? 0) > 0], showHistory),
    whenChanged(
      ({ examples, otherTabs, replaced }) => [examples, otherTabs.list, replaced],
      (examples, others, replaced) => menu.showDesigns(examples, others, replaced && replaced.axes[replaced.active].name),
    ),
    whenChanged((state) => [messagesOf(state).fields.get('name')], showNameProblem),
    whenChanged(
      (state) => [toldDeviceOf(state), state.devices.isHaltNext, state.devices.stopFate, state.devices.link === 'there', toldAgeOf(state)],
      device.show,
    ),
    whenChanged(({ told }) => [told.notice], (told) => (told ? notice.show(told.text, told.hasFailed) : notice.close())),
    whenChanged(({ told }) => [told.fault], notice.showFault),
    whenChanged(({ told }) => [told.link], (link) => link && linkDialog.open(link.text)),
  ];

  return {
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      for (const show of shows) show(state);
    },
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
  const who = element('span', { className: 'who roomy' });
  const word = element('span');
  const ago = element('span', { className: 'roomy ago' });
  const pill = element('span', { className: 'pill', id: 'device-pill' }, who, word, ago);
  const stopText = element('span');
  const stop = element(
    'button',
    { className: 'stop', id: 'stop', type: 'button', onclick: onStop },
    stopText,
    element('kbd', { className: 'roomy', 'aria-hidden': 'true', textContent: 'Esc' }),
  );

  const failure = element('span', { className: 'stop-failure', id: 'stop-failure', role: 'alert' });
  const stopping = element('span', { className: 'stopping' }, stop, failure);

  /** @param {Device | null} device @param {boolean} isHaltNext whether a press halts
   * @param {import('../../devices/stopping.js').Fate} fate of the last press
   * @param {boolean} isLinked whether the server tells of it @param {number | null} age of what it told; null: it is new */
  function show(device, isHaltNext, fate, isLinked, age) {
    const isLive = isLinked && age === null;
    const state = shownState(device);
    pill.dataset.state = isLive || state === 'lost' ? state : 'old';
    who.textContent = device ? `${device.name} ·` : '';
    word.textContent = device ? (isLive || state === 'lost' ? state : `was ${state}`) : 'no device';
    ago.textContent = device && age !== null ? `· ${agoText(age)}` : '';
    showText(stopText, isHaltNext ? 'HALT' : 'STOP');
    const explained = isHaltNext ? 'Halt at once without slowing down (Escape)' : 'Stop every motor (Escape)';
    stop.setAttribute('aria-description', explained);
    if (failure.textContent !== FATES[fate]) failure.textContent = FATES[fate];
    failure.hidden = FATES[fate] === '';
  }

  show(null, false, 'answered', true, null);
  return { pill, stopping, show };
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
    element('h1', { textContent: 'StepRamp' }),
  );
}
