// @ts-check
// How one axis is to be homed, as fields: whether it is, towards which end, how fast, and what its place is called then.

import { element, icon } from '../../ui/dom.js';
import { quantityField } from '../../ui/quantity_field.js';
import { switchOf } from '../../devices/homing.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../documents/memory.js').AxisHomeKept} AxisHomeKept */

/** A part of the slew speed that is slow enough to be looked at. */
const FIRST_PART_OF_SLEW = 0.25;
const SPEED_FIGURES = 3;
const ENDS = /** @type {const} */ (['low', 'high']);

/** @param {number} axis */
export function createHomeAxis(axis) {
  const box = element('input', { type: 'checkbox', id: `home-${axis}` });
  const end = element('select', { id: `home-${axis}-end`, 'aria-label': `Which switch axis ${axis} finds` });
  const fast = quantityField({ id: `home-${axis}-fast`, label: `Fast speed of axis ${axis}`, quantity: 'speed', start: firstSpeed });
  const position = quantityField({ id: `home-${axis}-position`, label: `Position of axis ${axis} at the switch`, quantity: 'length', start: 0 });
  const problems = [fast, position].map(() => element('div', { className: 'problem' }));
  const details = element(
    'div',
    { className: 'home-details' },
    element('span', { textContent: 'Towards' }),
    element('span', { className: 'picker' }, end, icon('down')),
    element('span', { textContent: 'Fast' }),
    fast.element,
    problems[0],
    element('span', { textContent: 'Position there' }),
    position.element,
    problems[1],
  );
  const whole = element(
    'div',
    { className: 'home-axis', role: 'group', 'aria-label': `Axis ${axis}` },
    element('label', { className: 'line check' }, box, `Axis ${axis}`),
    details,
  );
  const isChosen = () => !whole.hidden && box.checked;

  return {
    axis,
    element: whole,
    isChosen,
    /** @returns {AxisHomeKept} */
    kept: () => ({ axis, isChosen: box.checked, end: end.value === 'high' ? 'high' : 'low', fast: fast.value(), position: position.value() }),
    /** What can't be sent: which way it goes its end says, so that a sign would turn it round.
     * @param {number} at its place among those that are asked for @returns {import('../../model/types.js').Rejection[]} */
    refused(at) {
      const value = fast.value();
      if (typeof value !== 'number' || value > 0) return [];
      const allowed = 'a speed above 0: which way it goes the switch says';
      return [{ field: `axes.${at}.fast_steps_per_s`, value, allowed, message: `The fast speed of axis ${axis} is ${value}; allowed: ${allowed}.` }];
    },
    /** @returns {{axis: number, fast_steps_per_s: unknown, position_steps: unknown}} */
    wish() {
      const speed = fast.value();
      const isBack = end.value !== 'high';
      return { axis, fast_steps_per_s: typeof speed === 'number' && isBack ? -speed : speed, position_steps: position.value() };
    },
    /** @param {Device} device @param {AxisHomeKept | undefined} kept @param {boolean} isFirst */
    fill(device, kept, isFirst) {
      const ends = ENDS.filter((one) => switchOf(device, axis, one) !== null);
      end.replaceChildren(...ends.map((one) => element('option', { value: one, textContent: `${one} end, ${switchOf(device, axis, one)?.input}` })));
      if (kept && ends.includes(kept.end)) end.value = kept.end;
      else end.value = ends[0] ?? '';
      whole.hidden = ends.length === 0;
      box.checked = kept?.isChosen ?? isFirst;
      if (kept) {
        fast.set(kept.fast);
        position.set(kept.position);
      } else for (const field of [fast, position]) field.reset();
    },
    /** @param {import('../../model/units.js').Units} units @param {import('../../model/types.js').Design} design */
    show(units, design) {
      fast.show(units, design);
      position.show(units, design);
      details.hidden = !box.checked;
    },
    /** @param {number} at its place among those that are asked for; -1: it isn't
     * @returns {import('../../ui/refusal.js').Place[]} */
    places: (at) => [
      { path: new RegExp(`^axes\\.${at}\\.fast_steps_per_s$`), input: fast.input, problem: problems[0], text: (one) => fast.refusal(one, `Fast speed of axis ${axis}`) },
      { path: new RegExp(`^axes\\.${at}\\.position_steps$`), input: position.input, problem: problems[1], text: (one) => position.refusal(one, `Position of axis ${axis}`) },
    ],
  };
}

/** @param {import('../../model/types.js').Design} design */
const firstSpeed = ({ ramp }) => Number((Number(ramp.slew_speed_steps_per_s) * FIRST_PART_OF_SLEW).toPrecision(SPEED_FIGURES));
