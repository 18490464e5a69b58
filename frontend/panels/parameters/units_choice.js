// @ts-check
// The units that all panels show lengths, speeds and accelerations in.

import { element, segmented } from '../../ui/dom.js';
import { unitChoices, unitsFor } from '../../model/units.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/units.js').Units} Units */

const EXPLANATION = {
  label: 'Units',
  formula: '',
  help: 'What lengths, speeds and accelerations are shown and typed in, here and everywhere. The design stays as it is, in steps and seconds.',
};
const ALL_LENGTHS = /** @type {[Units['length'], string][]} */ ([
  ['steps', 'steps'],
  ['rev', 'rev'],
  ['deg', '°'],
  ['mm', 'mm'],
]);

/** @param {(units: Units) => void} onUnits @param {ReturnType<typeof import('./info.js').createInfo>} info */
export function createUnitsChoice(onUnits, info) {
  /** @type {Units} */
  let present = { length: 'steps', time: 's' };
  const length = segmented('Unit of length', ALL_LENGTHS, (unit) => onUnits({ ...present, length: unit }));
  const time = segmented(
    'Unit of time',
    [
      ['s', 's'],
      ['min', 'min'],
    ],
    (unit) => onUnits({ ...present, time: /** @type {Units['time']} */ (unit) }),
  );
  length.element.classList.add('fill');
  length.element.id = 'length-unit';
  time.element.id = 'time-unit';
  const names = { rev: 'revolutions', deg: 'degrees', mm: 'mm, millimetres', min: 'minutes', s: 'seconds' };
  for (const [value, name] of Object.entries(names)) {
    const button =
      length.element.querySelector(`[data-value="${value}"]`) ?? time.element.querySelector(`[data-value="${value}"]`);
    button?.setAttribute('aria-label', name);
  }
  const title = element('span', { textContent: 'Units' });
  const row = element('div', { className: 'units' }, title, length.element, time.element);
  info.explain(row, () => EXPLANATION, title);

  return {
    element: row,
    /** @param {Units} units @param {Design} design */
    show(units, design) {
      present = units;
      const offered = unitChoices(design).map(([unit]) => unit);
      for (const button of length.element.querySelectorAll('button')) {
        button.hidden = !offered.some((unit) => unit === button.dataset.value);
      }
      length.press(unitsFor(units, design).length);
      time.press(units.time);
    },
  };
}
