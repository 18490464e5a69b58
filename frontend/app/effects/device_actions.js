// @ts-check
// What is asked of devices: one thing at a time, and only ever because somebody pressed for it.

import { PUSH_STOPPED } from '../../devices/ended_pushes.js';
import { withScales } from '../../devices/kept_limits.js';
import { changeFor } from '../../devices/surroundings.js';
import { api, Ended, Refusal, ServerGone, UNPROCESSABLE } from '../../server/api.js';
import { download } from '../../ui/download.js';
import { memory } from '../../documents/memory.js';
import { remarksIn } from '../../model/imported.js';
import { pushText } from '../../model/messages.js';
import { quoted } from '../../model/quoted.js';
import { withSavedAt } from '../../model/saved_at.js';
import { inShownUnits } from '../../model/told.js';
import { answered, asks, chooseFamily, homingBegan, limitsKept, portsCame, previewCame, pushCutShort, pushed, refused, showMeasured } from '../commands/device.js';
import { announce, closeNotice, tell } from '../commands/told.js';
import { mend } from '../commands/work.js';
import { areSameQuestions, idsToPush, moveOf, previewQuestionOf } from '../devices.js';
import { machineOf } from '../selectors.js';
import { watchEndedPushes } from './ended_pushes.js';
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

/** Whether only its next start shows what it has stored.
 * @param {Device} device */
const isShownByStart = ({ capabilities }) => capabilities.includes('prove');

/** @param {string[]} remarks */
const restoredText = (remarks) => withSavedAt(['Restored, and read back.', ...remarks].join(' '));

/** @param {string[]} heard the first lines */
function nothingFound(heard) {
  const said = heard.length === 0 ? 'It says nothing of itself as it starts' : `It says ${quoted(heard[0])}, which names no known family`;
  return `${said}: choose its family. StepRamp’s own controllers, Tics and TMCL modules say nothing before they are asked.`;
}

/**
 * @param {import('../state.js').Store} store
 * @param {import('../../server/gestures.js').Gestures} gestures
 * @param {Map<string, import('../state.js').TracedMove>} traced  by device, its present move if this page traces it
 * @param {{outdate: () => void}} previews
 */
