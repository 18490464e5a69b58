// @ts-check
// What somebody asked for, as long as no STOP came after it: a STOP ends at once whatever is on its way, and what is
// already at the server carries the number of stops that were known when it was asked for.

/** @typedef {import('../model/types.js').Device} Device */

/** A press that sets motors moving.
 * @typedef {{stops: number, ended: AbortSignal}} Gesture  stops: of the device, as known then. ended: by a STOP */

export function createGestures() {
  let present = new AbortController();
  /** By device.
   * @type {Map<string, number>} */
  const stops = new Map();

  return {
    /** @param {Device} device @returns {Gesture} */
    begin: (device) => ({ stops: stops.get(device.id) ?? device.stops, ended: present.signal }),
    /** Nothing of what was asked for until now is sent any more, whatever becomes of the STOP. */
    end() {
      present.abort();
      present = new AbortController();
    },
    /** Note the stops that the server tells of. What is told may be older than what is known.
     * @param {Device[]} devices */
    hear(devices) {
      for (const device of devices) stops.set(device.id, Math.max(device.stops, stops.get(device.id) ?? 0));
    },
    /** Another server knows of other stops. */
    forget: () => stops.clear(),
  };
}

/** @typedef {ReturnType<typeof createGestures>} Gestures */
