// @ts-check
// STOP: a press slows every motor down along its ramp. Only while all that may move has been stopped so, another one
// halts what still slows down.

import { api } from '../server/api.js';
import { isMoving, isOutOfReach } from './out_of_reach.js';

/** @typedef {import('../model/types.js').Device} Device */

/** What has become of STOP: the worst of the presses that nobody has answered yet.
 * @typedef {'answered' | 'waiting' | 'undelivered'} Fate */

/** A press that was not answered, nor any after it. The answer to a later one holds for it, too; that to an earlier one
 * says nothing of it. meantFor: what was known of then.
 * @typedef {{number: number, meantFor: Device[], fate: 'under way' | 'waiting' | 'undelivered'}} Press */

/** So long a stop is taken to be on its way, and nothing is said. */
const UNANSWERED_MS = 1_000;
/** From then on nobody waits for an answer with the motor running; one that comes all the same counts. */
const HOPELESS_MS = 3_000;
const NOBODY_KNOWS = 'nobody knows whether anything stops.';
const CUT_POWER = 'Cut the motor’s power.';

/**
 * @param {object} fleet
 * @param {() => Device[]} fleet.devices as last heard of
 * @param {() => void} fleet.endMotions nothing of what was asked for until now is sent any more
 * @param {(devices: Device[]) => void} fleet.hearStops what a stop's answer tells
 * @param {(text: string) => void} tell
 */
export function createStop({ devices, endMotions, hearStops }, tell) {
  /** Each device as it was when it was first pressed for, until it rests.
   * @type {Map<string, Device>} */
  const pressedAt = new Map();
  /** @type {Press[]} */
  let unanswered = [];
  let last = 0;

  /** @returns {Fate} */
  function fate() {
    const fates = unanswered.map((press) => press.fate);
    return fates.includes('undelivered') ? 'undelivered' : fates.includes('waiting') ? 'waiting' : 'answered';
  }

  /** Whether the device itself tells that it was stopped since the press.
   * @param {Device} device */
  const isStopped = (device) => device.stops > (pressedAt.get(device.id)?.stops ?? Infinity);
  /** What slows down for another reason, as a jog that was let go, has not been stopped.
   * @param {Device} device */
  const slowsDown = (device) => device.state === 'stopping' && isStopped(device);
  /** @param {Device} device */
  const isYetToStop = (device) => (isMoving(device) && !slowsDown(device)) || (isOutOfReach(device) && !isStopped(device));
  const isHaltNext = () => devices().some(slowsDown) && !devices().some(isYetToStop);

  /** Whatever may move: what sets out just now is not known to move yet.
   * @returns {Promise<string>} what has come of it */
  async function halt() {
    const ids = devices().map((device) => device.id);
    const answers = await Promise.allSettled(ids.map((id) => api.halt(id)));
    const inReach = devices().filter((device) => !isOutOfReach(device));
    for (const answer of answers) if (answer.status === 'fulfilled') hearStops(answer.value.devices);
    answers.forEach((answer, index) => {
      // What is out of reach can only refuse, and is owed the stop from then on.
      if (answer.status === 'rejected' && inReach.some(({ id }) => id === ids[index])) throw answer.reason;
    });
    return ['Halted', ...unreached(devices())].join('. ');
  }

  async function slowDown() {
    const { devices: stopped } = await api.stopAll();
    hearStops(stopped);
    return words(stopped);
  }

  return {
    /** Whether a press halts. */
    isHaltNext,
    isStopped,
    fate,
    /** Take note of what rests: it has to be stopped anew.
     * @param {Device[]} told */
    follow(told) {
      for (const [id, known] of pressedAt) {
        const device = told.find((one) => isSame(known, one));
        if (!device || (device.state === 'ready' && isStopped(device))) pressedAt.delete(id);
      }
      unanswered = unanswered.filter((press) => press.fate === 'under way' || !areAtRest(press.meantFor, told));
    },
    /** The server is gone: what is told next may be another's, which knows of no stop before. */
    leave: () => pressedAt.clear(),
    async press() {
      const act = isHaltNext() ? halt : slowDown;
      for (const device of devices()) if (!pressedAt.has(device.id)) pressedAt.set(device.id, device);
      endMotions();
      last += 1;
      /** @type {Press} */
      const press = { number: last, meantFor: devices(), fate: 'under way' };
      unanswered.push(press);
      /** @param {Press['fate']} becomes @param {string} text */
      function worsen(becomes, text) {
        if (!unanswered.includes(press)) return;
        press.fate = becomes;
        tell(text);
      }
      const timers = [
        setTimeout(() => worsen('waiting', `STOP is not answered yet: ${NOBODY_KNOWS}`), UNANSWERED_MS),
        setTimeout(() => worsen('undelivered', `STOP is not answered: ${NOBODY_KNOWS} ${CUT_POWER}`), HOPELESS_MS),
      ];
      try {
        const text = await act();
        unanswered = unanswered.filter(({ number }) => number > press.number);
        // What was answered earlier says nothing of a later press that is not delivered.
        if (fate() === 'answered') tell(text);
      } catch (error) {
        const told = error instanceof Error ? error.message : String(error);
        worsen('undelivered', `STOP did not get through: ${told.replace(/\.$/, '')}. ${CUT_POWER}`);
      } finally {
        timers.forEach(clearTimeout);
      }
    },
  };
}

/** Whether what is told now is the device that was known, at the port where it was.
 * @param {Device} known @param {Device} told */
const isSame = (known, { id, port }) => known.id === id && known.port === port;

/** Whether all that was known says itself that it rests: what is at the same port, also by another server. While nothing
 * was known, nothing can say so.
 * @param {Device[]} known @param {Device[]} told */
const areAtRest = (known, told) =>
  known.length > 0 && known.every(({ port }) => told.some((device) => device.port === port && rests(device)));

/** Whether nothing of it moves, nor will by itself: what goes there and back only pauses.
 * @param {Device} device */
const rests = ({ state, shuttle }) => !shuttle && (state === 'ready' || state === 'writing');

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
