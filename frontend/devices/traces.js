// @ts-check
// Moves as they were made: the trace that the controller took, and what it told while they ran.

/** @typedef {import('../model/types.js').Device} Device */
/** @typedef {import('../model/types.js').Samples} Samples */

const MICROSECONDS = 1e6;
const TRACE_ATTEMPTS = 10;
const TRACE_PAUSE_MS = 100;
/** More points of a running move than a plot can show are thinned: every second one goes. */
const MOST_SAMPLES = 2_000;

/** What the plots show of a trace. A delay is that after its step: none follows the last.
 * @param {import('../model/types.js').Trace} trace @returns {import('../model/types.js').Measured} */
export function measuredFrom(trace) {
  const time = trace.measured_ticks.map((ticks) => ticks / trace.timer_hz);
  const delay = time.map((seconds, index) => {
    if (index === time.length - 1) return NaN;
    return (time[index + 1] - seconds) / (trace.step[index + 1] - trace.step[index]);
  });
  return {
    step: trace.step,
    time_s: time,
    speed_steps_per_s: delay.map((seconds) => 1 / seconds),
    delay_us: delay.map((seconds) => seconds * MICROSECONDS),
    deviation_us: trace.deviation_us,
    // What was changed on its way is traced as far as that: where it came to rest is not told.
    length: trace.changed ? null : trace.step[trace.step.length - 1],
  };
}

/** Look at a trace until all of it has come: its end comes over the wire a moment after the last step.
 * @param {() => Promise<import('../model/types.js').Trace | null>} look null: just now it can't be seen
 * @param {(trace: import('../model/types.js').Trace) => void} take what is known of it so far
 * @param {() => boolean} isOver whether what comes now may be of another move
 * @returns {Promise<import('../model/types.js').Trace | null>} what has come of it */
export async function untilComplete(look, take, isOver) {
  let known = null;
  for (let attempt = 0; attempt < TRACE_ATTEMPTS && !known?.complete; attempt += 1) {
    if (attempt > 0) await new Promise((resolve) => setTimeout(resolve, TRACE_PAUSE_MS));
    const trace = await look();
    if (isOver()) return null;
    known = trace ?? known;
    if (trace) take(trace);
  }
  return known;
}

/** Whether an axis that moves has no target but where it is: it runs at a speed, or has come to that of its move and isn't told to rest yet.
 * @param {import('../model/types.js').AxisState} axis */
export function isAtTarget({ state, target_steps, position_steps }) {
  return state === 'moving' && target_steps === position_steps;
}

/** @param {import('../model/types.js').AxisState} axis */
const isUnderWay = ({ state }) => state === 'moving' || state === 'stopping';

/** How long a move took, or one before it, and how fast they got.
 * @param {Samples} samples @returns {NonNullable<Samples['earlier']>} */
function extentOf({ time_s, speed, earlier = { seconds: 0, speed: 0 } }) {
  return { seconds: Math.max(earlier.seconds, time_s.at(-1) ?? 0), speed: Math.max(earlier.speed, ...speed.map(Math.abs)) };
}

/** Follows the axes of devices from where they set out until they set out again. */
export function createFollower() {
  /** isHalf: of there and back, which goes on.
   * @type {Map<string, {samples: Samples, fromSteps: number, fromSeconds: number, isMoving: boolean, isHalf: boolean}>} */
  const runs = new Map();
  /** Where each axis last was at rest.
   * @type {Map<string, number>} */
  const resting = new Map();

  /** Once an axis sets out, what those made that rest is of an earlier motion.
   * @param {Device} device */
  function forgetEarlier({ id, axes }) {
    const keyOf = (/** @type {import('../model/types.js').AxisState} */ { axis }) => `${id} ${axis}`;
    const setsOut = axes.some((axis) => isUnderWay(axis) && !runs.get(keyOf(axis))?.isMoving);
    if (!setsOut) return;
    for (const axis of axes) if (!isUnderWay(axis) && !runs.get(keyOf(axis))?.isMoving) runs.delete(keyOf(axis));
  }

  /** @param {Device} device @param {import('../model/types.js').AxisState} axis */
  function followAxis(device, axis) {
    const key = `${device.id} ${axis.axis}`;
    const isMoving = isUnderWay(axis);
    const before = runs.get(key);
    let run = before;
    const fromSteps = resting.get(key);
    // Of what moves already when the page begins to listen, or hears of it again, it has not seen the start.
    if (isMoving && !before?.isMoving && fromSteps !== undefined) {
      const samples = { time_s: [], position: [], speed: [], length: null, ...(before?.isHalf && { earlier: extentOf(before.samples) }) };
      run = { samples, fromSteps, fromSeconds: device.heard_s, isMoving, isHalf: false };
      runs.set(key, run);
    }
    if (run && (isMoving || before?.isMoving)) add(run, device.heard_s, axis);
    if (run) Object.assign(run, { isMoving, isHalf: device.shuttle?.axis === axis.axis });
    if (axis.state === 'ready') resting.set(key, axis.position_steps);
  }

  /** @param {{samples: Samples, fromSteps: number, fromSeconds: number}} run @param {number} heard
   * @param {import('../model/types.js').AxisState} axis */
  function add(run, heard, axis) {
    const isEven = (/** @type {number} */ _, /** @type {number} */ index) => index % 2 === 0;
    let { time_s, position, speed } = run.samples;
    if (time_s.length >= MOST_SAMPLES) {
      [time_s, position, speed] = [time_s.filter(isEven), position.filter(isEven), speed.filter(isEven)];
    }
    const [length, isFirst] = [Math.abs(axis.target_steps - run.fromSteps), time_s.length === 0];
    const isEndless = isAtTarget(axis) && run.samples.length !== length;
    run.samples = {
      ...run.samples,
      time_s: [...time_s, heard - run.fromSeconds],
      position: [...position, Math.abs(axis.position_steps - run.fromSteps)],
      speed: [...speed, axis.speed_steps_per_s],
      // What ran without an end and was then slowed down has none either.
      length: isEndless || (!isFirst && run.samples.length === null) ? null : length,
    };
  }

  return {
    /** @param {Device} device */
    follow(device) {
      forgetEarlier(device);
      for (const axis of device.axes) followAxis(device, axis);
    },
    /** Of devices that are not told any more nothing is known: their numbers may come to others.
     * @param {Device[]} told */
    forgetOthers(told) {
      const ids = new Set(told.map(({ id }) => id));
      for (const known of [runs, resting])
        for (const key of known.keys()) if (!ids.has(key.slice(0, key.lastIndexOf(' ')))) known.delete(key);
    },
    /** All that is known, by device and axis: "1 0".
     * @returns {Record<string, {samples: Samples | null, restingPlace: number | undefined}>} */
    runs: () =>
      Object.fromEntries(
        [...new Set([...runs.keys(), ...resting.keys()])].map((key) => [
          key,
          { samples: runs.get(key)?.samples ?? null, restingPlace: resting.get(key) },
        ]),
      ),
  };
}
