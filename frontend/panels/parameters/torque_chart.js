// @ts-check
// Available and required torque over the speed, what is kept back between them, and the speeds at which the rotor swings in
// time with the steps.

import { usedText } from '../../model/motor_words.js';
import { formatFigures } from '../../model/numbers.js';
import { shownValue, unitWord } from '../../model/units.js';
import { chartText, gridLine } from '../../ui/chart.js';
import { element, svgElement } from '../../ui/dom.js';

const WIDTH = 264;
const HEIGHT = 138;
const LEFT = 44;
const RIGHT = 12;
const TOP = 14;
const BOTTOM = 24;
const PARTS = [0, 0.5, 1];
/** @type {[string, string, 'line' | 'area'][]} */
const KEY = [
  ['line available', 'available', 'line'],
  ['line required', 'asked for', 'line'],
  ['margin', 'kept back', 'area'],
  ['lacking', 'lacking', 'area'],
  ['band', 'resonance', 'area'],
];

export function createTorqueChart() {
  const drawing = svgElement('svg', { class: 'torque-chart', viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'img' });
  const [bands, scale] = [svgElement('g'), svgElement('g', { 'aria-hidden': 'true' })];
  const [margin, lacking, available, required] = ['margin', 'lacking', 'line available', 'line required'].map((name) => svgElement('path', { class: name }));
  drawing.append(bands, scale, margin, lacking, available, required);
  const key = element('ul', { className: 'torque-key', 'aria-hidden': 'true' }, ...KEY.map(([name, text, kind]) => element('li', {}, swatch(name, kind), text)));
  const box = element('div', {}, drawing, key);
  /** What is drawn: the same answer is told of again and again.
   * @type {unknown[]} */
  let drawn = [];

  /** @param {import('../../model/types.js').MotorAnswer} answer @param {import('../../model/units.js').Units} units
   * @param {import('../../model/types.js').Design} design */
  function draw(answer, units, design) {
    const { speed_steps_per_s: speeds, pull_out_nm: has, required_nm: asks } = answer.torque;
    const fastest = speeds[speeds.length - 1] || 1;
    const most = 1.05 * Math.max(...has, ...asks, 1e-9);
    const x = (/** @type {number} */ speed) => LEFT + (Math.min(speed, fastest) / fastest) * (WIDTH - LEFT - RIGHT);
    const y = (/** @type {number} */ torque) => TOP + (1 - torque / most) * (HEIGHT - TOP - BOTTOM);
    const points = (/** @type {number[]} */ torques) => torques.map((torque, i) => `${x(speeds[i]).toFixed(1)},${y(torque).toFixed(1)}`);
    const [along, beneath] = [points(has), points(asks)];
    const above = along.map((point, i) => (has[i] >= asks[i] ? point : beneath[i])).join('L');
    const isLacking = has.some((torque, i) => torque < asks[i]);
    available.setAttribute('d', `M${along.join('L')}`);
    required.setAttribute('d', `M${beneath.join('L')}`);
    margin.setAttribute('d', `M${above}L${[...beneath].reverse().join('L')}Z`);
    lacking.setAttribute('d', isLacking ? `M${above}L${[...along].reverse().join('L')}Z` : '');
    const speedOf = (/** @type {number} */ part) => formatFigures(shownValue(units, design, 'speed', part * fastest), 3);
    scale.replaceChildren(
      ...PARTS.flatMap((part) => gridLine(part === 1 ? formatFigures(most, 2) : part === 0 ? '0' : '', LEFT, WIDTH - RIGHT, y(part * most))),
      chartText('Nm', LEFT, TOP - 5, 'start'),
      chartText(unitWord(units, design, 'speed'), WIDTH - RIGHT, TOP - 5, 'end'),
      ...PARTS.map((part) => chartText(part === 0 ? '0' : speedOf(part), x(part * fastest), HEIGHT - 8, part === 1 ? 'end' : 'middle')),
    );
    bands.replaceChildren(
      ...answer.resonances_steps_per_s
        .filter(([low]) => low < fastest)
        .map(([low, high]) => svgElement('rect', { class: 'band', x: x(low), y: TOP, width: Math.max(1, x(high) - x(low)), height: HEIGHT - TOP - BOTTOM })),
    );
    key.children[KEY.findIndex(([name]) => name === 'lacking')].toggleAttribute('hidden', !isLacking);
    const used = answer.most_used === null ? usedText(null) : `up to ${usedText(answer.most_used)} of it`;
    drawing.setAttribute('aria-label', `Torque over speed: available, and required, which is ${used}. Between them is what is kept back. Resonances are shaded.`);
  }

  return {
    element: box,
    /** @param {import('../../model/types.js').MotorAnswer | null} answer @param {import('../../model/units.js').Units} units
     * @param {import('../../model/types.js').Design} design */
    show(answer, units, design) {
      box.hidden = answer === null;
      const now = [answer, units, design.axis];
      if (answer === null || now.every((one, index) => one === drawn[index])) return;
      drawn = now;
      draw(answer, units, design);
    },
  };
}

/** @param {string} name @param {'line' | 'area'} kind */
function swatch(name, kind) {
  const drawing = svgElement('svg', { viewBox: '0 0 16 10' });
  drawing.append(kind === 'line' ? svgElement('path', { class: name, d: 'M0 5H16' }) : svgElement('rect', { class: name, width: 16, height: 10 }));
  return drawing;
}
