// @ts-check
// STOP: the first press slows every motor down along its ramp, a second one while they still slow down halts them.

import { api } from './api.js';

/** @typedef {import('./types.js').Device} Device */

/** @param {Device} device */
const isStopping = (device) => device.state === 'stopping';
/** @param {Device} device */
const isMoving = (device) => device.state === 'moving' || isStopping(device);

/**
 * @param {() => Device[]} devices as last heard of
 * @param {(text: string, hasFailed: boolean) => void} say
 */
export function createStop(devices, say) {
  let unanswered = 0;

  const isUnderWay = () => unanswered > 0 || devices().some(isStopping);

  /** What is not known to be at rest is stopped again. */
  async function halt() {
    const moving = devices().filter(isMoving);
    if (moving.length === 0) await api.stopAll();
    await Promise.all(moving.map((device) => api.act(device.id, 'halt')));
    say('Halted', false);
  }

  async function slowDown() {
    const { devices: stopped } = await api.stopAll();
    say(stopped.some(isMoving) ? 'Stopping' : 'Nothing moves', false);
  }

  return {
    isUnderWay,
    async press() {
      const act = isUnderWay() ? halt : slowDown;
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
