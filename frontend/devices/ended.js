// @ts-check
// Devices that moved when the server was last heard of, or were lost on their way, and of which the server that is back
// knows nothing: it is another one, and a board with a supply of its own may go on.

import { isMoving, mayMove } from './out_of_reach.js';

/** @typedef {import('../model/types.js').Device} Device */

/** @param {(device: Device) => boolean} outlives  whether the device goes on when its server ends */
export function createEnded(outlives) {
  /** @type {Device[]} */
  let left = [];

  return {
    /** The server is gone.
     * @param {Device[]} devices as last heard of */
    leave(devices) {
      const moving = devices.filter((device) => mayMove(device) && outlives(device));
      left = [...left.filter((one) => !moving.some(({ port }) => port === one.port)), ...moving];
    },
    /** Take note of what the server tells, once it is back: what a device says of itself counts.
     * @param {Device[]} devices */
    follow(devices) {
      left = left.filter((one) => !devices.some(({ port, axes }) => port === one.port && axes.length > 0));
    },
    /** What has to be known of those that may still move. */
    words: () =>
      left
        .map((device) => {
          const then = isMoving(device) ? 'the server ended' : 'it was lost';
          return `${device.name} (${device.port}) was moving when ${then}, and may still move: stop it once it is connected again, or cut the motor’s power.`;
        })
        .join(' '),
  };
}
