// @ts-check
// What the sections of the device panel share.

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').Design} Design */

/** What a section shows.
 * @typedef {object} Context
 * @property {Device | null} device  null: none, or it is lost
 * @property {Device | null} known   the same, also while it is lost
 * @property {number} axis
 * @property {Design} design         of this axis, or the one in view where the device can't have those of all axes
 * @property {number} axisId         of the page's axis that has this design
 * @property {string} inTheWay       why nothing can be asked of the device now; empty: something can
 * @property {string} notAtRest      why nothing can be begun; empty: it is at rest
 * @property {import('../../model/types.js').Situation} situation */

/** The part of the panel for one kind of work.
 * @typedef {object} Section
 * @property {HTMLElement} element
 * @property {(context: Context) => void} show
 * @property {(rejections: import('../../model/types.js').Rejection[]) => import('../../model/types.js').Rejection[]} [reject]
 *   shows those that it has a field for and returns the others */

/** Whether a device can do what only some can; until it is known of a device, whether any can.
 * @param {Device | null} device @param {import('../../model/types.js').Capability} what */
export function can(device, what) {
  return device === null || device.state === 'connecting' || device.capabilities.includes(what);
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
