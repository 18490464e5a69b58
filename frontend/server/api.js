// @ts-check
// All that is said to the server, but for its library (library.js), which says it through this one.

import { quoted } from '../model/quoted.js';
import { createConversation } from './conversation.js';
import { createEvents } from './events.js';
import { createGate } from './gate.js';
import { isReadable, upload } from './upload.js';

/** @typedef {import('../model/types.js').Design} Design */
/** @typedef {import('../model/types.js').Device} Device */
/** @typedef {import('../model/types.js').Rejection} Rejection */
/** @typedef {import('../model/types.js').FitWish} FitWish */
/** @typedef {import('./gestures.js').Gesture} Gesture */

const ANSWER_WITHIN_MS = 15_000;
const PUSH_WITHIN_MS = 90_000;
const EXPORT_WITHIN_MS = 60_000;
const PLAY_WITHIN_MS = 60_000;
/** Long moves are played many times until the fastest ramps are found. */
const SEARCH_WITHIN_MS = 60_000;
const CAPTURE_WITHIN_MS = 600_000;
/** A stop that is not answered so soon is said over the socket of events, too. */
const STOP_WITHIN_MS = 100;
/** Browsers have six connections to a server: some stay free, so that what stops does not stand in line. */
const MOST_REQUESTS = 4;
/** The status of what is understood but can't be done. */
export const UNPROCESSABLE = 422;
/** The status of what is asked by whom the server doesn't know. */
const UNAUTHORIZED = 401;
/** Whoever asks by other programs is told of other ways. */
export const UNKNOWN_PAGE = 'The server knows this page no more, as after a new start: open the link that it printed';
export const NOT_FOUND = 404;
/** The status of a change of what somebody else has changed meanwhile. */
export const CHANGED_MEANWHILE = 412;
/** No larger file is read [bytes]. */
const MOST_FILE_BYTES = 268_435_456;
/** From here on it is the server that can't, not the question that is wrong … */
const SERVER_ERROR = 500;
/** … or a device: there is news of it once it can. */
export const DEVICE_LOST = 502;

/** What this page calls itself: the server knows by it which page is in control of a device. */
export const PAGE = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, '0')).join('');

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

/** It was ended on the way, by somebody who knows. */
export class Ended extends Error {}

/** @param {string} path */
function address(path) {
  return new URL(`api/v1/${path}`, document.baseURI);
}

const gate = createGate(MOST_REQUESTS);

/** How a request differs from most.
 * @typedef {object} Manner
 * @property {number} [withinMs]
 * @property {(response: Response) => Promise<any>} [read] what makes the answer of a response that is no refusal
 * @property {Gesture} [gesture]    what it is a part of
 * @property {AbortSignal} [ended]  what ends it
 * @property {boolean} [isUrgent]   it stands in no line
 * @property {number} [version]     of what it is a change of: where that has another by now, it is refused (412) */

/**
 * @param {'GET' | 'POST' | 'PUT' | 'DELETE'} method
 * @param {string} path
 * @param {unknown} [body]
 * @param {Manner} [manner]
 * @returns {Promise<any>}
 */
export async function request(method, path, body, manner = {}) {
  const { withinMs = ANSWER_WITHIN_MS, read = readJson, gesture, ended = gesture?.ended, isUrgent = false, version } = manner;
  /** @type {Record<string, string>} */
  const headers = { 'X-StepRamp-Page': PAGE };
  if (gesture) headers['X-StepRamp-Stops'] = String(gesture.stops);
  if (version !== undefined) headers['If-Match'] = `"${version}"`;
  if (body !== undefined) headers['Content-Type'] = 'application/json';
  const options = { method, headers, body: body === undefined ? undefined : JSON.stringify(body) };
  const exchange = async (/** @type {AbortSignal} */ signal) => {
    const response = await fetch(address(path), { ...options, signal });
    return { response, answer: await (response.ok ? read : readJson)(response) };
  };
  let exchanged;
  try {
    exchanged = await within(withinMs, ended, (signal) => (isUrgent ? exchange(signal) : gate(() => exchange(signal))));
  } catch (error) {
    if (ended?.aborted) throw new Ended('It was ended.');
    throw new ServerGone(`The server does not answer (${error instanceof Error ? error.message : error}).`);
  }
  const { response, answer } = exchanged;
  if (response.ok) return answer;
  if (ended?.aborted) throw new Ended('It was ended.');
  throw refusalOf(response.status, answer);
}

