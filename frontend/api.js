// @ts-check
// The only module that talks to the server.

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Device} Device */
/** @typedef {import('./types.js').MethodName} MethodName */
/** @typedef {import('./types.js').Rejection} Rejection */

const ANSWER_WITHIN_MS = 15_000;
const PUSH_WITHIN_MS = 90_000;
const FIRST_RECONNECT_MS = 250;
const LONGEST_RECONNECT_MS = 2_000;

/** The server understood and said no: one rejection or more. */
export class Refusal extends Error {
  /** @param {number} status @param {Rejection[]} rejections */
  constructor(status, rejections) {
    super(rejections.map((rejection) => rejection.message).join(' '));
    this.status = status;
    this.rejections = rejections;
  }
}

/** The server can't be reached, or its answer makes no sense. */
export class ServerGone extends Error {}

/** @param {string} path */
function address(path) {
  return new URL(`api/v1/${path}`, document.baseURI);
}

/**
 * @param {'GET' | 'POST' | 'DELETE'} method
 * @param {string} path
 * @param {unknown} [body]
 * @param {number} [withinMs]
 * @returns {Promise<any>}
 */
async function request(method, path, body, withinMs = ANSWER_WITHIN_MS) {
  const options =
    body === undefined ? {} : { headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body) };
  let response, answer;
  try {
    response = await fetch(address(path), { method, ...options, signal: AbortSignal.timeout(withinMs) });
    answer = await response.json();
  } catch (error) {
    throw new ServerGone(`The server does not answer (${error instanceof Error ? error.message : error}).`);
  }
  if (response.ok) return answer;
  const rejections = answer?.errors ?? [
    { field: null, value: null, allowed: null, message: `The server answers with status ${response.status}.` },
  ];
  throw new Refusal(response.status, rejections);
}

export const api = {
  /** @returns {Promise<{examples: import('./types.js').Example[]}>} */
  examples: () => request('GET', 'examples'),

  /** @param {Design} design @param {number} maxPoints @returns {Promise<import('./types.js').Profile>} */
  profile: (design, maxPoints) => request('POST', 'profile', { design, max_points: maxPoints }),

  /** @param {Design} design @param {MethodName[]} methods @param {MethodName} reference @param {number} maxPoints
   * @returns {Promise<{methods: import('./types.js').ErrorCurve[]}>} */
  errors: (design, methods, reference, maxPoints) =>
    request('POST', 'errors', { design, methods, reference, max_points: maxPoints }),

  /** @returns {Promise<{ports: import('./types.js').Port[]}>} */
  ports: () => request('GET', 'ports'),

  /** @param {string} port @returns {Promise<Device>} */
  connect: (port) => request('POST', 'devices', { port }),

  /** @param {string} id */
  disconnect: (id) => request('DELETE', `devices/${encodeURIComponent(id)}`),

  /** @param {string} id @param {Design} design @returns {Promise<import('./types.js').Push>} */
  push: (id, design) => request('POST', `devices/${encodeURIComponent(id)}/push`, { design }, PUSH_WITHIN_MS),

  /** @param {string} id @param {{by_steps: unknown} | {to_steps: unknown}} move @returns {Promise<Device>} */
  move: (id, move) => request('POST', `devices/${encodeURIComponent(id)}/move`, move),

  /** @param {string} id @returns {Promise<Device>} */
  halt: (id) => request('POST', `devices/${encodeURIComponent(id)}/halt`),

  /** @returns {Promise<{devices: Device[]}>} */
  stopAll: () => request('POST', 'devices/stop'),
};

/**
 * Hear of every change of the devices, for as long as the page lives; reconnects by itself.
 * @param {(devices: Device[]) => void} onDevices
 * @param {(isConnected: boolean) => void} onLink
 */
export function watchDevices(onDevices, onLink) {
  let waitMs = FIRST_RECONNECT_MS;
  const open = () => {
    const url = address('devices/events');
    url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = new WebSocket(url);
    socket.onopen = () => {
      waitMs = FIRST_RECONNECT_MS;
      onLink(true);
    };
    socket.onmessage = (event) => onDevices(JSON.parse(event.data).devices);
    socket.onclose = () => {
      onLink(false);
      setTimeout(open, waitMs);
      waitMs = Math.min(LONGEST_RECONNECT_MS, waitMs * 2);
    };
  };
  open();
}
