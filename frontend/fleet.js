// @ts-check
// The devices as the server tells of them, and what is asked of them. Nothing here moves a motor unasked.

import { api, Ended, PAGE, Refusal, watchDevices } from './api.js';
import { createGestures } from './gestures.js';
import { createJog } from './jogging.js';
import { memory } from './memory.js';
import { pushText } from './messages.js';
import { newestWins } from './newest.js';
import { createFollower, isEndless, measuredFrom } from './traces.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Device} Device */
/** @typedef {import('./types.js').Link} Link */
/** @typedef {import('./types.js').Preview} Preview */
/** @typedef {import('./types.js').Pushed} Pushed */
/** @typedef {import('./types.js').Rejection} Rejection */
/** @typedef {{isDesignValid: boolean, designs: Design[], active: number, units: import('./units.js').Units}} Work */

/** A design that is still being changed is not asked about. */
const PREVIEW_AFTER_MS = 250;
/** The end of a trace comes over the wire a moment after the last step. */
const TRACE_ATTEMPTS = 10;
const TRACE_PAUSE_MS = 100;

/** What makes designs the same ramps: all but their names.
 * @param {Design[]} designs */
function rampKey(designs) {
  return JSON.stringify(designs.map((design) => ({ ...design, name: '' })));
}

/** The designs that a push sends: of more than the device can have axes only the one in view.
 * @param {Device | null} device @param {Work} work */
function designsFor(device, { designs, active }) {
  const most = device?.most_axes ?? designs.length;
  return designs.length > most ? [designs[active]] : designs;
}

/** What a push sends: one design goes to one axis, several are those of all axes.
 * @param {Design[]} designs @param {number} toAxis @returns {Pushed} */
function pushOf(designs, toAxis) {
  return designs.length === 1 ? { design: designs[0], to_axis: toAxis } : { axes: designs };
}

/** @param {unknown} error @returns {Rejection[]} */
function rejectionsOf(error) {
  if (error instanceof Refusal) return error.rejections;
  const message = error instanceof Error ? error.message : String(error);
  return [{ field: null, value: null, allowed: null, message }];
}

/**
 * @param {{onChange: () => void, onPorts: (known: import('./types.js').Ports) => void, onRejected: (rejections: Rejection[]) => void,
 *   onMeasured: (measured: import('./types.js').Measured | null) => void,
 *   say: (text: string) => void, onLink: (link: Link) => void}} handlers
 */