/** @param {number} status @param {any} answer */
function refusalOf(status, answer) {
  if (status === UNAUTHORIZED) return new Refusal(status, [rejection(`${UNKNOWN_PAGE}.`)]);
  return new Refusal(status, answer?.errors ?? [rejection(`The server answers with status ${status}.`)]);
}

/** @param {string} message @param {string | null} [field] @returns {Rejection} */
const rejection = (message, field = null) => ({ field, value: null, allowed: null, message });

/** Have a file looked at. A server that can't answer now is one to ask again.
 * @param {string} path @param {File} file @param {AbortSignal} ended @param {import('./upload.js').OnSent} onSent
 * @param {number} [mostBytes]  no larger one is read
 * @returns {Promise<any>} */
export async function sendFile(path, file, ended, onSent, mostBytes = MOST_FILE_BYTES) {
  if (file.size > mostBytes) {
    const [size, limit] = [file.size, mostBytes].map((count) => count.toLocaleString('en-US'));
    throw new Refusal(UNPROCESSABLE, [rejection(`${quoted(file.name)} has ${size} bytes; at most ${limit} are read.`, 'file')]);
  }
  const headers = { 'X-StepRamp-Page': PAGE, 'Content-Type': 'application/octet-stream' };
  let sent;
  try {
    sent = await gate(() => upload(address(path), headers, file, { ended, withinMs: CAPTURE_WITHIN_MS, onSent }));
  } catch (error) {
    if (ended.aborted) throw new Ended('It was ended.');
    const message = `${quoted(file.name)} can’t be read any more: it has changed, or is gone. Open it again.`;
    if (!(await isReadable(file))) throw new Refusal(UNPROCESSABLE, [rejection(message, 'file')]);
    throw new ServerGone(`The server does not answer (${error instanceof Error ? error.message : error}).`);
  }
  const { status, answer } = sent;
  if (status >= 400 || answer === null) throw refusalOf(status, answer);
  return answer;
}

/** Do what a signal ends when it takes too long, or something else has ended; then it fails at once.
 * @template T @param {number} ms @param {AbortSignal | undefined} ended @param {(signal: AbortSignal) => Promise<T>} act
 * @returns {Promise<T>} */
async function within(ms, ended, act) {
  const end = new AbortController();
  const stop = () => end.abort(new Error('ended'));
  const timer = setTimeout(() => end.abort(new Error('it took too long')), ms);
  ended?.addEventListener('abort', stop);
  if (ended?.aborted) stop();
  const over = new Promise((_, reject) => {
    const fail = () => reject(end.signal.reason);
    end.signal.addEventListener('abort', fail);
    if (end.signal.aborted) fail();
  });
  try {
    return /** @type {T} */ (await Promise.race([over, act(end.signal)]));
  } finally {
    clearTimeout(timer);
    ended?.removeEventListener('abort', stop);
  }
}

/** @param {Response} response */
function readJson(response) {
  return response.json();
}

/** @param {Response} response @returns {Promise<{file: Blob, name: string}>} */
export async function readFile(response) {
  const name = /filename="([^"]+)"/.exec(response.headers.get('Content-Disposition') ?? '')?.[1] ?? 'stepramp';
  return { file: await response.blob(), name };
}

/** Whether the server is there, and does not know this page: it was started anew, with other links. */
async function isUnknown() {
  try {
    await request('GET', 'access', undefined, { isUrgent: true });
  } catch (error) {
    return isOfUnknown(error);
  }
  return false;
}

