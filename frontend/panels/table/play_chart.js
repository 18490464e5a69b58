// @ts-check
// A gauge's way: its position over time, and the targets it was after.

import { svgElement } from '../../ui/dom.js';
import { formatFigures } from '../../model/numbers.js';
import { chartText, gridLine } from './chart.js';

/** @typedef {import('../../model/types.js').PlayedTable} PlayedTable */
/** @typedef {{at_us: number, target: number}} Target */

const WIDTH = 420;
const HEIGHT = 160;
const LEFT = 44;
const RIGHT = 12;
const TOP = 12;
const BOTTOM = 26;
const TICKS = 4;

export function createPlayChart() {
  const drawing = svgElement('svg', { class: 'fit-chart still', viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'img' });

  return {
    element: drawing,
    /** @param {PlayedTable | null} played @param {Target[]} targets */
    show(played, targets) {
      drawing.replaceChildren();
      if (played === null) return;
      const endUs = Math.max(1, ...played.stops.map((stop) => stop.at_us), ...targets.map((target) => target.at_us));
      const top = Math.max(1, ...targets.map((target) => target.target), ...played.stops.map((stop) => stop.position));
      const xOf = (/** @type {number} */ us) => LEFT + (us / endUs) * (WIDTH - LEFT - RIGHT);
      const yOf = (/** @type {number} */ step) => TOP + (1 - step / top) * (HEIGHT - TOP - BOTTOM);
      for (let tick = 0; tick <= TICKS; tick += 1) {
        const [step, us] = [Math.round((top * tick) / TICKS), (endUs * tick) / TICKS];
        const time = `${formatFigures(us / 1000, 2)}${tick === TICKS ? ' ms' : ''}`;
        drawing.append(
          ...gridLine(String(step), LEFT, WIDTH - RIGHT, yOf(step)),
          chartText(time, xOf(us), HEIGHT - 8, tick === TICKS ? 'end' : 'middle'),
        );
      }
      const wanted = targets.map(({ at_us, target }, at) => {
        const until = xOf(targets[at + 1]?.at_us ?? endUs);
        return `${at === 0 ? 'M' : 'L'}${xOf(at_us)} ${yOf(target)}H${until}`;
      });
      drawing.append(svgElement('path', { class: 'wanted', d: wanted.join('') }));
      const way = played.steps.at_us.map((us, at) => `H${xOf(us)}V${yOf(played.steps.position[at])}`);
      drawing.append(svgElement('path', { class: 'line', d: `M${LEFT} ${yOf(0)}${way.join('')}H${xOf(endUs)}` }));
      for (const { at_us, position } of played.stops)
        drawing.append(svgElement('circle', { class: 'dot', cx: xOf(at_us), cy: yOf(position), r: 3 }));
    },
  };
}
