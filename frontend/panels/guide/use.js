// @ts-check
// The last step: the ramp goes where it is played.

import { designOf, isDesignValid, stalenessOf } from '../../app/selectors.js';
import { AXIS_LETTERS, settingLines, settingRemarks } from '../../documents/machine_settings.js';
import { copyText } from '../../ui/clipboard.js';
import { element, icon, messageLine, segmented, showText } from '../../ui/dom.js';

/** @typedef {import('../../model/guide.js').Player} Player */
// Whoever has none reads over it.
const MEASURING =
  'With a logic analyser: record step and direction of a move, and drop the file (CSV, VCD, .sr) on the page. The measured steps are laid over the planned ones.';

/** @typedef {{text: string, button: string, act: () => void}} Way */

/**
 * @param {object} act what can be asked for
 * @param {() => void} act.goToDevice
 * @param {(format: string) => void} act.openExport
 * @param {() => void} act.saveFile
 * @param {() => void} act.choosePlayer
 */
export function createUseStep({ goToDevice, openExport, saveFile, choosePlayer }) {
  /** @type {Record<'controller' | 'sketch' | 'chip', Way>} */
  const ways = {
    controller: {
      text: 'Connect the controller, or the simulated one to try it, and press “Push the ramp”. What it has stored is read back and compared; nothing moves by that.',
      button: 'Go to the device',
      act: goToDevice,
    },
    sketch: {
      text: 'Open the sketch in the Arduino IDE and upload it. Its first lines say which pins it uses; nothing moves until its button is pressed.',
      button: 'Get the sketch …',
      act: () => openExport('arduino'),
    },
    chip: {
      text: 'A header without a library: give it the steps, it gives the delays.',
      button: 'Get the C code …',
      act: () => openExport('c_newton'),
    },
  };
  const shownWays = Object.entries(ways).map(([player, way]) => ({ player, element: wayElement(player, way) }));
  const machines = element(
    'section',
    {},
    element('p', { textContent: 'grbl and Marlin work their ramps out by themselves: they get settings. Say what makes the steps, and the lines are shown here.' }),
    button('guide-choose', 'Say what makes the steps', choosePlayer),
  );
  const settings = createSettings();
  const problem = element('div', { className: 'guide-problem' });
  const others = element(
    'div',
    { className: 'guide-others' },
    element('h3', { textContent: 'Besides' }),
    button('guide-save', 'Save as a file', saveFile),
    button('guide-report', 'Report …', () => openExport('report_pdf')),
    element('p', { className: 'guide-hint', textContent: MEASURING }),
  );

  return {
    element: element('div', {}, problem, ...shownWays.map((way) => way.element), machines, settings.element, others),
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      const design = designOf(state);
      const { player } = state.guide;
      const isValid = design !== null && isDesignValid(state);
      const isRefused = stalenessOf(state) === 'refused';
      problem.replaceChildren(...(isRefused ? [messageLine({ text: 'First correct what is marked in the steps before.', isWarning: false })] : []));
      machines.hidden = player !== null;
      const isMachine = player === 'grbl' || player === 'marlin';
      for (const way of shownWays) {
        way.element.hidden = player === null ? false : way.player !== player;
        for (const one of way.element.querySelectorAll('button')) one.disabled = !isValid && way.player !== 'controller';
      }
      settings.element.hidden = !isMachine || !isValid;
      if (isMachine && isValid) settings.show(design, player);
    },
  };
}

/** @param {string} player @param {Way} way */
function wayElement(player, { text, button: label, act }) {
  return element('section', {}, element('p', { textContent: text }), button(`guide-${player}`, label, act));
}

/** @param {string} id @param {string} text @param {() => void} onclick */
function button(id, text, onclick) {
  return element('button', { className: 'button', id, type: 'button', textContent: text, onclick });
}

/** The lines for a machine that works its ramps out itself. */
function createSettings() {
  let letter = AXIS_LETTERS[0];
  /** @type {(() => void) | null} */
  let again = null;
  const choice = segmented('Axis of the machine', AXIS_LETTERS.map((one) => [one, one]), (one) => {
    letter = one;
    again?.();
  });
  const intro = element('p');
  const lines = element('pre', { id: 'guide-settings', tabIndex: 0, role: 'region', 'aria-label': 'Settings' });
  const remarks = element('div');
  const copied = element('span', { className: 'muted', role: 'status' });
  const copy = element('button', { className: 'button', id: 'guide-copy', type: 'button', onclick: take }, icon('copy'), 'Copy');

  async function take() {
    showText(copied, (await copyText(lines.textContent ?? '')) ? 'Copied.' : 'The browser does not let this page copy: select the lines.');
  }

  /** @param {import('../../model/types.js').Design} design @param {import('../../documents/machine_settings.js').Machine} machine */
  function show(design, machine) {
    choice.press(letter);
    again = () => show(design, machine);
    const name = machine === 'grbl' ? 'grbl' : 'Marlin';
    showText(intro, `Send these lines to ${name}: steps per unit, speed, acceleration. From then on it moves as the curves show.`);
    const text = settingLines(design, machine, letter).join('\n');
    if (lines.textContent !== text) showText(copied, '');
    showText(lines, text);
    remarks.replaceChildren(...settingRemarks(design, machine).map((remark) => messageLine({ text: remark, isWarning: true })));
  }

  const foot = element('div', { className: 'guide-line' }, choice.element, copy, copied);
  return { element: element('section', {}, intro, lines, foot, remarks), show };
}
