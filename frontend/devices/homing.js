// @ts-check
// Homing: how far it may lead, and what has come of it.

/** @typedef {import('../model/types.js').Device} Device */

/** How one axis is homed. fast_steps_per_s: negative for the switch of its low end.
 * @typedef {{axis: number, fast_steps_per_s: number, position_steps: number}} AxisHome */
/** What is asked of a device.
 * @typedef {{axes: AxisHome[], slow_steps_per_s: number, back_off_steps: number, for_s: number}} HomeWish */
/** @typedef {'homed' | 'stopped' | 'emergency' | 'pressed' | 'not found' | 'lost'} Outcome */
/** A homing that this page began. stops, heard_s: of the device as it set out. outcomes: of each axis; null: it goes on.
 * @typedef {{wish: HomeWish, stops: number, heard_s: number, outcomes: Outcome[] | null}} Homing */

/** How many steps an axis makes at most until its time is over: then it slows down.
 * @param {HomeWish} wish @param {AxisHome} one */
export const farthestSteps = ({ slow_steps_per_s: slow, for_s }, { fast_steps_per_s: fast }) =>
  Math.ceil(Math.max(Math.abs(fast), slow) * for_s);

/** A homing after what is told of its device; the same one where nothing is new of it.
 * @param {Homing} homing @param {Device} device @returns {Homing} */
export function homingAfter(homing, device) {
  if (homing.outcomes !== null || device.heard_s <= homing.heard_s) return homing;
  const { wish, stops } = homing;
  if (device.state === 'lost') return { ...homing, outcomes: wish.axes.map(() => 'lost') };
  const isOver = device.state === 'ready' && !device.axes.some((axis) => axis.homing);
  return isOver ? { ...homing, outcomes: wish.axes.map((one) => outcomeOf(one, device, stops)) } : homing;
}

/** @param {AxisHome} home @param {Device} device @param {number} stops as it set out @returns {Outcome} */
function outcomeOf({ axis, fast_steps_per_s: fast }, device, stops) {
  if (device.axes[axis]?.position_known) return 'homed';
  if ((device.stopped_by ?? []).length > 0) return 'emergency';
  if (device.stops !== stops) return 'stopped';
  return switchOf(device, axis, fast < 0 ? 'low' : 'high')?.is_active ? 'pressed' : 'not found';
}

/** The limit switch at an end of an axis, one that is active first.
 * @param {Device} device @param {number} axis @param {'low' | 'high'} end */
export function switchOf({ inputs }, axis, end) {
  const there = (inputs ?? []).filter((one) => one.role === 'limit' && one.axis === axis && one.end === end);
  return there.find(({ is_active }) => is_active) ?? there[0] ?? null;
}

/** What has come of an axis, and a way out.
 * @param {Outcome} outcome @param {AxisHome} home @param {HomeWish} wish @param {(steps: number) => string} length */
export function outcomeText(outcome, home, wish, length) {
  const end = home.fast_steps_per_s < 0 ? 'low' : 'high';
  const texts = {
    homed: `Axis ${home.axis} is homed: its switch is at ${length(home.position_steps)}.`,
    stopped: `Axis ${home.axis} is not homed: it was stopped.`,
    emergency: `Axis ${home.axis} is not homed: all axes were stopped. Acknowledge that first.`,
    pressed: `Axis ${home.axis} is not homed: the switch at its ${end} end is still pressed after ${wish.for_s} s, of which a part was to back off from it. Look whether it is stuck, and whether its level in the settings is right.`,
    'not found': `Axis ${home.axis} is not homed: the switch at its ${end} end was not found within ${wish.for_s} s. Look whether it is the right end, and give it more time or speed.`,
    lost: `Axis ${home.axis} is not homed, as far as is known: the device was lost.`,
  };
  return texts[outcome];
}
