// @ts-check
// What a device is said to be doing.

/** @typedef {import('../model/types.js').Device} Device */

/** What to do about an axis of which it isn't known where it is. */
export const SET_POSITION = 'Look where each axis is, then set its position under Jog.';

/** What rests at an end of its way there and back sets out again by itself: it is not ready for a hand. What is started anew
 * from here is waited for as what is connected is, but for a reason.
 * @param {Device | null} device @returns {string} */
export function shownState(device) {
  if (device === null) return 'none';
  if (device.state === 'connecting' && device.proving) return 'restarting';
  return device.state === 'ready' && device.shuttle ? 'pausing' : device.state;
}

/** How far it has come there and back, and that it goes on; empty: it doesn't.
 * @param {Device | null} device */
export function shuttleText(device) {
  if (!device?.shuttle) return '';
  const { times, times_done, pause_s } = device.shuttle;
  const again = shownState(device) === 'pausing' ? ` It sets out again by itself, ${pause_s} s after it came to rest.` : '';
  return `There and back: ${times_done} of ${times} done.${again} STOP ends it, also in a pause.`;
}
