// @ts-check
// A gauge's way: its position over time, and the targets it was after.

import { formatFigures } from '../../model/numbers.js';
import { createTimeChart } from '../../ui/time_chart.js';

/** @typedef {import('../../model/types.js').PlayedTable} PlayedTable */
/** @typedef {{at_us: number, target: number}} Target */

const HEIGHT = 160;
const TICKS = 4;

export function createPlayChart() {
  const chart = createTimeChart(HEIGHT);
  return {
    element: chart.element,
    /** @param {PlayedTable | null} played @param {Target[]} targets @param {string} [text] what it does, in words */
    show(played, targets, text) {
      chart.show(played && chartOf(played, targets), `Position over time. ${text}`);
    },
  };
}

/** @param {PlayedTable} played @param {Target[]} targets @returns {import('../../ui/time_chart.js').TimeChart} */
function chartOf({ steps, stops }, targets) {
  const end = Math.max(1, ...stops.map((stop) => stop.at_us), ...targets.map((target) => target.at_us));
  const high = Math.max(1, ...targets.map((target) => target.target), ...stops.map((stop) => stop.position));
  const parts = Array.from({ length: TICKS + 1 }, (_, tick) => tick / TICKS);
  const last = targets.length - 1;
  return {
    end,
    low: 0,
    high,
    times: parts.map((part) => ({ at: end * part, text: `${formatFigures((end * part) / 1000, 2)}${part === 1 ? ' ms' : ''}` })),
    levels: parts.map((part) => Math.round(high * part)).map((step) => ({ at: step, text: String(step) })),
    wanted: { x: [...targets.map(({ at_us }) => at_us), end], y: [...targets, targets[last]].map(({ target }) => target) },
    way: { x: [0, ...steps.at_us, end], y: [0, ...steps.position, steps.position.at(-1) ?? 0] },
    dots: stops.map(({ at_us, position }) => ({ x: at_us, y: position })),
  };
}
