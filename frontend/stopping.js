// @ts-check
// STOP: a press slows every motor down along its ramp. Only while all that may move has been stopped so, another one
// halts what still slows down.

import { api } from './api.js';
import { isMoving, isOutOfReach } from './out_of_reach.js';

/** @typedef {import('./types.js').Device} Device */

/** So long a stop is taken to be on its way, and nothing is said. */
const UNANSWERED_MS = 1_000;

/**
 * @param {object} fleet
 * @param {() => Device[]} fleet.devices as last heard of
 * @param {() => void} fleet.endMotions nothing of what was asked for until now is sent any more
 * @param {(devices: Device[]) => void} fleet.hearStops what a stop's answer tells
 * @param {(text: string, hasFailed: boolean) => void} say
 */
export function createStop({ devices, endMotions, hearStops }, say) {
  /** The number of stops that each device had told of when it was first pressed for, until it rests.
   * @type {Map<string, number>} */
  const pressedAt = new Map();

  /** Whether the device itself tells that it was stopped since the press.
   * @param {Device} device */
  const isStopped = (device) => device.stops > (pressedAt.get(device.id) ?? Infinity);
  /** What slows down for another reason, as a jog that was let go, has not been stopped.
   * @param {Device} device */
  const slowsDown = (device) => device.state === 'stopping' && isStopped(device);
  /** @param {Device} device */
  const isYetToStop = (device) => (isMoving(device) && !slowsDown(device)) || (isOutOfReach(device) && !isStopped(device));
  const isHaltNext = () => devices().some(slowsDown) && !devices().some(isYetToStop);

  /** Whatever may move: what sets out just now is not known to move yet. */
  async function halt() {
    const ids = devices().map((device) => device.id);
    const answers = await Promise.allSettled(ids.map((id) => api.halt(id)));
    const inReach = devices().filter((device) => !isOutOfReach(device));
    for (const answer of answers) if (answer.status === 'fulfilled') hearStops(answer.value.devices);
    answers.forEach((answer, index) => {
      // What is out of reach can only refuse, and is owed the stop from then on.
      if (answer.status === 'rejected' && inReach.some(({ id }) => id === ids[index])) throw answer.reason;
    });
    say(['Halted', ...unreached(devices())].join('. '), false);
  }

  async function slowDown() {
    const { devices: stopped } = await api.stopAll();
    hearStops(stopped);
    say(words(stopped), false);
  }

  return {
    /** Whether a press halts. */
    isHaltNext,
    isStopped,
    /** Take note of what rests: it has to be stopped anew.
     * @param {Device[]} told */
    follow(told) {
      for (const id of pressedAt.keys()) {
        const device = told.find((one) => one.id === id);
        if (!device || (device.state === 'ready' && isStopped(device))) pressedAt.delete(id);
      }
    },
    async press() {
      const act = isHaltNext() ? halt : slowDown;
      for (const { id, stops } of devices()) if (!pressedAt.has(id)) pressedAt.set(id, stops);
      endMotions();
      const late = setTimeout(() => {
        say('STOP is not answered yet: nobody knows whether anything stops.', true);
      }, UNANSWERED_MS);
      try {
        await act();
      } catch (error) {
        say(`STOP did not get through: ${error instanceof Error ? error.message : error}`, true);
      } finally {
        clearTimeout(late);
      }
    },
  };
}

/** What has come of a stop. Of what is out of reach nobody knows whether it moves.
 * @param {Device[]} stopped */
function words(stopped) {
  const reached = stopped.filter((device) => !isOutOfReach(device));
  if (reached.some(isMoving)) return ['Stopping', ...unreached(stopped)].join('. ');
  if (reached.length === stopped.length) return 'Nothing moves';
  return [...(reached.length > 0 ? ['What answers is at rest'] : []), ...unreached(stopped)].join('. ');
}

/** @param {Device[]} stopped */
function unreached(stopped) {
  const names = stopped.filter(isOutOfReach).map((device) => device.name);
  return names.length === 0 ? [] : [`Out of reach, stopped as soon as it answers: ${names.join(', ')}`];
}
