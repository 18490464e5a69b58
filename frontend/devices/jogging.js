// @ts-check
// Jogging: an axis runs while a finger or a key holds it. The server slows it down by itself when it is no longer told
// to go on, so that nothing that happens to this page, its tab or the connection keeps a motor running.

import { openJog } from '../server/api.js';

/** @typedef {import('../model/types.js').Device} Device */
/** @typedef {import('../model/types.js').Rejection} Rejection */

/** The server waits four times as long. */
const RENEW_MS = 100;
/** The code of a socket that was closed since it had done what it was for. */
const WELL_ENDED = 1000;

/** @param {import('../server/gestures.js').Gestures} gestures @param {(rejections: Rejection[]) => void} onRefused */
export function createJog(gestures, onRefused) {
  /** @type {WebSocket | null} */
  let socket = null;
  let timer = 0;

  function end() {
    clearInterval(timer);
    const ending = socket;
    socket = null;
    if (ending === null) return;
    // What has not been opened yet says nothing, and so nothing begins.
    if (ending.readyState === WebSocket.OPEN) ending.send(JSON.stringify({ do: 'end' }));
    ending.close();
  }

  /** @param {Device} device @param {number} axis @param {unknown} speed steps/s, negative for backwards */
  function begin(device, axis, speed) {
    end();
    onRefused([]); // It was about what was asked before.
    const { stops } = gestures.begin(device);
    const opened = openJog(device.id);
    socket = opened;
    opened.onopen = () => {
      if (socket !== opened) return;
      opened.send(JSON.stringify({ do: 'run', axis, speed_steps_per_s: speed, stops }));
      timer = setInterval(() => opened.send(JSON.stringify({ do: 'hold' })), RENEW_MS);
    };
    opened.onmessage = (event) => {
      onRefused(JSON.parse(event.data).errors);
      if (socket === opened) end();
    };
    opened.onclose = ({ code, reason }) => {
      if (socket !== opened) return;
      end();
      if (code === WELL_ENDED) return;
      const message = `The jog has ended: the connection was closed${reason === '' ? '' : ` (${reason})`}.`;
      onRefused([{ field: null, value: null, allowed: null, message }]);
    };
  }

  addEventListener('blur', end);
  addEventListener('pagehide', end);
  document.addEventListener('visibilitychange', () => document.hidden && end());
  return { begin, end, isHeld: () => socket !== null };
}
