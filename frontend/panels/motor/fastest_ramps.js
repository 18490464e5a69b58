// @ts-check
// The fastest ramps with the curve of each, and how their beginnings are drawn beside each other.

import { withChanges } from '../../model/design.js';
import { formatFigures, roundParts } from '../../model/numbers.js';
import { shownValue } from '../../model/units.js';
import { activeProfile } from '../../plotting/curves.js';
import { api } from '../../server/api.js';
import { calculate } from '../../server/calculation.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').FastestAnswer} FastestAnswer */
/** @typedef {{time_s: number[], speed_steps_per_s: number[]}} SpeedCurve */
/** curves: of the design as it is, and of each candidate; null: there is none.
 * @typedef {{answer: FastestAnswer, curves: (SpeedCurve | null)[]}} FoundRamps */

/** So much of the time is drawn that the slowest ramp of them takes, of the design's own up to some times theirs. */
const BEYOND = 1.25;
const MOST_OWN = 3;
const PARTS = 3;
const MS_PER_S = 1000;
/** From here on a small chart has room for thousands only. */
const THOUSANDS = 10_000;

/** @param {Design} design @param {import('../../model/types.js').Entry} margin @param {AbortSignal} ended @returns {Promise<FoundRamps>} */
export async function askFastest(design, margin, ended) {
  const answer = await api.fastestRamps(design, margin, ended);
  const ramps = [{ ...answer.present, changes: [] }, ...answer.candidates];
  const made = ramps.map(({ verdict, changes }) => (verdict === null ? null : withChanges(design, changes)));
  const curves = await Promise.all(made.map((one) => one && calculate(one, [one.method.name], undefined, ended).then(activeProfile)));
  return { answer, curves };
}

/** The beginnings of all ramps over one time, each with that of the design as it is.
 * @param {FoundRamps} found @param {import('../../model/units.js').Units} units @param {Design} design
 * @returns {(import('../../ui/time_chart.js').TimeChart | null)[]} */
export function rampsAsCharts({ answer, curves }, units, design) {
  const ramps_s = answer.candidates.flatMap(({ ramp_up_s: time }) => time ?? []);
  const slowest = Math.max(...ramps_s, 1e-6);
  const end = BEYOND * Math.max(slowest, Math.min(answer.present.ramp_up_s ?? 0, MOST_OWN * slowest));
  const speedOf = (/** @type {number} */ speed) => shownValue(units, design, 'speed', speed);
  const high = speedOf(Math.max(...curves.flatMap((curve) => curve?.speed_steps_per_s ?? []), 1));
  const levels = roundParts(0, high, PARTS).map(({ at }) => ({ at, text: at === 0 ? '0' : at < THOUSANDS ? formatFigures(at, 2) : `${formatFigures(at / 1000, 2)}k` }));
  const times = roundParts(0, end * MS_PER_S, PARTS).flatMap(({ at }) => (at / MS_PER_S <= end ? [{ at: at / MS_PER_S, text: formatFigures(at, 1) }] : []));
  times[times.length - 1].text += ' ms';
  const stairs = (/** @type {SpeedCurve | null} */ curve) => (curve ? until(end, curve.time_s, curve.speed_steps_per_s.map(speedOf)) : { x: [], y: [] });
  const own = stairs(curves[0]);
  return curves.map((curve) => curve && { end, low: 0, high: levels[levels.length - 1].at, times, levels, wanted: own, way: stairs(curve), dots: [] });
}

/** Of stairs what comes before an end, and the last one up to it.
 * @param {number} end @param {number[]} x @param {number[]} y */
function until(end, x, y) {
  const beyond = x.findIndex((time) => time > end);
  if (beyond < 0) return { x, y };
  return { x: [...x.slice(0, beyond), end], y: [...y.slice(0, beyond), y[Math.max(0, beyond - 1)]] };
}
