// @ts-check
// The guide of a first visit. What it does to the design is undone a step of the guide at a time.

import { areEqual } from '../../model/equal.js';
import { withValue } from '../../model/design.js';
import { DRIVES, driveOf, withCarefulLimits, withDrive, withLongMove, withPlayer, withTurnsKept } from '../../model/guide.js';
import { withPreset } from '../../model/presets.js';
import { STEPS_AND_SECONDS } from '../../model/units.js';
import { GUIDE_GESTURE, gestureEnded } from '../../model/workbench.js';
import { editedInHand } from '../editing.js';
import { axisOf, designOf, isOwnWork } from '../selectors.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/guide.js').Guide} Guide */
/** @typedef {import('../state.js').State} State */

/** @param {State} state @param {Partial<Guide>} known @returns {State} */
const guiding = (state, known) => ({ ...state, guide: { ...state.guide, ...known } });

/** The axis in hand has another design, as an answer to the present step. An example that was never touched is the
 * person's own from here: its name would be a wrong one.
 * @param {State} state @param {(design: Design) => Design} change @returns {State} */
function answered(state, change) {
  const isExample = !isOwnWork(state);
  const made = (/** @type {Design} */ design) => {
    const next = change(isExample ? { ...design, name: '' } : design);
    return areEqual({ ...next, name: '' }, { ...design, name: '' }) ? design : next;
  };
  return editedInHand(state, made, GUIDE_GESTURE + state.guide.step);
}

/** The same about the motor. What it turned when this step of the guide began it goes on turning, whatever its steps became
 * meanwhile, digit by digit.
 * @param {State} state @param {(design: Design) => Design} change @returns {State} */
function answeredOfMotor(state, change) {
  const before = designBefore(state);
  return answered(state, (design) => (before === null ? change(design) : withTurnsKept(change(design), before)));
}

/** The design in hand as it was when the present step of the guide began to change it.
 * @param {State} state @returns {Design | null} */
function designBefore(state) {
  const [axis, last] = [axisOf(state), state.history?.past.at(-1)];
  const isUnderWay = state.history?.gesture === GUIDE_GESTURE + state.guide.step;
  return (isUnderWay && last?.axes[last.ids.indexOf(axis ?? NaN)]) || designOf(state);
}

/** @param {State} state @returns {State} */
const settled = (state) => (state.history === null ? state : { ...state, history: gestureEnded(state.history) });

/** @param {State} state @returns {State} */
export function openGuide(state) {
  const { step } = state.guide;
  return guiding(state, { isOpen: true, step: step === 'use' ? 'motor' : step });
}

/** @param {State} state @returns {State} */
export const closeGuide = (state) => (state.guide.isOpen ? guiding(settled(state), { isOpen: false }) : state);

/** @param {State} state @param {import('../../model/guide.js').GuideStep} step @returns {State} */
export const goToStep = (state, step) => (state.guide.step === step ? state : guiding(settled(state), { step }));

const OF_MOTOR = ['axis.full_steps_per_rev', 'axis.microsteps'];

/** A number was typed.
 * @param {State} state @param {string} path @param {unknown} value @returns {State} */
export const answer = (state, path, value) =>
  (OF_MOTOR.includes(path) ? answeredOfMotor : answered)(state, (design) => withValue(design, path, value));

/** What the motor drives; all is then shown in its units.
 * @param {State} state @param {import('../../model/guide.js').Drive} drive @returns {State} */
export function setDrive(state, drive) {
  const next = answered(state, (design) => withDrive(design, drive, state.guide.drive));
  return guiding({ ...next, units: DRIVES[drive].units }, { drive });
}

/** What the design drives is what was meant: all is shown in its units, unless others were chosen.
 * @param {State} state @returns {State} */
export function takeDrive(state) {
  const design = designOf(state);
  if (design === null || state.units.length !== STEPS_AND_SECONDS.length) return state;
  return setDrive(state, driveOf(design, state.guide.drive));
}

/** A motor that many have.
 * @param {State} state @param {import('../../model/presets.js').Preset} preset @returns {State} */
export function setMotor(state, preset) {
  const drive = preset.values.travel_unit === 'mm' ? 'linear' : 'dial';
  const next = answeredOfMotor(state, (design) => withPreset(design, 'axis', preset));
  return guiding({ ...next, units: DRIVES[drive].units }, { drive });
}

/** @param {State} state @returns {State} */
export const beginCarefully = (state) => answered(state, withCarefulLimits);

/** @param {State} state @param {import('../../model/guide.js').Player} player @returns {State} */
export const setPlayer = (state, player) => guiding(answered(state, (design) => withPlayer(design, player)), { player });

/** @param {State} state @returns {State} */
export const lengthenMove = (state) => answered(state, withLongMove);
