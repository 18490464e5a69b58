// @ts-check
// The figures of all axes, where the plots show all: how long they take together, and what each does in that time.

import { formatFigures, formatFixed } from '../../model/numbers.js';
import { shownValue, unitWord } from '../../model/units.js';
import { element } from '../../ui/dom.js';
import { createStat, durationWords, formatSpeed } from './stat.js';

/** @typedef {import('../../app/state.js').AllAxes} AllAxes */
/** @typedef {import('../../model/units.js').Units} Units */
/** @typedef {{title: string, value: string, unit: string, more: string}} AxisFigure */

/** Together, then each axis.
 * @param {AllAxes} all @param {Units} units @returns {AxisFigure[]} none while nothing is planned */
export function axesFigures({ axes: designs, together, planned }, units) {
  if (planned === null) return [];
  const [value, unit] = durationWords(planned.duration_s);
  const isLine = together === 'line';
  const more = isLine ? `along a line, ${planned.leader} leads` : 'until the last one rests';
  return [
    { title: 'Duration of all axes', value, unit, more },
    ...planned.axes.map(({ name, steps, duration_s, pulses }, number) => {
      const design = designs[number];
      const peak = pulses.speed_steps_per_s.reduce((most, speed) => Math.max(most, speed), 0);
      const way = `${formatFigures(shownValue(units, design, 'length', steps))} ${unitWord(units, design, 'length')}`;
      const moved = unitWord(units, design, 'length') === 'steps' ? `${formatFixed(steps)} steps` : way;
      return {
        title: `${number} ${name || 'unnamed'}: peak speed`,
        value: formatSpeed(shownValue(units, design, 'speed', peak)),
        unit: unitWord(units, design, 'speed'),
        more: isLine ? moved : `${moved} in ${durationWords(duration_s).join(' ')}`,
      };
    }),
  ];
}

export function createAxesFigures() {
  const list = element('dl', { className: 'figures strip of-axes', hidden: true });
  return {
    element: list,
    /** @param {AxisFigure[]} figures */
    show(figures) {
      list.hidden = figures.length === 0;
      list.replaceChildren(
        ...figures.map(({ title, value, unit, more }, number) => {
          const stat = createStat(number === 0 ? 'all' : `axis-${number - 1}`, title);
          stat.value.append(value, element('small', { textContent: ` ${unit}` }));
          stat.more.textContent = more;
          return stat.element;
        }),
      );
    },
  };
}
