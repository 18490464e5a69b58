// @ts-check
// What a motor does that is told something in flight: what the server is asked, and what its answer says.

import { counted, formatFigures, formatFixed } from './numbers.js';
import { shownValue, unitsFor, unitWord } from './units.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Entry} Entry */
/** @typedef {import('./types.js').InFlight} InFlight */
/** @typedef {import('./units.js').Units} Units */

/** What the motor is told: a target [steps], or a speed [steps/s]. What is no number is the text as it was typed.
 * @typedef {{atMs: Entry, kind: 'target' | 'speed', value: Entry}} Told */

/** Where a motor turns without a rest; passed: the target that it had gone past by then, null: none.
 * @typedef {{at_s: number, position: number, passed: number | null}} Turn */

/** @typedef {object} Flight
 * @property {number} end_s
 * @property {{at_s: number[], position: number[], speed: number[]}} steps  after each pulse, with 0 from each rest on
 * @property {Turn[]} turns
 * @property {{at_s: number, position: number}[]} rests
 * @property {{at_s: number, speed: number} | null} fastest  null: it makes no step */

export const MS_PER_S = 1000;
/** More turns or rests are counted, not told. */
const MOST_TOLD = 4;
const FIGURES = 12;

/** Whether something is commands, as they are kept.
 * @param {any} kept @returns {kept is Told[]} */
export const areTold = (kept) => Array.isArray(kept) && kept.length > 0 && kept.every(isTold);

/** @param {any} one */
const isTold = (one) => ['target', 'speed'].includes(one?.kind) && [one.atMs, one.value].every(isEntry);
/** @param {unknown} value */
const isEntry = (value) => typeof value === 'string' || Number.isFinite(value);

/** What a motor is told, as the server takes it.
 * @param {Told[]} told */
export const commandsOf = (told) =>
  told.map(({ atMs, kind, value }) => ({
    at_s: typeof atMs === 'number' ? Number((atMs / MS_PER_S).toPrecision(FIGURES)) : atMs,
    [kind === 'target' ? 'target_steps' : 'speed_steps_per_s']: value,
  }));

/** @param {InFlight} answer @param {Told[]} told that it answers @returns {Flight} */
export function flightOf(answer, told) {
  const steps = stepsOf(answer);
  const rests = answer.rests.map(({ at_s, position_steps: position }) => ({ at_s, position }));
  const last = Number(told.at(-1)?.atMs ?? 0) / MS_PER_S;
  const shortest = answer.interval_ticks.reduce((best, interval, at, all) => (interval < all[best] ? at : best), 0);
  const fastest = answer.at_ticks.length === 0 ? null : { at_s: answer.at_ticks[shortest] / answer.timer_hz, speed: speedAt(answer, shortest) };
  return { end_s: Math.max(last, steps.at_s.at(-1) ?? 0, rests.at(-1)?.at_s ?? 0), steps, turns: turnsOf(answer, told), rests, fastest };
}

/** @param {InFlight} answer @param {number} at */
const speedAt = ({ direction, interval_ticks, timer_hz }, at) => (direction[at] * timer_hz) / interval_ticks[at];

/** @param {InFlight} answer @returns {Flight['steps']} */
function stepsOf(answer) {
  const { at_ticks, position_steps, rests, timer_hz } = answer;
  /** @type {Flight['steps']} */
  const steps = { at_s: [0], position: [0], speed: [0] };
  const add = (/** @type {number} */ at_s, /** @type {number} */ position, /** @type {number} */ speed) => {
    steps.at_s.push(at_s);
    steps.position.push(position);
    steps.speed.push(speed);
  };
  let rest = 0;
  const addRestsUntil = (/** @type {number} */ at_s) => {
    for (; rest < rests.length && rests[rest].at_s <= at_s; rest += 1) add(rests[rest].at_s, rests[rest].position_steps, 0);
  };
  at_ticks.forEach((ticks, at) => {
    addRestsUntil(ticks / timer_hz);
    add(ticks / timer_hz, position_steps[at], speedAt(answer, at));
  });
  addRestsUntil(Infinity);
  return steps;
}

/** @param {InFlight} answer @param {Told[]} told @returns {Turn[]} */
function turnsOf({ at_ticks, position_steps, direction, rests, timer_hz, told_position_steps }, told) {
  const turns = direction.flatMap((way, at) => {
    const [from, to] = [at_ticks[at] / timer_hz, at_ticks[at + 1] / timer_hz];
    const isTurn = at + 1 < direction.length && direction[at + 1] !== way;
    if (!isTurn || rests.some(({ at_s }) => at_s > from && at_s <= to)) return [];
    const position = position_steps[at];
    const last = told.findLastIndex(({ atMs }) => Number(atMs) / MS_PER_S <= from);
    const target = told[last]?.kind === 'target' ? Number(told[last].value) : NaN;
    const isPassed = way * (position - target) > 0 && way * (told_position_steps[last] - target) <= 0;
    return [{ at_s: from, position, passed: isPassed ? target : null }];
  });
  return turns;
}

/** What a motor does, in words.
 * @param {Flight} flight @param {Units} units @param {Design} design */
export function flightText({ turns, rests, fastest }, units, design) {
  if (fastest === null) return 'It has nowhere to go.';
  const place = (/** @type {number} */ steps) => placeText(steps, units, design);
  const turned = turns.slice(0, MOST_TOLD).map(({ at_s, position, passed }) => {
    const turn = `turns at ${place(position)} after ${timeText(at_s)}`;
    return passed === null ? `It ${turn}.` : `It passes ${place(passed)}, ${turn} and comes back.`;
  });
  const rested = rests.slice(0, MOST_TOLD).map(({ at_s, position }) => `at ${place(position)} after ${timeText(at_s)}`);
  const speed = valueText(shownValue(units, design, 'speed', fastest.speed));
  return [
    ...turned,
    ...more(turns.length, 'turn'),
    `At rest ${rested.join(', then ')}.`,
    ...more(rests.length, 'rest'),
    `Fastest: ${speed} ${unitWord(units, design, 'speed')}, after ${timeText(fastest.at_s)}.`,
  ].join(' ');
}

/** @param {number} count @param {string} one */
const more = (count, one) => (count > MOST_TOLD ? [`And ${counted(count - MOST_TOLD, one)} more.`] : []);

/** @param {number} steps @param {Units} units @param {Design} design */
function placeText(steps, units, design) {
  if (unitsFor(units, design).length === 'steps') return counted(steps, 'step');
  return `${valueText(shownValue(units, design, 'length', steps))} ${unitWord(units, design, 'length')}`;
}

/** No digits that say nothing.
 * @param {number} value */
const valueText = (value) => (Math.abs(value) >= 100 || Number.isInteger(value) ? formatFixed(value) : formatFigures(value));

/** @param {number} seconds */
const timeText = (seconds) => (seconds < 10 ? `${formatFixed(seconds * MS_PER_S, 1)} ms` : `${formatFixed(seconds, 3)} s`);
