// @ts-check
// What is shown beside the design in hand: the design kept to compare with, and all axes of the machine over one time.

import { api, Refusal } from './api.js';
import { calculate } from './calculation.js';
import { axesMessages } from './messages.js';
import { shownValue } from './units.js';

/** @typedef {import('./types.js').Answer} Answer */
/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./units.js').Units} Units */
/** @typedef {import('./workbench.js').State} State */

// As many points as a wide screen has pixels.
const MAX_POINTS = 1500;

/** Remember the last answer, for as long as the question stays the same: designs never change, they are replaced.
 * @template Question, Found
 * @param {(question: Question) => Promise<Found>} ask
 * @param {(one: Question, other: Question) => boolean} areSame */
function remembering(ask, areSame) {
  /** @type {{question: Question, found: Found} | null} */
  let last = null;
  return async (/** @type {Question} */ question) => {
    if (last === null || !areSame(last.question, question)) last = { question, found: await ask(question) };
    return last.found;
  };
}

/** All axes over one time, and what is to be said of them.
 * @typedef {object} AllAxes
 * @property {import('./curves.js').AxisMove[] | null} moves  null: the server refuses one of them
 * @property {import('./messages.js').Message[]} messages */

/** @template Found @param {Promise<Found>} found @returns {Promise<Found | Refusal>} */
async function orRefusal(found) {
  try {
    return await found;
  } catch (error) {
    if (error instanceof Refusal) return error;
    throw error;
  }
}

export function createBeside() {
  const keptAnswer = remembering(
    (/** @type {Design} */ kept) => orRefusal(calculate(kept, [kept.method.name])),
    (one, other) => one === other,
  );
  const schedule = remembering(
    (/** @type {Pick<State, 'axes' | 'together'>} */ { axes, together }) =>
      orRefusal(api.schedule(axes, together, MAX_POINTS)),
    (one, other) => one.together === other.together && one.axes === other.axes,
  );

  return {
    /** The kept design's curves and figures; null when there is none, or the server refuses it.
     * @param {Design | null} kept */
    async kept(kept) {
      const answer = kept && (await keptAnswer(kept));
      return answer instanceof Refusal ? null : answer;
    },

    /** @param {State} state @param {Units} units @returns {Promise<AllAxes>} */
    async axes(state, units) {
      const planned = await schedule(state);
      if (planned instanceof Refusal) return { moves: null, messages: axesMessages(planned.rejections, false) };
      const moves = planned.axes.map(({ name, pulses }, colour) => ({
        label: `${colour} ${name}`,
        colour,
        time_s: pulses.time_s,
        speed: pulses.speed_steps_per_s.map((speed) => shownValue(units, state.axes[colour], 'speed', speed)),
        delay_us: pulses.speed_steps_per_s.map((speed) => 1e6 / speed),
      }));
      return { moves, messages: axesMessages([...planned.limits, ...planned.warnings], true) };
    },
  };
}
