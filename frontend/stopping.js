// @ts-check
// STOP: the first press slows every motor down along its ramp, a second one while they still slow down halts them.

import { api } from './api.js';

/** @typedef {import('./types.js').Device} Device */

/** @param {Device} device */
const isStopping = (device) => device.state === 'stopping';
/** @param {Device} device */
const isMoving = (device) => device.state === 'moving' || isStopping(device);
/** @param {Device} device */
const isOutOfReach = (device) => device.state === 'lost' || device.state === 'connecting';

/**
 * @param {object} fleet
 * @param {() => Device[]} fleet.devices as last heard of
 * @param {() => void} fleet.endMotions nothing of what was asked for until now is sent any more
 * @param {(devices: Device[]) => void} fleet.hearStops what a stop's answer tells
 * @param {(text: string, hasFailed: boolean) => void} say
 */
export function createStop({ devices, endMotions, hearStops }, say) {
  let unanswered = 0;

  const isUnderWay = () => unanswered > 0 || devices().some(isStopping);

  /** Whatever may move: what sets out just now is not known to move yet. */
  async function halt() {
    const inReach = devices().filter((device) => !isOutOfReach(device));
    if (inReach.length === 0) return slowDown();
    const answers = await Promise.all(inReach.map((device) => api.halt(device.id)));
    for (const answer of answers) hearStops(answer.devices);
    say('Halted', false);
  }

  async function slowDown() {
    const { devices: stopped } = await api.stopAll();
    hearStops(stopped);
    say(words(stopped), false);
  }

  return {
    isUnderWay,
    async press() {
      const act = isUnderWay() ? halt : slowDown;
      endMotions();
      unanswered += 1;
      try {
        await act();
      } catch (error) {
        say(`STOP did not get through: ${error instanceof Error ? error.message : error}`, true);
      } finally {
        unanswered -= 1;
      }
    },
  };
}

/** What has come of a stop. Of what is out of reach nobody knows whether it moves.
 * @param {Device[]} stopped */
function words(stopped) {
  const reached = stopped.filter((device) => !isOutOfReach(device));
  const others = stopped.filter(isOutOfReach).map((device) => device.name);
  const isStopped = reached.some(isMoving);
  if (others.length === 0) return isStopped ? 'Stopping' : 'Nothing moves';
  const what = isStopped ? 'Stopping. ' : reached.length > 0 ? 'What answers is at rest. ' : '';
  return `${what}Out of reach, stopped as soon as it answers: ${others.join(', ')}`;
}
