// @ts-check
// The socket over which the server tells of every change of the devices. It can be stopped over it, too: it is open
// already, and waits for nothing else that the browser asks of the server.

/** @typedef {import('../model/types.js').Device} Device */
/** @typedef {{do: 'stop' | 'halt', device: string | null}} Stop  device: which one; null: all */
/** @typedef {import('../model/types.js').Link} Link */
/** @typedef {{resolve: (told: {devices: Device[]}) => void, reject: (error: Error) => void}} Waiting */

const FIRST_RECONNECT_MS = 250;
const LONGEST_RECONNECT_MS = 2_000;
/** The server tells of the devices every second, whether they have changed or not. When nothing is heard for so many
 * ticks, what is known of them is old. Ticks and not the time of day: a page that was held up itself has heard nothing
 * either, but has ticked only once. */
const TICK_MS = 500;
const SILENT_TICKS = 8;

/** @param {() => URL} address
 * @param {() => Promise<boolean>} isUnknown  whether the server is there and does not know this page: a browser doesn't
 *   tell why a socket was refused */
export function createEvents(address, isUnknown) {
  /** @type {WebSocket | null} */
  let socket = null;
  let last = 0;
  /** Stops that have not been answered yet, by number.
   * @type {Map<number, Waiting>} */
  const waiting = new Map();

  /** @param {{did: {number: number}, devices?: Device[], errors?: {message: string}[]}} told */
  function settle({ did, devices, errors }) {
    if (devices) waiting.get(did.number)?.resolve({ devices });
    else waiting.get(did.number)?.reject(new Error(errors?.map(({ message }) => message).join(' ')));
    waiting.delete(did.number);
  }

  function giveUp() {
    for (const { reject } of waiting.values()) reject(new Error('The socket was closed.'));
    waiting.clear();
  }

  return {
    /** Hear of every change, for as long as the page lives; reconnects by itself.
     * @param {(devices: Device[]) => void} onDevices
     * @param {(link: Link) => void} onLink */
    watch(onDevices, onLink) {
      let waitMs = FIRST_RECONNECT_MS;
      let ticks = 0;
      /** @type {Link} */
      let without = 'gone';
      const askWhy = async () => {
        without = (await isUnknown()) ? 'unknown' : 'gone';
        if (socket?.readyState !== WebSocket.OPEN) onLink(without);
      };
      const hear = () => {
        ticks = 0;
        onLink('there');
      };
      setInterval(() => {
        ticks += 1;
        if (ticks >= SILENT_TICKS && socket?.readyState === WebSocket.OPEN) onLink('silent');
      }, TICK_MS);
      const open = () => {
        const opened = new WebSocket(address());
        socket = opened;
        let wasOpen = false;
        opened.onopen = () => {
          wasOpen = true;
          without = 'gone';
          waitMs = FIRST_RECONNECT_MS;
          hear();
        };
        opened.onmessage = (event) => {
          const told = JSON.parse(event.data);
          if ('did' in told) settle(told);
          else {
            hear();
            onDevices(told.devices);
          }
        };
        opened.onclose = () => {
          giveUp();
          onLink(without);
          if (!wasOpen) askWhy();
          setTimeout(open, waitMs);
          waitMs = Math.min(LONGEST_RECONNECT_MS, waitMs * 2);
        };
      };
      open();
    },

    /** Stop or halt; fails at once when the socket is not open, and when it ends. Until then an answer may come, however
     * late, and is told.
     * @param {Stop} stop @returns {Promise<{devices: Device[]}>} what they do once it is granted */
    stop(stop) {
      const present = socket;
      if (present?.readyState !== WebSocket.OPEN) return Promise.reject(new Error('The socket is not open.'));
      return new Promise((resolve, reject) => {
        last += 1;
        waiting.set(last, { resolve, reject });
        present.send(JSON.stringify({ ...stop, number: last }));
      });
    },
  };
}
