// @ts-check
// The devices as the server tells of them, and what is asked of them. Nothing here moves a motor unasked.

import { api, Refusal, watchDevices } from './api.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Device} Device */
/** @typedef {import('./types.js').Port} Port */
/** @typedef {import('./types.js').Rejection} Rejection */

/** What makes two designs the same ramp: all but the name. @param {Design} design */
function rampKey(design) {
  return JSON.stringify({ ...design, name: '' });
}

/**
 * @param {{onChange: () => void, onPorts: (ports: Port[]) => void, onRejected: (rejections: Rejection[]) => void,
 *   say: (text: string) => void, onLink: (isThere: boolean) => void}} handlers
 */
export function createFleet({ onChange, onPorts, onRejected, say, onLink }) {
  /** @type {Device[]} */
  let devices = [];
  let isServerThere = true;
  /** What is being asked of the device: "connect", "push" …; null: nothing. @type {string | null} */
  let asking = null;
  /** The ramp last pushed from this page, by device. @type {Map<string, string>} */
  const pushed = new Map();
  /** Where each device last was at rest: the moves that the plots follow begin there. @type {Map<string, number>} */
  const restingPlaces = new Map();

  /** @param {Device[]} known */
  function update(known) {
    for (const device of known) {
      const before = devices.find((one) => one.id === device.id);
      if (before?.state !== device.state) say(`${device.name}: ${device.state} at ${device.position_steps} steps`);
      if (device.state === 'ready') restingPlaces.set(device.id, device.position_steps);
    }
    devices = known;
    onChange();
  }

  /** Ask one thing at a time; what is refused is shown, never thrown. What an answer says of the device is not taken
   * from it: the events tell the same, and in order.
   * @param {string} what @param {() => Promise<unknown>} ask */
  async function request(what, ask) {
    if (asking !== null) return;
    asking = what;
    onRejected([]);
    onChange();
    try {
      await ask();
    } catch (error) {
      onRejected(
        error instanceof Refusal
          ? error.rejections
          : [
              {
                field: null,
                value: null,
                allowed: null,
                message: String(error instanceof Error ? error.message : error),
              },
            ],
      );
    } finally {
      asking = null;
      onChange();
    }
  }

  return {
    devices: () => devices,
    isServerThere: () => isServerThere,
    /** @param {Device | null} device @param {Design} design @param {boolean} isDesignValid
     * @returns {import('./types.js').Situation} */
    situation(device, design, isDesignValid) {
      const last = device ? pushed.get(device.id) : undefined;
      return {
        isServerThere,
        isDesignValid,
        isBusy: asking !== null,
        isPushing: asking === 'push',
        isChanged: last !== undefined && last !== rampKey(design),
      };
    },
    /** The move that runs, counted from its start and its end; null when nothing runs.
     * @param {Device | null} device @param {number} planned steps of the plotted move */
    runningMove(device, planned) {
      if (!device || (device.state !== 'moving' && device.state !== 'stopping')) return null;
      const remaining = Math.abs(device.target_steps - device.position_steps);
      const start = restingPlaces.get(device.id);
      const done = start === undefined ? Math.max(0, planned - remaining) : Math.abs(device.position_steps - start);
      return { done, remaining, speed: Math.abs(device.speed_steps_per_s) };
    },
    refreshPorts: () => request('ports', async () => onPorts((await api.ports()).ports)),
    /** @param {string} port */
    connect: (port) => request('connect', () => api.connect(port)),
    /** @param {Device} device */
    disconnect: (device) => request('disconnect', () => api.disconnect(device.id)),
    /** @param {Device} device @param {Design} design */
    push: (device, design) =>
      request('push', async () => {
        const report = await api.push(device.id, design);
        pushed.set(device.id, rampKey(design));
        say(
          report.verified
            ? `Ramp ${report.sequence} pushed and read back as sent`
            : 'The ramp read back is not the one sent',
        );
      }),
    /** @param {Device} device @param {{by_steps: unknown} | {to_steps: unknown}} move */
    move: (device, move) => request('move', () => api.move(device.id, move)),
    watch: () =>
      watchDevices(update, (isThere) => {
        if (isThere === isServerThere) return;
        isServerThere = isThere;
        onLink(isThere);
        onChange();
      }),
  };
}