/** Of what the rotor does: none is looked at, and more than a dialog's chart can show. */
const FEWEST_POINTS = 10;
const ROTOR_POINTS = 2000;

const events = createEvents(() => socketAddress('devices/events'), isUnknown);
const sliding = createConversation(() => socketAddress('curves/socket'), ANSWER_WITHIN_MS);

export const api = {
  /** @returns {Promise<{examples: import('../model/types.js').Example[]}>} */
  examples: () => request('GET', 'examples'),

  /** @param {object} wanted a design, methods, and what is to be drawn of them
   * @param {AbortSignal} [ended] @returns {Promise<import('../model/types.js').DrawnCurves>} */
  curves: (wanted, ended) => request('POST', 'curves', wanted, { ended }),

  /** The same, quicker: for a slider that moves.
   * @param {object} wanted @param {AbortSignal} [ended] @returns {Promise<import('../model/types.js').DrawnCurves>} */
  async movingCurves(wanted, ended) {
    const answer = await sliding.ask(wanted);
    if (answer === null) return api.curves(wanted, ended);
    if (answer.errors) throw new Refusal(UNPROCESSABLE, answer.errors);
    return /** @type {any} */ (answer);
  },

  /** @param {Design} design with a motor @param {boolean} withProposals @param {AbortSignal} [ended]
   * @returns {Promise<import('../model/types.js').MotorAnswer>} */
  simulateMotor: (design, withProposals, ended) =>
    request('POST', 'motor/simulate', { design, with_proposals: withProposals, max_points: FEWEST_POINTS }, { ended }),

  /** The same with what the rotor does all along.
   * @param {Design} design with a motor @param {AbortSignal} [ended] @returns {Promise<import('../model/types.js').MotorAnswer>} */
  simulateRotor: (design, ended) => request('POST', 'motor/simulate', { design, with_proposals: false, max_points: ROTOR_POINTS }, { ended }),

  /** @param {Design} design with a motor @param {import('../model/types.js').Entry} margin of its torque @param {AbortSignal} [ended]
   * @returns {Promise<import('../model/types.js').FastestAnswer>} */
  fastestRamps: (design, margin, ended) => request('POST', 'motor/fastest', { design, margin }, { ended, withinMs: SEARCH_WITHIN_MS }),

  /** Have the stall map of a design computed; its job has the picture so far.
   * @param {Design} design with a motor @param {import('../model/types.js').Over} over @returns {Promise<{id: string}>} */
  beginMap: (design, over) => request('POST', 'motor/map', { design, over }),

  /** @param {string} id @param {AbortSignal} ended @returns {Promise<import('../model/types.js').MapJob>} */
  job: (id, ended) => request('GET', `jobs/${encodeURIComponent(id)}`, undefined, { ended }),

  /** @param {string} id @returns {Promise<import('../model/types.js').MapJob>} */
  cancelJob: (id) => request('DELETE', `jobs/${encodeURIComponent(id)}`),

  /** @param {Design[]} designs @param {'independent' | 'line'} mode @param {number} maxPoints
   * @param {AbortSignal} ended @returns {Promise<import('../model/types.js').ScheduledAxes>} */
  schedule: (designs, mode, maxPoints, ended) =>
    request('POST', 'schedule', { designs, mode, max_points: maxPoints }, { ended }),

  /** @param {Design} design @param {FitWish} wish @param {AbortSignal} [ended]
   * @returns {Promise<import('../model/types.js').FittedTable>} */
  fitTable: (design, wish, ended) => request('POST', 'table/fit', { design, ...wish }, { ended }),

  /** @param {Design} design @param {{row_kind: string, interval_unit: string, fit_to: string}} kind @param {AbortSignal} [ended]
   * @returns {Promise<import('../model/types.js').FitCurve>} */
  fitCurve: (design, kind, ended) => request('POST', 'table/fit/curve', { design, ...kind }, { ended }),

  /** @param {object} table rows, interval_unit, frequency_hz and slew_interval_us @param {AbortSignal} [ended]
   * @returns {Promise<{findings: {row: number, reason: string, wrong: boolean}[]}>} */
  checkTable: (table, ended) => request('POST', 'table/check', table, { ended }),

  /** @param {string} format @param {Record<string, unknown>} wanted the design, and what the format looks at besides
   * @param {AbortSignal} [ended] @returns {Promise<{file: Blob, name: string}>} */
  exportDesign: (format, wanted, ended) =>
    request('POST', `export/${format}`, wanted, { withinMs: EXPORT_WITHIN_MS, read: readFile, ended }),

  /** What a machine that ramps by itself is given for a design.
   * @param {string} name @param {Record<string, unknown>} wanted the design, and what the machine looks at besides
   * @param {AbortSignal} [ended] @returns {Promise<import('../model/types.js').MachineSheet>} */
  machine: (name, wanted, ended) => request('POST', `machine/${name}`, wanted, { withinMs: EXPORT_WITHIN_MS, ended }),

  /** @param {'html' | 'pdf'} format @param {object} wanted the design, and what its report is to say besides
   * @param {AbortSignal} [ended] @returns {Promise<{file: Blob, name: string}>} */
  report: (format, wanted, ended) =>
    request('POST', `report?format=${format}`, wanted, { withinMs: EXPORT_WITHIN_MS, read: readFile, ended }),

  /** @param {object} play table, range_steps and targets @param {AbortSignal} [ended]
   * @returns {Promise<import('../model/types.js').PlayedTable>} */
  playTable: (play, ended) => request('POST', 'table/play', play, { ended }),

  /** Play a design's ramp to what is told in flight.
   * @param {object} play design, commands and max_points @param {AbortSignal} ended
   * @returns {Promise<import('../model/types.js').InFlight>} */
  playInFlight: (play, ended) => request('POST', 'retarget', play, { withinMs: PLAY_WITHIN_MS, ended }),

  /** Read what a logic analyser captured. What is null is left to the server.
   * @param {File} file @param {import('../model/types.js').CaptureWish & {design: string | null}} wanted
   * @param {AbortSignal} ended @param {import('./upload.js').OnSent} onSent
   * @returns {Promise<import('../model/types.js').Captured>} */
  capture(file, wanted, ended, onSent) {
    const given = Object.entries(wanted).flatMap(([name, value]) => (value === null ? [] : [[name, String(value)]]));
    return sendFile(`capture?${new URLSearchParams(given)}`, file, ended, onSent);
  },

  /** What this page may do. @returns {Promise<import('../model/types.js').Access>} */
  access: () => request('GET', 'access'),

  /** @returns {Promise<import('../model/types.js').Ports>} */
  ports: () => request('GET', 'ports'),

  /** Which family the controller at a port says that it is of, as it starts; nothing is sent to it.
   * @param {string} port @returns {Promise<{family: string | null, heard: string[]}>} */
  findFamily: (port) => request('POST', 'ports/find', { port }),

  /** @param {string} port @param {string} family @returns {Promise<Device>} */
  connect: (port, family) => request('POST', 'devices', { port, family }),

  /** @param {string} id */
  disconnect: (id) => request('DELETE', device(id)),

  /** @param {string} id @param {import('../model/types.js').Pushed} wanted @param {Gesture} gesture a STOP ends it
   * @returns {Promise<import('../model/types.js').Push & {heard_s: number}>} */
  push: (id, wanted, gesture) => request('POST', `${device(id)}/push`, wanted, { withinMs: PUSH_WITHIN_MS, gesture }),

  /** What a push would change; nothing is sent.
   * @param {string} id @param {import('../model/types.js').Pushed} wanted @param {AbortSignal} ended
   * @returns {Promise<import('../model/types.js').Preview>} */
  preview: (id, wanted, ended) =>
    request('POST', `${device(id)}/push/preview`, wanted, { withinMs: PUSH_WITHIN_MS, ended }),

  /** Have a device do something else that moves nothing and has a route of its own.
   * @param {string} id @param {'position' | 'keep' | 'roll_back' | 'restore' | 'prove' | 'acknowledge' | 'control'} what
   * @param {unknown} [body] @returns {Promise<Device & {remarks?: string[]}>} what else there is to say, where it stores
   */
  act: (id, what, body) => request('POST', `${device(id)}/${what}`, body, { withinMs: PUSH_WITHIN_MS }),

  /** What is saved of a device, the newest first.
   * @param {string} id @returns {Promise<import('../model/types.js').Backups>} */
  backups: (id) => request('GET', `${device(id)}/backups`),

  /** All backups that there are, also of controllers that aren't connected.
   * @returns {Promise<{sources: import('../model/types.js').BackupSource[], unreadable: string[]}>} */
  archive: () => request('GET', 'backups'),

  /** @param {string} source @param {string} name of a backup of it @returns {Promise<string>} */
  archived: (source, name) =>
    request('GET', `backups/${encodeURIComponent(source)}/${encodeURIComponent(name)}`, undefined, { read: (answer) => answer.text() }),

  /** @param {string} id @param {string} source @param {string} name of a backup of it @returns {Promise<{remarks: string[]}>} */
  restoreFrom: (id, source, name) =>
    request('POST', `${device(id)}/backups/restore`, { source, name }, { withinMs: PUSH_WITHIN_MS }),

  /** @param {string} id @param {string} name of a backup @returns {Promise<{remarks: string[]}>} */
  restoreBackup: (id, name) =>
    request('POST', `${device(id)}/backups/${encodeURIComponent(name)}/restore`, undefined, { withinMs: PUSH_WITHIN_MS }),

  /** What a controller lists of itself, as designs, one for each of its axes.
   * @param {string} text @param {Design | null} design holds where that says nothing
   * @returns {Promise<{family: string, axes: import('../model/types.js').ReadAxis[]}>} */
  importText: (text, design) => request('POST', 'import', { text, design }),

  /** What a controller has now, as designs, one for each of its axes.
   * @param {string} id @param {Design} design holds where the controller says nothing
   * @returns {Promise<{axes: import('../model/types.js').ReadAxis[]}>} */
  importDevice: (id, design) => request('POST', `${device(id)}/import`, { design }),

  /** What a controller of a family, or a machine, really plays of a design's move.
   * @param {string} player its route, as families/grbl or machine/accelstepper @param {Design} design @param {number | null} stepsPerMm as it is set; null: not known
   * @param {AbortSignal} [ended] @returns {Promise<import('../model/types.js').OwnRamp>} */
  ownRamp: (player, design, stepsPerMm, ended) =>
    request('POST', `${player}/ramp`, { design, steps_per_mm: stepsPerMm }, { ended }),

  /** @param {string} id @param {'move' | 'run' | 'line' | 'there_and_back' | 'zero' | 'home'} what @param {unknown} body
   * @param {Gesture} gesture @returns {Promise<Device>} */
  move: (id, what, body, gesture) =>
    request('POST', `${device(id)}/${what}`, body, { withinMs: PUSH_WITHIN_MS, gesture }),

  /** @param {string} id @param {import('../model/types.js').SoftLimits[]} axes @returns {Promise<Device>} */
  limit: (id, axes) => request('PUT', `${device(id)}/soft_limits`, { axes }),

  /** @param {string} id @returns {Promise<import('../model/types.js').Settings>} */
  settings: (id) => request('GET', `${device(id)}/settings`),

  /** @param {string} id @param {unknown} settings @returns {Promise<import('../model/types.js').Settings>} */
  useSettings: (id, settings) => request('PUT', `${device(id)}/settings`, settings),

  /** What is around a virtual controller.
   * @param {string} id @returns {Promise<import('../devices/surroundings.js').Surroundings>} */
  surroundings: (id) => request('GET', `${device(id)}/surroundings`),

  /** @param {string} id @param {import('../devices/surroundings.js').SurroundingsChange} change
   * @returns {Promise<import('../devices/surroundings.js').Surroundings>} */
  changeSurroundings: (id, change) => request('PUT', `${device(id)}/surroundings`, change),

  /** Have the moves of an axis traced that begin from now on.
   * @param {string} id @param {number} axis @param {Gesture} gesture
   * @returns {Promise<{next_number: number}>} what the trace of the next one is called */
  traceMoves: (id, axis, gesture) => request('PUT', `${device(id)}/trace`, { traced_axis: axis }, { gesture }),

  /** @param {string} id @returns {Promise<import('../model/types.js').Trace>} */
  trace: (id) => request('GET', `${device(id)}/trace`),

  /** The same as a captured file.
   * @param {string} id @returns {Promise<{file: Blob, name: string}>} */
  traceFile: (id) => request('GET', `${device(id)}/trace.csv`, undefined, { read: readFile }),

  /** Slow all devices down.
   * @returns {Promise<{devices: Device[]}>} what they do once it is granted */
  stopAll: () => stop({ do: 'stop', device: null }, 'devices/stop'),

  /** @param {string} id @returns {Promise<{devices: Device[]}>} */
  halt: (id) => stop({ do: 'halt', device: id }, `${device(id)}/halt`),
};

