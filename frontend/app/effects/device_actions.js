// @ts-check
// What is asked of devices: one thing at a time, and only ever because somebody pressed for it.

import { api, Ended, Refusal, UNPROCESSABLE } from '../../server/api.js';
import { download } from '../../ui/download.js';
import { memory } from '../../documents/memory.js';
import { pushText } from '../../model/messages.js';
import { answered, asks, limitsKept, portsCame, previewCame, pushed, refused, showMeasured } from '../commands/device.js';
import { announce, tell } from '../commands/told.js';
import { idsToPush, moveOf, previewQuestionOf } from '../devices.js';
import { pushOf } from './previews.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').SoftLimits} SoftLimits */

/** @param {unknown} error @returns {import('../../model/types.js').Rejection[]} */
export function rejectionsOf(error) {
  if (error instanceof Refusal) return error.rejections;
  const message = error instanceof Error ? error.message : String(error);
  return [{ field: null, value: null, allowed: null, message }];
}

/**
 * @param {import('../state.js').Store} store
 * @param {import('../../server/gestures.js').Gestures} gestures
 * @param {Map<string, import('../state.js').TracedMove>} traced  by device, its present move if this page traces it
 * @param {{outdate: () => void}} previews
 */
export function createDeviceActions({ state, dispatch }, gestures, traced, previews) {
  /** What is refused is shown, never thrown. What an answer says of the device is not taken from it: the events tell the
   * same, and in order.
   * @param {string} what @param {() => Promise<unknown>} ask */
  async function request(what, ask) {
    if (state().devices.asking !== null) return;
    dispatch(asks, what);
    try {
      await ask();
    } catch (error) {
      if (!(error instanceof Ended)) dispatch(refused, rejectionsOf(error));
      else if (what === 'push') dispatch(tell, 'STOP ended the push. What was being written already is written whole.', true);
    } finally {
      dispatch(answered);
    }
  }

  /** What refuses a push for what its designs are would refuse the preview, too: it is shown, and mended, in one place.
   * @template T @param {Promise<T>} push @returns {Promise<T | null>} null: it is refused so */
  async function refusedAsPreview(push) {
    try {
      return await push;
    } catch (error) {
      const question = previewQuestionOf(state());
      if (!(error instanceof Refusal) || error.status !== UNPROCESSABLE || question === null) throw error;
      dispatch(previewCame, { question, preview: null, rejections: error.rejections });
      dispatch(announce, pushText(error.rejections));
      return null;
    }
  }

  /** Have the next move traced.
   * @param {Device} device @param {number} axis @param {string} what @param {unknown} body
   * @param {import('../../server/gestures.js').Gesture} gesture */
  async function traceNext(device, axis, what, body, gesture) {
    const of = moveOf(state(), device.id, axis);
    const { next_number: first } = await api.traceMoves(device.id, axis, gesture);
    const legs = what === 'there_and_back' ? 2 * Number(/** @type {{times: unknown}} */ (body).times) : 1;
    const move = { of, first, last: first + legs - 1 };
    traced.set(device.id, move);
    return move;
  }

  return {
    refreshPorts: () => request('ports', async () => dispatch(portsCame, await api.ports())),
    /** @param {string} port @param {string} family the name of that of the controller there */
    connect: (port, family) => request('connect', () => api.connect(port, family)),
    /** @param {Device} device */
    disconnect: (device) => request('disconnect', () => api.disconnect(device.id)),
    /** @param {Device} device */
    takeOver: (device) => request('control', () => api.act(device.id, 'control')),
    /** @param {Device} device @param {Design[]} designs @param {number} toAxis @param {'keep' | 'try'} mode */
    push: (device, designs, toAxis, mode) =>
      request('push', async () => {
        const ids = idsToPush(state());
        const report = await refusedAsPreview(api.push(device.id, { ...pushOf(designs, toAxis), mode }, gestures.begin(device)));
        if (report === null) return;
        // Several go to the axes from the first on, whichever is chosen.
        const crc = report.items.find(({ unit }) => unit === 'CRC-16')?.sent ?? null;
        dispatch(pushed, device.id, { designs, ids, toAxis: designs.length === 1 ? toAxis : 0, crc, heard_s: report.heard_s });
        dispatch(
          announce,
          report.verified
            ? `Ramp pushed ${mode === 'try' ? 'on trial' : 'and stored'}, and read back as sent`
            : 'The ramp read back is not the one sent',
        );
      }),
    /** @param {Device} device @param {'keep' | 'roll_back' | 'restore'} what */
    store: (device, what) =>
      request(what, async () => {
        await api.act(device.id, what);
        if (what !== 'keep') dispatch(pushed, device.id, null);
        dispatch(announce, { keep: 'Kept', roll_back: 'Rolled back', restore: 'Restored' }[what]);
      }),
    /** Move. An axis that sets out from rest is traced, if it is wanted.
     * @param {Device} device @param {number} axis whose move is traced
     * @param {'move' | 'run' | 'line' | 'there_and_back' | 'zero'} what @param {unknown} body */
    go(device, axis, what, body) {
      const gesture = gestures.begin(device);
      return request(what, async () => {
        const isTraced = state().devices.isTracing && device.capabilities.includes('trace') && device.state === 'ready';
        const move = isTraced ? await traceNext(device, axis, what, body, gesture) : null;
        const before = state().devices.measured;
        try {
          await api.move(device.id, what, body, gesture);
        } catch (error) {
          // What moves next is not of this, be it a jog.
          if (traced.get(device.id) === move) traced.delete(device.id);
          throw error;
        }
        // What was refused has moved nothing, and what moved but a few steps may have been measured already.
        if (state().devices.measured === before) dispatch(showMeasured, null);
      });
    },
    /** Save what was traced last, as logic analysers save what they capture.
     * @param {Device} device */
    saveTrace: (device) =>
      request('trace', async () => {
        const { file, name } = await api.traceFile(device.id);
        download(file, name);
      }),
    /** @param {Device} device @param {number} axis @param {unknown} steps */
    setPosition: (device, axis, steps) =>
      request('position', () => api.act(device.id, 'position', { axes: [{ axis, position_steps: steps }] })),
    /** Keep axes within soft limits, and remember those of the port; fails when they are refused.
     * @param {Device} device @param {SoftLimits[]} axes */
    async limit(device, axes) {
      await api.limit(device.id, axes);
      memory.keepSoftLimits(device.port, axes);
      dispatch(limitsKept, device.port, memory.softLimits(device.port));
    },
    /** Have the controller drive its pins so; fails when it is refused. What it can take may be another then.
     * @param {Device} device @param {unknown} settings */
    async useSettings(device, settings) {
      await api.useSettings(device.id, settings);
      previews.outdate();
    },
    /** Bring those of the port back into force.
     * @param {Device} device @param {SoftLimits[]} axes */
    limitAgain: (device, axes) => request('soft_limits', () => api.limit(device.id, axes)),
  };
}

/** @typedef {ReturnType<typeof createDeviceActions>} DeviceActions */