export function createFleet({ onChange, onPorts, onRejected, onMeasured, say, onLink }) {
  /** @type {Device[]} */
  let devices = [];
  /** @type {Link} */
  let link = 'there';
  /** What is being asked of the device: "connect", "push" …; null: nothing.
   * @type {string | null} */
  let asking = null;
  /** The ramps last pushed from this page, by device.
   * @type {Map<string, string>} */
  const pushed = new Map();
  const follower = createFollower();
  let isTracing = true;
  /** Devices whose present move this page has traced.
   * @type {Set<string>} */
  const traced = new Set();
  /** @type {Map<string, import('./types.js').Trace>} */
  const traces = new Map();
  const gestures = createGestures();
  const jog = createJog(gestures, onRejected);
  /** The measured move that is shown.
   * @type {import('./types.js').Measured | null} */
  let measured = null;
  /** What a push would change, or why there can be none, and of what that was said.
   * @type {{key: string, preview: Preview | null, problem: string}} */
  let known = { key: '', preview: null, problem: '' };
  /** @type {{device: Device, wanted: Pushed, key: string} | null} */
  let previewed = null;
  let previewTimer = 0;

  /** @param {Device[]} told */
  function update(told) {
    gestures.hear(told);
    for (const device of told) {
      const before = devices.find((one) => one.id === device.id);
      follower.follow(device);
      if (before?.state !== device.state) {
        say(`${device.name}: ${device.state}${device.state === 'lost' ? '' : ` at ${device.position_steps} steps`}`);
        // What was being traced before a loss, or by a server that has ended, is not told any more.
        if (before === undefined || device.state === 'lost') traced.delete(device.id);
        if (device.state === 'ready' && traced.delete(device.id)) readTrace(device.id);
        if (device.state === 'lost') jog.end();
      }
    }
    devices = told;
    onChange();
  }

  /** @param {import('./types.js').Measured | null} move */
  function showMeasured(move) {
    measured = move;
    onMeasured(move);
  }

  /** The trace as far as it is known; null when a stop refuses the look at it, as it does all else that waits.
   * @param {string} id */
  async function traceNow(id) {
    try {
      return await api.trace(id);
    } catch (error) {
      if (error instanceof Refusal && error.status === 409) return null;
      throw error;
    }
  }

  /** @param {string} id */
  async function readTrace(id) {
    try {
      for (let attempt = 0; attempt < TRACE_ATTEMPTS; attempt += 1) {
        const trace = await traceNow(id);
        if (trace) traces.set(id, trace);
        if (trace?.complete) break;
        await new Promise((resolve) => setTimeout(resolve, TRACE_PAUSE_MS));
      }
    } catch (error) {
      onRejected(rejectionsOf(error));
    }
    const trace = traces.get(id);
    showMeasured(trace && trace.step.length > 1 ? measuredFrom(trace) : null);
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
      if (!(error instanceof Ended)) onRejected(rejectionsOf(error));
    } finally {
      asking = null;
      onChange();
    }
  }

  const askPreview = newestWins(async () => {
    if (previewed === null) return;
    const { device, wanted, key } = previewed;
    if (!devices.some(({ id }) => id === device.id)) return; // It was let go of while the preview waited.
    try {
      known = { key, preview: await api.preview(device.id, wanted), problem: '' };
    } catch (error) {
      if (!(error instanceof Refusal && error.status === 422)) {
        previewed = null; // Not now: asked again when there is news of the device.
        return;
      }
      known = { key, preview: null, problem: pushText(error.rejections) };
    }
    onChange();
  });

  /** What a push would change, as far as it is known; asked for when it is another than before.
   * @param {Device} device @param {Design[]} designs @param {number} toAxis
   * @returns {{preview: Preview | null, problem: string}} */
  function previewOf(device, designs, toAxis) {
    const { id, ramp, on_trial, timer_hz, in_control } = device;
    const key = JSON.stringify([id, ramp, on_trial, timer_hz, in_control, toAxis, rampKey(designs)]);
    if (previewed?.key !== key) {
      previewed = { device, wanted: pushOf(designs, toAxis), key };
      clearTimeout(previewTimer);
      previewTimer = setTimeout(askPreview, PREVIEW_AFTER_MS);
    }
    return known.key === key ? known : { preview: null, problem: '' };
  }

  /** End what is on its way to set motors moving: nothing more of it is sent. */
  function endMotions() {
    gestures.end();
    jog.end();
  }

  return {
    devices: () => devices,
    endMotions,
    hearStops: gestures.hear,
    /** Whether what is known of the devices is as they are now. */
    isLive: () => link === 'there',
    jog,
    /** @param {Device | null} device @param {number} toAxis which axis a single design is for @param {Work} work
     * @returns {import('./types.js').Situation} */
    situation(device, toAxis, work) {
      const last = device ? pushed.get(device.id) : undefined;
      const canPreview = link === 'there' && work.isDesignValid && device?.state === 'ready';
      const toPush = designsFor(device, work);
      const would = canPreview && device ? previewOf(device, toPush, toAxis) : null;
      return {
        ...work,
        toPush,
        link,
        isBusy: asking !== null,
        isPushing: asking === 'push',
        isChanged: last !== undefined && last !== rampKey(toPush),
        isOthers: device !== null && device.in_control !== null && device.in_control !== PAGE,
        isTracing,
        preview: would?.preview ?? null,
        previewProblem: would?.problem ?? '',
        trace: device ? (traces.get(device.id) ?? null) : null,
      };
    },
    /** The move of an axis that runs, counted from its start and its end; null when nothing runs.
     * @param {Device | null} device @param {number} axis @param {number} planned steps of the plotted move */
    runningMove(device, axis, planned) {
      const one = device?.axes[axis];
      if (link !== 'there' || !device || !one || (one.state !== 'moving' && one.state !== 'stopping')) return null;
      const remaining = isEndless(one) ? Infinity : Math.abs(one.target_steps - one.position_steps);
      const start = follower.restingPlace(device.id, axis);
      const done = start === undefined ? Math.max(0, planned - remaining) : Math.abs(one.position_steps - start);
      return { done, remaining, speed: one.speed_steps_per_s };
    },
    /** What is known of the running or last move of an axis.
     * @param {Device | null} device @param {number} axis */
    samples: (device, axis) => (device ? follower.samples(device.id, axis) : null),
    refreshPorts: () => request('ports', async () => onPorts(await api.ports())),
    /** @param {string} port @param {string} family the name of that of the controller there */
    connect: (port, family) => request('connect', () => api.connect(port, family)),
    /** @param {Device} device */
    disconnect: (device) => request('disconnect', () => api.disconnect(device.id)),
    /** @param {Device} device */
    takeOver: (device) => request('control', () => api.act(device.id, 'control')),
    /** @param {Device} device @param {Design[]} designs @param {number} toAxis @param {'keep' | 'try'} mode */
    push: (device, designs, toAxis, mode) =>
      request('push', async () => {
        const report = await api.push(device.id, { ...pushOf(designs, toAxis), mode });
        pushed.set(device.id, rampKey(designs));
        say(
          report.verified
            ? `Ramp pushed ${mode === 'try' ? 'on trial' : 'and stored'}, and read back as sent`
            : 'The ramp read back is not the one sent',
        );
      }),
    /** @param {Device} device @param {'keep' | 'roll_back' | 'restore'} what */
    store: (device, what) =>
      request(what, async () => {
        await api.act(device.id, what);
        if (what !== 'keep') pushed.delete(device.id);
        say({ keep: 'Kept', roll_back: 'Rolled back', restore: 'Restored' }[what]);
      }),
    /** Move: only ever because somebody pressed for it. An axis that sets out from rest is traced, if it is wanted.
     * @param {Device} device @param {number} axis whose move is traced
     * @param {'move' | 'run' | 'line' | 'there_and_back' | 'zero'} what @param {unknown} body */
    go(device, axis, what, body) {
      const gesture = gestures.begin(device);
      return request(what, async () => {
        if (isTracing && device.capabilities.includes('trace') && device.state === 'ready') {
          await api.traceMoves(device.id, axis, gesture);
          traced.add(device.id);
        }
        const before = measured;
        await api.move(device.id, what, body, gesture);
        // What was refused has moved nothing, and what moved but a few steps may have been measured already.
        if (measured === before) showMeasured(null);
      });
    },
    /** @param {Device} device @param {number} axis @param {unknown} steps */
    setPosition: (device, axis, steps) =>
      request('position', () => api.act(device.id, 'position', { axes: [{ axis, position_steps: steps }] })),
    /** Keep axes within soft limits, and remember those of the port; fails when they are refused.
     * @param {Device} device @param {import('./types.js').SoftLimits[]} axes */
    async limit(device, axes) {
      await api.limit(device.id, axes);
      memory.keepSoftLimits(device.port, axes);
      onChange();
    },
    /** Have the controller drive its pins so; fails when it is refused. What it can take may be another then.
     * @param {Device} device @param {unknown} settings */
    async useSettings(device, settings) {
      await api.useSettings(device.id, settings);
      previewed = null;
      onChange();
    },
    /** Bring those of the port back into force.
     * @param {Device} device @param {import('./types.js').SoftLimits[]} axes */
    limitAgain: (device, axes) => request('soft_limits', () => api.limit(device.id, axes)),
    /** @param {boolean} wanted */
    trace(wanted) {
      isTracing = wanted;
      onChange();
    },
    watch: () =>
      watchDevices(update, (present) => {
        if (present === link) return;
        link = present;
        if (link !== 'there') endMotions();
        if (link === 'gone') gestures.forget();
        onLink(link);
        onChange();
      }),
  };
}

/** @typedef {ReturnType<typeof createFleet>} Fleet */
