// @ts-check
// The first step: the motor, and what it drives.

import { answer, setDrive, setMotor } from '../../app/commands/guide.js';
import { designOf, messagesOf } from '../../app/selectors.js';
import { DRIVES, driveOf } from '../../model/guide.js';
import { PRESETS, presetOf } from '../../model/presets.js';
import { element, messageLine, picker } from '../../ui/dom.js';
import { createChoices } from './choices.js';
import { createGuideNumber } from './number.js';

/** @typedef {import('../../model/guide.js').Drive} Drive */

const TRAVEL = 'axis.travel_per_rev';
const OWN = 'Another one';
/** The motor is to turn as before, and may need more steps a second for it than there can be: refused, or too fast for the
 * controller. */
const REFUSED = { text: 'With these steps the limits are refused: the next step says what is allowed.', isWarning: false };
/** How the way of a turn is asked for.
 * @type {Record<Drive, Partial<import('./number.js').Manner> & {hint: string} | null>} */
const TRAVELS = {
  linear: { label: 'Way of one turn', unit: 'mm', hint: 'Screw: pitch × starts, T8: 2 × 4 = 8 mm. Belt: teeth × pitch, GT2 with 20: 40 mm.' },
  wheel: { label: 'Wheel diameter', unit: 'mm', factor: 1 / Math.PI, hint: 'Of the wheel that the motor turns; one turn is π times that.' },
  dial: { label: 'Way of one turn', unit: '°', hint: '360° when the motor turns it itself; with a gear of 1:10 it is 36°.' },
  nothing: null,
};

/** @param {import('../../app/state.js').Dispatch} dispatch */
export function createMotorStep(dispatch) {
  const onAnswer = (/** @type {string} */ path, /** @type {unknown} */ value) => dispatch(answer, path, value);
  const motors = picker('Motor', (name) => {
    const preset = PRESETS.axis.find((one) => one.name === name);
    if (preset) dispatch(setMotor, preset);
  });
  motors.select.id = 'guide-motors';
  const about = element('p', { className: 'guide-hint' });
  const steps = createGuideNumber('axis.full_steps_per_rev', 'On its label or data sheet: 1.8° is 200, 0.9° is 400.', onAnswer);
  const microsteps = createGuideNumber('axis.microsteps', 'As the driver’s jumpers are set: 1, 2, 4, 8, 16 … The motor goes on turning as fast and as far.', onAnswer);
  const refused = element('div', { id: 'guide-refused', role: 'status' });
  const drives = createChoices(
    'guide-drive',
    'What does it drive?',
    Object.entries(DRIVES).map(([drive, { label }]) => /** @type {[Drive, {label: string}]} */ ([drive, { label }])),
    (drive) => dispatch(setDrive, drive),
  );
  drives.element.classList.add('in-pairs');
  const travels = Object.entries(TRAVELS).flatMap(([drive, told]) =>
    told ? [{ drive, told, number: createGuideNumber(TRAVEL, told.hint, onAnswer, `-${drive}`) }] : [],
  );

  return {
    element: element(
      'div',
      {},
      element('p', { textContent: 'Which motor is it? Choose one that many have, or type what yours says.' }),
      motors.element,
      about,
      steps.element,
      microsteps.element,
      refused,
      drives.element,
      ...travels.map(({ number }) => number.element),
    ),
    numbers: [steps, microsteps, ...travels.map(({ number }) => number)],
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      const design = designOf(state);
      if (design === null) return;
      const { fields } = messagesOf(state);
      const preset = presetOf(design, 'axis');
      const names = [OWN, ...PRESETS.axis.map((one) => one.name)];
      motors.offer(names.map((name) => [name, name]), preset?.name ?? OWN);
      about.textContent = preset?.help ?? '';
      steps.show(design, state.units, fields);
      microsteps.show(design, state.units, fields);
      const areRefused = [...fields].some(([path, { isWarning }]) => path.startsWith('ramp.') && !isWarning);
      const message = areRefused ? REFUSED : [...fields].find(([path]) => path.startsWith('timer.'))?.[1];
      if (refused.textContent !== (message?.text ?? '')) refused.replaceChildren(...(message ? [messageLine(message)] : []));
      const drive = driveOf(design, state.guide.drive);
      drives.press(drive);
      for (const { drive: of, told, number } of travels) {
        number.element.hidden = of !== drive;
        if (of === drive) number.show(design, state.units, fields, { label: told.label, unit: told.unit, factor: told.factor ?? 1 });
      }
    },
  };
}
