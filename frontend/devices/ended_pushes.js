// @ts-check
// Pushes on whose way a STOP came: what became of them, which only what is told of the device afterwards says.

import { areEqual } from '../model/equal.js';

/** @typedef {import('../model/types.js').Device} Device */
/** done: it went on to its end. none: nothing was written. open: it was being written, and there is no report of it.
 * @typedef {'done' | 'differs' | 'none' | 'open'} Outcome */

/** What is said until more is known. */
export const PUSH_STOPPED = 'STOP came during the push. What was being written already is written whole, and nothing after it.';
/** @type {Record<Outcome, string>} */
export const PUSH_OUTCOMES = {
  done: 'STOP came too late for the push, which went on to its end: all is written, and read back as sent.',
  differs: 'STOP came too late for the push, which went on to its end: what was read back is not what was sent.',
  none: 'STOP ended the push before anything was written: the controller has what it had.',
  open: 'STOP ended the push while it was being written, before it was read back: what a push would change shows what the controller has.',
};

/** So long after the device rests its report may still come. */
export const REPORT_WITHIN_MS = 1_000;

/** @param {() => number} now_ms */
export function createEndedPushes(now_ms) {
  /** By device, how it was before the push.
   * @type {Map<string, {before: Device, wasWriting: boolean, restsSince: number | null}>} */
  const awaited = new Map();

  /** @param {Device} device @returns {Outcome | null} null: not known yet */
  function outcomeOf(device) {
    const one = awaited.get(device.id);
    if (one === undefined) return null;
    const { before } = one;
    if (device.pushed !== null && !areEqual(device.pushed, before.pushed)) return device.pushed.verified ? 'done' : 'differs';
    one.wasWriting ||= device.state === 'writing';
    // Until the stop itself is told, what is told may be from before it.
    const rests = device.state !== 'writing' && device.progress === null && device.stops > before.stops;
    one.restsSince = rests ? (one.restsSince ?? now_ms()) : null;
    if (one.restsSince === null || now_ms() - one.restsSince < REPORT_WITHIN_MS) return null;
    const hasSameRamp = device.ramp !== null && areEqual(device.ramp, before.ramp);
    return one.wasWriting && !hasSameRamp ? 'open' : 'none';
  }

  return {
    /** @param {Device} before how the device was when the push was asked for
     * @param {boolean} wasWriting whether it is writing by now */
    await(before, wasWriting) {
      awaited.set(before.id, { before, wasWriting, restsSince: null });
    },
    /** Another push of it was asked for: what is told from then on is of that.
     * @param {string} id of the device */
    forget: (id) => awaited.delete(id),
    /** What has become known; each is told once.
     * @param {Device[]} told @returns {Outcome[]} */
    follow(told) {
      for (const id of awaited.keys()) {
        const device = told.find((one) => one.id === id);
        // A loss is told in words of its own.
        if (device === undefined || device.state === 'lost' || device.state === 'connecting') awaited.delete(id);
      }
      return told.flatMap((device) => {
        const outcome = outcomeOf(device);
        if (outcome === null) return [];
        awaited.delete(device.id);
        return [outcome];
      });
    },
    isAwaiting: () => awaited.size > 0,
  };
}