/** Stop by a request, which the server serves before all else. One that is not answered soon waits for the requests of
 * other tabs: then it is said over the socket of events, too, and whichever is answered first counts, however late. It has
 * failed once neither can be answered any more, or the server has said no.
 * @param {import('./events.js').Stop} wanted @param {string} path @returns {Promise<{devices: Device[]}>} */
async function stop(wanted, path) {
  const answered = new AbortController();
  // A socket that is open is known to the server, whatever has become of this page's cookie.
  const isFinal = (/** @type {unknown} */ error) => isNo(error) && !isOfUnknown(error);
  // A request that is still in line is never sent: it would stop what is asked for after this.
  const asRequest = request('POST', path, undefined, { ended: answered.signal, isUrgent: true });
  const refused = new Promise((_, reject) => {
    asRequest.catch((error) => isFinal(error) && reject(error));
  });
  const isLate = new Promise((resolve) => {
    asRequest.catch((error) => isFinal(error) || resolve(null));
    setTimeout(resolve, STOP_WITHIN_MS);
  });
  const overEvents = isLate.then(() => {
    if (answered.signal.aborted) throw new Ended('It was answered.');
    return events.stop(wanted);
  });
  try {
    const told = await Promise.race([refused, Promise.any([asRequest, overEvents])]);
    return 'devices' in told ? told : { devices: [told] };
  } catch {
    return await asRequest;
  } finally {
    answered.abort();
  }
}

/** @param {unknown} error */
const isOfUnknown = (error) => error instanceof Refusal && error.status === UNAUTHORIZED;

/** Whether the server understood, and will not do it however it is asked.
 * @param {unknown} error */
export const isNo = (error) => error instanceof Refusal && error.status < SERVER_ERROR;

/** Whether the same is to be asked again: nobody answers, or the server can't just now, or doesn't know who asks. What it fails
 * at it would fail at again.
 * @param {unknown} error @returns {error is ServerGone | Refusal} */
export const isForLater = (error) =>
  error instanceof ServerGone || isOfUnknown(error) || (error instanceof Refusal && error.status > SERVER_ERROR && error.status !== DEVICE_LOST);

/** @param {string} id */
function device(id) {
  return `devices/${encodeURIComponent(id)}`;
}

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
  return new WebSocket(socketAddress(`${device(id)}/jog`));
}

/** Hear of every change of the devices, for as long as the page lives. */
export const watchDevices = events.watch;
