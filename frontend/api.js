// @ts-check
// The only module that talks to the server.

import { createConversation } from './conversation.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Device} Device */
/** @typedef {import('./types.js').Rejection} Rejection */
/** @typedef {import('./types.js').FitWish} FitWish */

const ANSWER_WITHIN_MS = 15_000;
const PUSH_WITHIN_MS = 90_000;
const EXPORT_WITHIN_MS = 60_000;
const FIRST_RECONNECT_MS = 250;
const LONGEST_RECONNECT_MS = 2_000;
/** The status of what is understood but can't be done. */
const UNPROCESSABLE = 422;

/** What this page calls itself: the server knows by it which page is in control of a device. */
export const PAGE = crypto.randomUUID();

const aborting = /** @type {typeof AbortSignal & {timeout: (ms: number) => AbortSignal}} */ (AbortSignal);

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
 * @param {'GET' | 'POST' | 'PUT' | 'DELETE'} method
 * @param {string} path
 * @param {unknown} [body]
 * @param {number} [withinMs]
 * @param {(response: Response) => Promise<any>} [read] what makes the answer of a response that is no refusal
 * @returns {Promise<any>}
 */
async function request(method, path, body, withinMs = ANSWER_WITHIN_MS, read = readJson) {
  const headers = { 'X-StepRamp-Page': PAGE };
  const options =
    body === undefined
      ? { headers }
      : { headers: { ...headers, 'Content-Type': 'application/json' }, body: JSON.stringify(body) };
  let response, answer;
  try {
    response = await fetch(address(path), { method, ...options, signal: aborting.timeout(withinMs) });
    answer = await (response.ok ? read : readJson)(response);
  } catch (error) {
    throw new ServerGone(`The server does not answer (${error instanceof Error ? error.message : error}).`);
  }
  if (response.ok) return answer;
  const rejections = answer?.errors ?? [
    { field: null, value: null, allowed: null, message: `The server answers with status ${response.status}.` },
  ];
  throw new Refusal(response.status, rejections);
}

/** @param {Response} response */
function readJson(response) {
  return response.json();
}

/** @param {Response} response @returns {Promise<{file: Blob, name: string}>} */
async function readFile(response) {
  const name = /filename="([^"]+)"/.exec(response.headers.get('Content-Disposition') ?? '')?.[1] ?? 'stepramp';
  return { file: await response.blob(), name };
}

const sliding = createConversation(() => socketAddress('curves/socket'), ANSWER_WITHIN_MS);

