// @ts-check
// Moves as they were made: the trace that the controller took, and what it told while they ran.

/** @typedef {import('./types.js').Device} Device */
/** @typedef {import('./types.js').Samples} Samples */

const MICROSECONDS = 1e6;
/** More points of a running move than a plot can show are thinned: every second one goes. */
const MOST_SAMPLES = 2_000;

/** What the plots show of a trace. A delay is that after its step: none follows the last.
 * @param {import('./types.js').Trace} trace @returns {import('./types.js').Measured} */
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

/** Whether an axis runs at a speed, and so has no target but where it is.
 * @param {import('./types.js').AxisState} axis */
export function isEndless({ state, target_steps, position_steps }) {
  return state === 'moving' && target_steps === position_steps;
}

/** Follows the axes of devices from where they set out until they set out again. */
export function createFollower() {
  /** @type {Map<string, {samples: Samples, fromSteps: number, fromSeconds: number, isMoving: boolean}>} */
  const runs = new Map();
  /** Where each axis last was at rest.
   * @type {Map<string, number>} */
  const resting = new Map();

  /** @param {Device} device @param {import('./types.js').AxisState} axis */
  function followAxis(device, axis) {
    const key = `${device.id} ${axis.axis}`;
    const isMoving = axis.state === 'moving' || axis.state === 'stopping';
    const before = runs.get(key);
    let run = before;
    if (isMoving && !before?.isMoving) {
      const fromSteps = resting.get(key) ?? axis.position_steps;
      run = { samples: { time_s: [], position: [], speed: [], length: null }, fromSteps, fromSeconds: device.heard_s, isMoving };
      runs.set(key, run);
    }
    if (run && (isMoving || before?.isMoving)) add(run, device.heard_s, axis);
    if (run) run.isMoving = isMoving;
    if (axis.state === 'ready') resting.set(key, axis.position_steps);
  }

  /** @param {{samples: Samples, fromSteps: number, fromSeconds: number}} run @param {number} heard
   * @param {import('./types.js').AxisState} axis */
  function add(run, heard, axis) {
    const isEven = (/** @type {number} */ _, /** @type {number} */ index) => index % 2 === 0;
    let { time_s, position, speed } = run.samples;
    if (time_s.length >= MOST_SAMPLES) {
      [time_s, position, speed] = [time_s.filter(isEven), position.filter(isEven), speed.filter(isEven)];
    }
    run.samples = {
      time_s: [...time_s, heard - run.fromSeconds],
      position: [...position, Math.abs(axis.position_steps - run.fromSteps)],
      speed: [...speed, axis.speed_steps_per_s],
      length: isEndless(axis) ? null : Math.abs(axis.target_steps - run.fromSteps),
    };
  }

  return {
    /** @param {Device} device */
    follow(device) {
      for (const axis of device.axes) followAxis(device, axis);
    },
    /** The move of an axis that runs, or ran last; null before there was one.
     * @param {string} id @param {number} axis @returns {Samples | null} */
    samples: (id, axis) => runs.get(`${id} ${axis}`)?.samples ?? null,
    /** Where an axis last was at rest.
     * @param {string} id @param {number} axis */
    restingPlace: (id, axis) => resting.get(`${id} ${axis}`),
  };
}
