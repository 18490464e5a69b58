// @ts-check
// The second step: how fast the motor may go, and how soon.

import { answer, beginCarefully } from '../../app/commands/guide.js';
import { setUnits } from '../../app/commands/view.js';
import { designOf, messagesOf, stalenessOf } from '../../app/selectors.js';
import { turnsPerMinute } from '../../model/guide.js';
import { formatFigures } from '../../model/numbers.js';
import { unitsFor } from '../../model/units.js';
import { element, segmented, showText } from '../../ui/dom.js';
import { createGuideNumber } from './number.js';

const SPEED = 'ramp.slew_speed_steps_per_s';

/** @param {import('../../app/state.js').Dispatch} dispatch */
export function createLimitsStep(dispatch) {
  /** @type {import('../../model/units.js').Units | null} */
  let units = null;
  const onAnswer = (/** @type {string} */ path, /** @type {unknown} */ value) => dispatch(answer, path, value);
  const speed = createGuideNumber(
    SPEED,
    'Data sheet: where the pull-out curve has twice the torque that you need. grbl: $110, in mm/min. Marlin: M203, in mm/s.',
    onAnswer,
  );
  const acceleration = createGuideNumber(
    'ramp.acceleration_steps_per_s2',
    'No data sheet has it: raise it until the motor stalls under load, and take half. grbl: $120, and Marlin: M201, both in mm/s².',
    onAnswer,
  );
  const base = createGuideNumber(
    'ramp.base_speed_steps_per_s',
    'From rest: 0. A motor may begin at less than half of its start-stop (pull-in) speed.',
    onAnswer,
  );
  const numbers = [speed, acceleration, base];
  const times = segmented('Unit of time', [['s', 'per second'], ['min', 'per minute']], (time) => {
    if (units) dispatch(setUnits, { ...units, time: time === 'min' ? 'min' : 's' });
  });
  times.element.classList.add('fill');
  const turns = element('p', { className: 'guide-result', role: 'status' });
  const careful = element('button', {
    className: 'button',
    id: 'guide-careful',
    type: 'button',
    textContent: 'Start carefully',
    onclick: () => dispatch(beginCarefully),
  });
  const why = 'Sets 400 full steps/s and 2,000 full steps/s², which almost every motor does. Raise them later, one at a time.';
  return {
    element: element(
      'div',
      {},
      element('p', { textContent: 'How fast may it go, and how soon? Too soon, and it stalls.' }),
      careful,
      element('p', { className: 'guide-hint', textContent: why }),
      times.element,
      speed.element,
      turns,
      acceleration.element,
      base.element,
    ),
    numbers,
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      const design = designOf(state);
      if (design === null) return;
      units = unitsFor(state.units, design);
      times.press(units.time);
      const { fields } = messagesOf(state);
      for (const number of numbers) number.show(design, state.units, fields);
      // Whether these numbers are taken is known in a moment.
      if (stalenessOf(state) === 'awaited') return;
      const areTaken = [...fields].every(([path, { isWarning }]) => isWarning || !(path === SPEED || path.startsWith('axis.')));
      const rpm = areTaken ? turnsPerMinute(design, SPEED) : NaN;
      showText(turns, rpm > 0 ? `The motor turns ${formatFigures(rpm, 3)} times a minute.` : '');
    },
  };
}
