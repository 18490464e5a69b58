// @ts-check
// The last step: the ramp goes where it is played.

import { designOf, isDesignValid } from '../../app/selectors.js';
import { createQuestion, laterText } from '../../app/effects/question.js';
import { pushRefusals } from '../../model/messages.js';
import { inShownUnits, sentencesInUnits } from '../../model/told.js';
import { api } from '../../server/api.js';
import { copyText } from '../../ui/clipboard.js';
import { element, icon, messageLine, segmented, showText } from '../../ui/dom.js';

/** @typedef {import('../../model/guide.js').Player} Player */
/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/units.js').Units} Units */
/** @typedef {'grbl' | 'marlin'} Machine */
/** @typedef {{design: Design, machine: Machine, units: Units}} Wanted */

const NAMES = { grbl: 'grbl', marlin: 'Marlin' };
/** Of the axes that each of them has. */
const AXIS_LETTERS = ['X', 'Y', 'Z'];
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
 * @param {Pick<typeof api, 'machine'>} [server]
 */
export function createUseStep({ goToDevice, openExport, saveFile, choosePlayer }, server = api) {
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
    element('p', { textContent: 'So do Klipper, FluidNC, Pololu Tics and libraries for Arduinos: what each gets is exported, with what it loses.' }),
    button('guide-machines', 'Other controllers …', () => openExport('grblhal')),
  );
  const settings = createSettings(server);
  const others = element(
    'div',
    { className: 'guide-others' },
    element('h3', { textContent: 'Besides' }),
    button('guide-save', 'Save as a file', saveFile),
    button('guide-report', 'Report …', () => openExport('report_pdf')),
    element('p', { className: 'guide-hint', textContent: MEASURING }),
  );

  return {
    element: element('div', {}, ...shownWays.map((way) => way.element), machines, settings.element, others),
    /** @type {import('./number.js').GuideNumber[]} */
    numbers: [],
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      const design = designOf(state);
      const { player } = state.guide;
      const isValid = design !== null && isDesignValid(state);
      machines.hidden = player !== null;
      const isMachine = player === 'grbl' || player === 'marlin';
      for (const way of shownWays) {
        way.element.hidden = player === null ? false : way.player !== player;
        for (const one of way.element.querySelectorAll('button')) one.disabled = !isValid && way.player !== 'controller';
      }
      settings.element.hidden = !isMachine || !isValid;
      if (isMachine && isValid) settings.show(design, player, state.units);
      else settings.cancel();
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

/** The lines for a machine that works its ramps out itself.
 * @param {Pick<typeof api, 'machine'>} server */
function createSettings(server) {
  let letter = AXIS_LETTERS[0];
  /** What is shown, or asked for.
   * @type {Wanted | null} */
  let wanted = null;
  const choice = segmented('Axis of the machine', AXIS_LETTERS.map((one) => [one, one]), (one) => {
    letter = one;
    if (wanted !== null) ask(wanted);
  });
  const intro = element('p');
  const lines = element('pre', { id: 'guide-settings', tabIndex: 0, role: 'region', 'aria-label': 'Settings' });
  const remarks = element('div');
  const copied = element('span', { className: 'muted', role: 'status' });
  const copy = element('button', { className: 'button', id: 'guide-copy', type: 'button', onclick: take }, icon('copy'), 'Copy');

  const question = createQuestion({
    ask: (/** @type {Wanted & {letter: string}} */ { machine, design, letter: axis_letter }, ended) => server.machine(machine, { design, axis_letter }, ended),
    take({ text, remarks: said, remarks_told }, { design, units }) {
      // Its comments say what is said here besides.
      const sent = text.split('\n').filter((line) => line !== '' && !line.startsWith(';'));
      tell(sent.join('\n'), sentencesInUnits(units, [design], said, remarks_told), true);
    },
    refuse: ({ rejections }, { design, units }) => tell('', pushRefusals(rejections.map(inShownUnits(units, [design]))).map(({ text }) => text), false),
    miss: (_, error) => tell('', [laterText(error)], false),
    isOnlyNewest: true,
  });

  /** @param {string} text @param {string[]} messages @param {boolean} isWarning */
  function tell(text, messages, isWarning) {
    showText(lines, text);
    lines.hidden = copy.disabled = text === '';
    remarks.replaceChildren(...messages.map((one) => messageLine({ text: one, isWarning })));
  }

  async function take() {
    showText(copied, (await copyText(lines.textContent ?? '')) ? 'Copied.' : 'The browser does not let this page copy: select the lines.');
  }

  /** @param {Wanted} about */
  function ask(about) {
    choice.press(letter);
    showText(intro, `Send these lines to ${NAMES[about.machine]}: steps per unit, speed, acceleration. What of the design it does otherwise is said below.`);
    showText(copied, '');
    // Lines of an earlier design are none to be copied.
    tell('', [], true);
    question.want({ ...about, letter });
  }

  const foot = element('div', { className: 'guide-line' }, choice.element, copy, copied);
  return {
    element: element('section', {}, intro, lines, foot, remarks),
    /** @param {Design} design @param {Machine} machine @param {Units} units */
    show(design, machine, units) {
      if (wanted?.design === design && wanted.machine === machine && wanted.units === units) return;
      wanted = { design, machine, units };
      ask(wanted);
    },
    /** There is nothing to be asked. */
    cancel() {
      wanted = null;
      question.cancel();
    },
  };
}