export const api = {
  /** @returns {Promise<{examples: import('./types.js').Example[]}>} */
  examples: () => request('GET', 'examples'),

  /** @param {object} wanted a design, methods, and what is to be drawn of them
   * @returns {Promise<import('./types.js').DrawnCurves>} */
  curves: (wanted) => request('POST', 'curves', wanted),

  /** The same, quicker: for a slider that moves.
   * @param {object} wanted @returns {Promise<import('./types.js').DrawnCurves>} */
  async movingCurves(wanted) {
    const text = await sliding.ask(wanted);
    if (text === null) return api.curves(wanted);
    const answer = JSON.parse(text);
    if (answer.errors) throw new Refusal(UNPROCESSABLE, answer.errors);
    return answer;
  },

  /** @param {Design[]} designs @param {'independent' | 'line'} mode @param {number} maxPoints
   * @returns {Promise<import('./types.js').ScheduledAxes>} */
  schedule: (designs, mode, maxPoints) => request('POST', 'schedule', { designs, mode, max_points: maxPoints }),

  /** @param {Design} design @param {FitWish} wish @returns {Promise<import('./types.js').FittedTable>} */
  fitTable: (design, wish) => request('POST', 'table/fit', { design, ...wish }),

  /** @param {Design} design @param {{row_kind: string, interval_unit: string}} kind
   * @returns {Promise<import('./types.js').FitCurve>} */
  fitCurve: (design, kind) => request('POST', 'table/fit/curve', { design, ...kind }),

  /** @param {object} table rows, interval_unit, frequency_hz and slew_interval_us
   * @returns {Promise<{findings: {row: number, reason: string, wrong: boolean}[]}>} */
  checkTable: (table) => request('POST', 'table/check', table),

  /** @param {string} format @param {Record<string, unknown>} wanted the design, and what the format looks at besides
   * @returns {Promise<{file: Blob, name: string}>} */
  exportDesign: (format, wanted) => request('POST', `export/${format}`, wanted, EXPORT_WITHIN_MS, readFile),

  /** @param {object} play table, range_steps and targets @returns {Promise<import('./types.js').PlayedTable>} */
  playTable: (play) => request('POST', 'table/play', play),

  /** @returns {Promise<{ports: import('./types.js').Port[]}>} */
  ports: () => request('GET', 'ports'),

  /** @param {string} port @returns {Promise<Device>} */
  connect: (port) => request('POST', 'devices', { port }),

  /** @param {string} id */
  disconnect: (id) => request('DELETE', `devices/${encodeURIComponent(id)}`),

  /** @param {string} id @param {import('./types.js').Pushed} wanted @returns {Promise<import('./types.js').Push>} */
  push: (id, wanted) => request('POST', `devices/${encodeURIComponent(id)}/push`, wanted, PUSH_WITHIN_MS),

  /** What a push would change; nothing is sent.
   * @param {string} id @param {import('./types.js').Pushed} wanted @returns {Promise<import('./types.js').Preview>} */
  preview: (id, wanted) => request('POST', `devices/${encodeURIComponent(id)}/push/preview`, wanted, PUSH_WITHIN_MS),

  /** Have a device do something else that has a route of its own.
   * @param {string} id
   * @param {'move' | 'run' | 'line' | 'there_and_back' | 'position' | 'zero' | 'halt' | 'keep' | 'roll_back' |
   *   'restore' | 'control'} what
   * @param {unknown} [body] @returns {Promise<Device>} */
  act: (id, what, body) => request('POST', `devices/${encodeURIComponent(id)}/${what}`, body, PUSH_WITHIN_MS),

  /** @param {string} id @returns {Promise<import('./types.js').Settings>} */
  settings: (id) => request('GET', `devices/${encodeURIComponent(id)}/settings`),

  /** @param {string} id @param {unknown} settings @returns {Promise<import('./types.js').Settings>} */
  useSettings: (id, settings) => request('PUT', `devices/${encodeURIComponent(id)}/settings`, settings),

  /** Have the moves of an axis traced that begin from now on.
   * @param {string} id @param {number} axis */
  traceMoves: (id, axis) => request('PUT', `devices/${encodeURIComponent(id)}/trace`, { traced_axis: axis }),

  /** @param {string} id @returns {Promise<import('./types.js').Trace>} */
  trace: (id) => request('GET', `devices/${encodeURIComponent(id)}/trace`),

  /** @returns {Promise<{devices: Device[]}>} */
  stopAll: () => request('POST', 'devices/stop'),
};

/** @param {string} path */
function socketAddress(path) {
  const url = address(path);
  url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
  url.searchParams.set('page', PAGE);
  return url;
}

/** The socket that a jog lives in: the axis slows down when it ends, or when nothing is said over it for 0.4 s.
 * @param {string} id */
export function openJog(id) {
  return new WebSocket(socketAddress(`devices/${encodeURIComponent(id)}/jog`));
}

/**
 * Hear of every change of the devices, for as long as the page lives; reconnects by itself.
 * @param {(devices: Device[]) => void} onDevices
 * @param {(isConnected: boolean) => void} onLink
 */
export function watchDevices(onDevices, onLink) {
  let waitMs = FIRST_RECONNECT_MS;
  const open = () => {
    const socket = new WebSocket(socketAddress('devices/events'));
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
