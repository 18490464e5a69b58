// @ts-check
// What the sections of the device panel share.

import { counted, formatFigures, formatKnown } from '../../model/numbers.js';
import { shownValue, stepsPerUnit, unitsFor, unitWord } from '../../model/units.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').Design} Design */

/** What a section shows.
 * @typedef {object} Context
 * @property {Device | null} device  null: none, or it is lost
 * @property {Device | null} known   the same, also while it is lost
 * @property {import('../../model/types.js').Family | null} family  of it, or the one chosen for what is to be connected
 * @property {number} axis
 * @property {Design} design         of this axis, or the one in view where the device can't have those of all axes
 * @property {number} axisId         of the page's axis that has this design
 * @property {string} inTheWay       why nothing can be asked of the device now; empty: something can
 * @property {boolean} isVirtual   whether there is no hardware, but a world that the page can change
 * @property {import('../../devices/homing.js').Homing | null} homing  the last that this page began of it
 * @property {string} notAtRest      why nothing can be begun; empty: it is at rest
 * @property {import('../../model/types.js').Situation} situation */

/** As many as controllers tell. */
const SCALE_FIGURES = 7;

/** The part of the panel for one kind of work.
 * @typedef {object} Section
 * @property {HTMLElement} element
 * @property {(context: Context) => void} show
 * @property {(rejections: import('../../model/types.js').Rejection[]) => import('../../model/types.js').Rejection[]} [reject]
 *   shows those that it has a field for and returns the others */

/** What is to be known before a motion is begun: it is made with the ramp that the device has, be the design another one.
 * @param {Context} context @returns {string} empty: the device has the ramp of the design, as far as is known */
export function otherRampText({ device, axis, situation }) {
  const { preview, lastPushed, units, scaled, isDesignValid, isAwaited, isChanged } = situation;
  if (device === null || !device.ramp || isAwaited) return '';
  const differs = preview === null ? isChanged : !preview.same;
  if (isDesignValid && !differs) return '';
  const pushed = lastPushed?.length === 1 ? lastPushed[0] : lastPushed?.[axis];
  const speeds = (preview?.items ?? []).flatMap((item) =>
    item.unit === 'steps/s' && item.on_device !== null && (item.axis ?? axis) === axis ? [item.on_device] : [],
  );
  const speed = pushed ? Number(pushed.ramp.slew_speed_steps_per_s) : Math.max(...speeds);
  const upTo = Number.isFinite(speed) ? `, up to ${speedText(units, scaled[axis], speed)}` : '';
  return isDesignValid
    ? `The device has another ramp than the design${upTo}: push first, or it moves with that one.`
    : 'The design can’t be computed: the device moves with the ramp that it has.';
}

/** That lengths of some axes are shown by the controller's scale, where the design has another; '' where none are.
 * @param {Context} context @param {number[]} axes of the device */
export function scaleText({ situation: { units, played, scaled } }, axes) {
  const perMm = (/** @type {Design} */ { axis }) => formatKnown(stepsPerUnit(axis), SCALE_FIGURES);
  const words = axes.flatMap((axis) => {
    const { length } = unitsFor(units, scaled[axis]);
    const [ofMachine, ofDesign] = [scaled[axis].axis.microsteps, played[axis].axis.microsteps];
    const areOther = ofMachine !== ofDesign;
    // Degrees and turns are the same by any steps/mm.
    if (played[axis] === scaled[axis] || length === 'steps' || (!areOther && length !== 'mm')) return [];
    const own = areOther ? counted(Number(ofMachine), 'microstep') : `${perMm(scaled[axis])} steps/mm`;
    const designs = areOther ? ofDesign : perMm(played[axis]);
    return axes.length > 1 ? `axis ${axis} has ${own}, its design ${designs}` : `${own}; the design has ${designs}`;
  });
  return words.length === 0 ? '' : `Lengths here are the machine’s: ${words.join('; ')}.`;
}

/** @param {import('../../model/units.js').Units} units @param {Design} design @param {number} speed [steps/s] */
export function speedText(units, design, speed) {
  return `${formatFigures(shownValue(units, design, 'speed', speed))} ${unitWord(units, design, 'speed')}`;
}

/** Whether a device can do what only some can; until it is known of a device, whether those of its family can. One that is
 * connected again is taken to be what it was.
 * @param {Pick<Context, 'known' | 'family'>} context @param {import('../../model/types.js').Capability} what */
export function can({ known, family }, what) {
  const isUnknown = known === null || (known.state === 'connecting' && known.capabilities.length === 0);
  return isUnknown ? (family?.capabilities.includes(what) ?? true) : known.capabilities.includes(what);
}

/** The button that was disabled while it had the focus: browsers then take the focus away, some for good.
 * @type {HTMLButtonElement | null} */
let unfocused = null;

/** Enable a button or disable it; one that lost the focus by that gets it back, unless it is elsewhere by then.
 * @param {HTMLButtonElement} button @param {boolean} isEnabled */
export function enable(button, isEnabled) {
  if (button.disabled !== isEnabled) return;
  if (!isEnabled && button === document.activeElement) unfocused = button;
  button.disabled = !isEnabled;
  if (!isEnabled || button !== unfocused) return;
  unfocused = null;
  if (document.activeElement === document.body) button.focus();
}

/** Buttons that go give the focus that they have, or would get back, to another one.
 * @param {HTMLButtonElement[]} gone @param {HTMLButtonElement} next */
export function handOn(gone, next) {
  const focused = gone.find((button) => button === document.activeElement);
  if (focused === undefined && (unfocused === null || !gone.includes(unfocused))) return;
  // A browser lets go of what is hidden in its own time.
  focused?.blur();
  unfocused = next.disabled ? next : null;
  if (!next.disabled && document.activeElement === document.body) next.focus();
}

/**
 * @param {HTMLButtonElement[]} buttons @param {HTMLElement} reason where it is told why not
 * @param {string} why empty: they can be used @param {boolean} isBusy
 */
export function able(buttons, reason, why, isBusy) {
  for (const button of buttons) enable(button, why === '' && !isBusy);
  if (reason.textContent !== why) reason.textContent = why;
  reason.hidden = why === '';
}
