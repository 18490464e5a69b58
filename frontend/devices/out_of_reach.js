// @ts-check
// Devices that are out of reach: nobody knows whether they move, and a board with a supply of its own may go on.

/** @typedef {import('../model/types.js').Device} Device */

/** @param {Device} device */
export const isMoving = (device) => device.state === 'moving' || device.state === 'stopping';
/** @param {Device} device */
export const isOutOfReach = (device) => device.state === 'lost' || device.state === 'connecting';
/** Whether the device moves, or had not arrived when it was last heard of.
 * @param {Device} device */
export const mayMove = (device) =>
  isMoving(device) ||
  (isOutOfReach(device) && device.axes.some((axis) => axis.target_steps !== axis.position_steps));

/** Follows which devices moved when they were last heard of. */
export function createOutOfReach() {
  /** By id, the port where it has to be; null: wherever. A server knows a device by its id at any port, but another server
   * gives ids anew.
   * @type {Map<string, string | null>} */
  const moving = new Map();
  /** @param {Device} device */
  const hasMoved = ({ id, port }) => moving.has(id) && (moving.get(id) ?? port) === port;

  return {
    /** The server is gone: what is told next may be another's.
     * @param {Device[]} devices as last heard of */
    leave(devices) {
      for (const { id, port } of devices) if (moving.has(id)) moving.set(id, port);
    },
    /** Take note of all devices, as the server tells of them.
     * @param {Device[]} devices */
    follow(devices) {
      for (const device of devices) {
        // A page that was not there when it was lost sees that it had not arrived.
        if (mayMove(device)) moving.set(device.id, null);
        else if (!isOutOfReach(device)) moving.delete(device.id);
      }
      for (const id of moving.keys()) {
        const isThere = devices.some((device) => device.id === id && hasMoved(device));
        if (isThere) moving.set(id, null);
        else moving.delete(id);
      }
    },
    /** Whether a stop was pressed for of one that may move, and did not get to it.
     * @param {Device[]} devices @param {(device: Device) => boolean} isStopped */
    isUndelivered: (devices, isStopped) =>
      devices.some((device) => isOutOfReach(device) && hasMoved(device) && isStopped(device)),
    /** What has to be known of those that may move; empty when there are none.
     * @param {Device[]} devices @param {(device: Device) => boolean} isStopped whether a stop of it is owed */
    words(devices, isStopped) {
      const sentences = devices.filter(isOutOfReach).map((device) => {
        if (isStopped(device)) return `${device.name} is out of reach: it is stopped as soon as it answers.`;
        if (!hasMoved(device)) return '';
        return `${device.name} is out of reach since it moved, and may still move. STOP stops it as soon as it answers.`;
      });
      return sentences.filter(Boolean).join(' ');
    },
  };
}
