// @ts-check
// What the server tells of the devices, for as long as the page lives: their states, the moves they make, and whether
// the server is there.

import { api, Refusal, UNKNOWN_PAGE, watchDevices } from '../../server/api.js';
import { createEnded } from '../../devices/ended.js';
import { shownState } from '../../devices/state_words.js';
import { createFollower, measuredFrom, untilComplete } from '../../devices/traces.js';
import { heard, linked, refused, showMeasured, traceCame } from '../commands/device.js';
import { announce, urge } from '../commands/told.js';
import { placeTextOf } from '../devices.js';
import { rejectionsOf } from './device_actions.js';

/** @typedef {import('../../model/types.js').Device} Device */

const LINK_WORDS = { there: 'The server is back', silent: 'The server is silent', gone: 'The server is gone', unknown: UNKNOWN_PAGE };
const CONFLICT = 409;

/**
 * @param {import('../state.js').Store} store
 * @param {import('../../server/gestures.js').Gestures} gestures
 * @param {Map<string, import('../state.js').TracedMove>} traced  by device, its present move if this page traces it
 * @param {{endJog: () => void, endMotions: () => void}} handlers
 */
export function createDeviceNews({ state, dispatch }, gestures, traced, { endJog, endMotions }) {
  const follower = createFollower();
  // The simulated controller lives in the server and ends with it.
  const ended = createEnded(({ port }) => !state().devices.ports.find((one) => one.port === port)?.virtual);
  let toldEnded = '';

  /** @param {Device[]} told */
  function update(told) {
    gestures.hear(told);
    const known = state().devices.list;
    /** @type {[string, import('../state.js').TracedMove][]} */
    const measured = [];
    /** @type {Device[]} */
    const changed = [];
    follower.forgetOthers(told);
    for (const device of told) {
      const before = known.find((one) => one.id === device.id);
      follower.follow(device);
      if (before && shownState(before) === shownState(device)) continue;
      changed.push(device);
      // What was being traced before a loss, or by a server that has ended, is not told any more.
      if (before === undefined || device.state === 'lost') traced.delete(device.id);
      const move = traced.get(device.id);
      if (device.state === 'ready' && move) {
        traced.delete(device.id);
        measured.push([device.id, move]);
      }
      if (device.state === 'lost') endJog();
    }
    dispatch(heard, told, follower.runs());
    for (const device of changed) dispatch(announce, `${device.name}: ${shownState(device)}${placeTextOf(state(), device)}`);
    ended.follow(told);
    tellEnded();
    for (const [id, move] of measured) readTrace(id, move);
  }

  /** Told once: it may be closed. */
  function tellEnded() {
    const words = ended.words();
    if (words !== toldEnded) dispatch(urge, 'ended', words);
    toldEnded = words;
  }

  /** The trace as far as it is known; null when a stop refuses the look at it, as it does all else that waits.
   * @param {string} id */
  async function traceNow(id) {
    try {
      return await api.trace(id);
    } catch (error) {
      if (error instanceof Refusal && error.status === CONFLICT) return null;
      throw error;
    }
  }

  /** Of there and back a single leg is read. Once the next traced move was asked for, another motion is traced, or the
   * device has gone, what comes is not of this one.
   * @param {string} id @param {import('../state.js').TracedMove} move */
  async function readTrace(id, { of, first, last }) {
    let isPast = false;
    const isOver = () => isPast || traced.has(id) || !state().devices.list.some((one) => one.id === id);
    async function look() {
      const trace = await traceNow(id);
      if (trace === null || trace.number < first) return null;
      isPast = trace.number > last;
      if (!isPast) first = last = trace.number;
      return trace;
    }
    let trace = null;
    try {
      trace = await untilComplete(look, (known) => dispatch(traceCame, id, known), isOver);
    } catch (error) {
      if (!isOver()) dispatch(refused, rejectionsOf(error));
    }
    if (!isOver()) dispatch(showMeasured, trace && trace.step.length > 1 ? { of, move: measuredFrom(trace) } : null);
  }

  return {
    watch: () =>
      watchDevices(update, (link) => {
        if (link === state().devices.link) return;
        if (link !== 'there') endMotions();
        if (link === 'gone') {
          gestures.forget();
          ended.leave(state().devices.list);
          tellEnded();
        }
        dispatch(linked, link);
        dispatch(announce, LINK_WORDS[link]);
      }),
  };
}