export function createDeviceActions(store, gestures, traced, previews) {
  const { state, dispatch } = store;
  const endedPushes = watchEndedPushes(store);

  /** What is refused is shown, never thrown. What an answer says of the device is not taken from it: the events tell the
   * same, and in order.
   * @param {string} what @param {() => Promise<unknown>} ask */
  async function request(what, ask) {
    if (state().devices.asking !== null) return;
    dispatch(asks, what);
    dispatch(closeNotice);
    try {
      await ask();
    } catch (error) {
      if (!(error instanceof Ended)) dispatch(refused, rejectionsOf(error));
      else if (what === 'push') dispatch(tell, PUSH_STOPPED, true);
    } finally {
      dispatch(answered);
    }
  }

  /** What refuses a push for what its designs are would refuse the preview, too: it is shown, and mended, in one place, as
   * long as that is still what is asked about.
   * @template T @param {() => Promise<T>} push @returns {Promise<T | null>} null: it is refused so */
  async function refusedAsPreview(push) {
    const question = previewQuestionOf(state());
    try {
      return await push();
    } catch (error) {
      if (!(error instanceof Refusal) || error.status !== UNPROCESSABLE || question === null) throw error;
      const text = pushText(error.rejections.map(inShownUnits(state().units, question.designs)));
      const present = previewQuestionOf(state());
      if (present !== null && areSameQuestions(present, question)) {
        dispatch(previewCame, { question, preview: null, rejections: error.rejections });
        dispatch(announce, text);
      } else dispatch(tell, `What was to be pushed is refused. ${text}`, true);
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
    /** Listen which family the controller at a port names, and choose that for it.
     * @param {string} port */
    findFamily: (port) =>
      request('find', async () => {
        dispatch(announce, 'Listening to what the controller says as it starts.');
        const { family, heard } = await api.findFamily(port);
        const title = state().devices.families.find(({ name }) => name === family)?.title;
        if (family === null || title === undefined) dispatch(tell, nothingFound(heard), true);
        else {
          memory.keepFamily(port, family);
          dispatch(chooseFamily, port, family);
          dispatch(tell, `It says ${quoted(heard[0])}: ${title}.`, false);
        }
      }),
    /** @param {string} port @param {string} family the name of that of the controller there */
    connect: (port, family) => request('connect', () => api.connect(port, family)),
    /** @param {Device} device */
    disconnect: (device) => request('disconnect', () => api.disconnect(device.id)),
    /** @param {Device} device */
    takeOver: (device) => request('control', () => api.act(device.id, 'control')),
    /** @param {Device} device @param {Design[]} designs @param {number} toAxis @param {'keep' | 'try'} mode */
    push: (device, designs, toAxis, mode) =>
      request('push', async () => {
        // Several go to the axes from the first on, whichever is chosen.
        const what = { designs, ids: idsToPush(state()), toAxis: designs.length === 1 ? toAxis : 0 };
        endedPushes.forget(device.id);
        const push = () => api.push(device.id, { ...pushOf(designs, toAxis), mode }, gestures.begin(device));
        const report = await refusedAsPreview(push).catch((error) => {
          if (error instanceof Ended) {
            dispatch(pushCutShort, device.id, { ...what, before: device.ramp });
            endedPushes.await(device);
          }
          throw error;
        });
        if (report === null) return;
        const crc = report.items.find(({ unit }) => unit === 'CRC-16')?.sent ?? null;
        dispatch(pushed, device.id, { ...what, crc, heard_s: report.heard_s });
        dispatch(
          announce,
          report.verified
            ? `Ramp pushed${mode === 'try' ? ' on trial' : isShownByStart(device) ? '' : ' and stored'}, and read back as sent`
            : 'The ramp read back is not the one sent',
        );
      }),
    /** @param {Device} device @param {'keep' | 'roll_back' | 'restore'} what */
    store: (device, what) =>
      request(what, async () => {
        const { remarks = [] } = await api.act(device.id, what);
        if (what !== 'keep') dispatch(pushed, device.id, null);
        if (remarks.length > 0) dispatch(tell, ['Kept.', ...remarks].join(' '), false);
        else dispatch(announce, { keep: 'Kept', roll_back: 'Rolled back', restore: 'Restored' }[what]);
      }),
    /** Have a controller start anew, and see whether it has stored what it was given.
     * @param {Device} device */
    prove: (device) =>
      request('prove', async () => {
        const { proof } = await api.act(device.id, 'prove');
        if (proof !== null) dispatch(tell, proof.words, proof.not_kept.length > 0);
      }),
    /** Have it take motions again after what stopped it.
     * @param {Device} device */
    acknowledge: (device) =>
      request('acknowledge', async () => {
        await api.act(device.id, 'acknowledge');
        dispatch(announce, 'Acknowledged: it takes motions again');
      }),
    /** Give a design what an axis of the controller has.
     * @param {Device} device @param {number} axis of the device @param {Design} design
     * @param {number} axisId of the page's axis that has the design, whichever is in hand when the answer comes */
    startFrom: (device, axis, design, axisId) =>
      request('import', async () => {
        const { axes } = await api.importDevice(device.id, design);
        const found = axes[axis] ?? axes[0];
        if (!machineOf(state())?.ids.includes(axisId)) {
          dispatch(tell, 'Nothing was changed: the axis that was to have what the controller has was removed meanwhile.', true);
          return;
        }
        dispatch(mend, axisId, { changes: machineChanges(found.design) });
        dispatch(tell, ['The design has what the controller has.', ...remarksIn(state().units)(found)].join(' '), false);
      }),
    /** @param {Device} device */
    listBackups: (device) => api.backups(device.id),
    /** @param {Device} device @param {string} name of a backup */
    restoreBackup: (device, name) =>
      request('restore', async () => {
        const { remarks } = await api.restoreBackup(device.id, name);
        dispatch(pushed, device.id, null);
        dispatch(tell, restoredText(remarks), false);
      }),
    /** @param {Device} device @param {string} source @param {string} name of a backup of it */
    restoreFrom: (device, source, name) =>
      request('restore', async () => {
        const { remarks } = await api.restoreFrom(device.id, source, name);
        dispatch(pushed, device.id, null);
        dispatch(tell, restoredText(remarks), false);
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
    /** Have axes find their switches; fails when it is refused.
     * @param {Device} device @param {import('../../devices/homing.js').HomeWish} wish
     * @returns {Promise<boolean>} whether it was asked for: not where something else is being asked */
    async home(device, wish) {
      if (state().devices.asking !== null) return false;
      const gesture = gestures.begin(device);
      dispatch(asks, 'home');
      try {
        const { heard_s } = await api.move(device.id, 'home', wish, gesture);
        dispatch(homingBegan, device.id, { wish, stops: gesture.stops, heard_s, outcomes: null });
        return true;
      } catch (error) {
        if (error instanceof Ended) return true;
        throw error;
      } finally {
        dispatch(answered);
      }
    },
    /** Press an input of a virtual controller, or let it go.
     * @param {Device} device @param {import('../../model/types.js').DeviceInput} input @param {boolean} isPressed */
    press: (device, input, isPressed) =>
      request('surroundings', async () => {
        await api.changeSurroundings(device.id, changeFor(input, isPressed, await api.surroundings(device.id)));
      }),
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
      // By the scale that is told of it now: settings that were given before these may have changed it.
      const limited = await api.limit(device.id, axes);
      memory.keepSoftLimits(device.port, withScales(axes, limited.axes));
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

/** What a controller tells of its ramp and its scale, as changes of a design. Travel and speeds rest on the steps of a turn:
 * without these they would be those of another machine. What it plays has no shape but its own.
 * @param {Design} design of what it has */
function machineChanges({ axis, ramp }) {
  return [
    { field: 'axis.full_steps_per_rev', value: axis.full_steps_per_rev },
    { field: 'axis.microsteps', value: axis.microsteps },
    { field: 'axis.travel_unit', value: axis.travel_unit },
    { field: 'axis.travel_per_rev', value: axis.travel_per_rev },
    { field: 'ramp.base_speed_steps_per_s', value: ramp.base_speed_steps_per_s },
    { field: 'ramp.slew_speed_steps_per_s', value: ramp.slew_speed_steps_per_s },
    { field: 'ramp.acceleration_steps_per_s2', value: ramp.acceleration_steps_per_s2 },
    { field: 'ramp.deceleration_steps_per_s2', value: ramp.deceleration_steps_per_s2 },
    { field: 'ramp.shape', value: ramp.shape },
  ];
}

/** @typedef {ReturnType<typeof createDeviceActions>} DeviceActions */
