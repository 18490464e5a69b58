// @ts-check
// Soft limits: how far an axis may go, in words, and the fields that say so.

import { element } from '../../ui/dom.js';
import { formatEntry } from '../../model/numbers.js';
import { beyond, DEVICE_TAKES, refusalOf } from '../../model/taken.js';
import { shownValue, unitWord } from '../../model/units.js';
import { quantityField } from '../../ui/quantity_field.js';
import { showAtPlaces } from '../../ui/refusal.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').Rejection} Rejection */
/** @typedef {import('../../model/types.js').Situation} Situation */
/** @typedef {import('../../model/types.js').SoftLimits} SoftLimits */
/** @typedef {import('../../model/units.js').Units} Units */

const MOST_AXES = 4;
const MOST_FIGURES = 7;

/** Such as "−1,000 to 20,000 steps", or "only 0 steps"; empty for none.
 * @param {Units} units @param {Design} design @param {Omit<SoftLimits, 'axis'>} limits */
export function limitsText(units, design, { lowest_steps: lowest, highest_steps: highest }) {
  if (lowest === null && highest === null) return '';
  const [low, high] = [lowest, highest].map((steps) => {
    const shown = shownValue(units, design, 'length', Number(steps));
    return formatEntry(Number(shown.toPrecision(MOST_FIGURES))).replace('-', '\u2212');
  });
  const [from, to] = [lowest === null ? '' : `from ${low}`, highest === null ? '' : `up to ${high}`];
  const span = lowest === highest ? `only ${low}` : from && to ? `${low} to ${high}` : from || to;
  return `${span} ${unitWord(units, design, 'length')}`;
}

/** Lowest and highest position of each axis of a device. */
export function createLimitFields() {
  /** What each axis of the device had when it was shown.
   * @type {string[]} */
  let before = [];
  /** The axes last asked for, in the order that a refusal counts them.
   * @type {number[]} */
  let asked = [];
  let count = 0;
  const rows = Array.from({ length: MOST_AXES }, (_, axis) => {
    const fields = /** @type {const} */ (['lowest', 'highest']).map((side) => {
      const label = `${side === 'lowest' ? 'Lowest' : 'Highest'} position of axis ${axis}`;
      // The limit in force is never beyond the one that was typed.
      const toWhole = side === 'lowest' ? Math.ceil : Math.floor;
      const field = quantityField({ id: `limit-${axis}-${side}`, label, quantity: 'length', start: '', toWhole });
      field.input.placeholder = 'none';
      return { side, field, problem: element('div', { className: 'problem' }) };
    });
    const name = element('span', { textContent: `Axis ${axis}` });
    const parts = fields.flatMap(({ side, field }) => [element('span', { textContent: side }), field.element]);
    const problems = fields.map(({ problem }) => problem);
    return { fields, element: element('div', { className: 'limit-axis' }, name, ...parts, ...problems) };
  });

  /** @returns {SoftLimits[]} */
  function entries() {
    return rows.slice(0, count).map(({ fields }, axis) => {
      const [lowest, highest] = fields.map(({ field }) => (field.value() === '' ? null : field.value()));
      return { axis, lowest_steps: lowest, highest_steps: highest };
    });
  }

  return {
    element: element('div', { className: 'limit-axes' }, ...rows.map((row) => row.element)),
    /** @param {Device} device @param {Situation} situation */
    show(device, { scaled, units }) {
      count = device.axes.length;
      rows.forEach((row, axis) => {
        row.element.hidden = axis >= count;
        for (const { side, field } of row.fields) {
          field.set(device.axes[axis]?.[`${side}_steps`] ?? '');
          field.show(units, scaled[axis] ?? scaled[0]);
        }
      });
      before = entries().map((one) => JSON.stringify(one));
    },
    /** Those that a person changed: what others set in the meantime stays.
     * @returns {SoftLimits[]} */
    changed() {
      const changed = entries().filter((one, axis) => JSON.stringify(one) !== before[axis]);
      asked = changed.map(({ axis }) => axis);
      return changed;
    },
    /** What the server would refuse of changed ones.
     * @param {SoftLimits[]} changed */
    refusals: (changed) => changed.flatMap((one, index) => refusalsOf(one, `axes.${index}.`)),
    /** What was refused for the lowest position that stood in a field which is typed in: all else has a highest one, too.
     * @param {EventTarget | null} input @param {Rejection[]} rejections @returns {Rejection[]} the others; the same list
     *   when there is none */
    withoutThatFor(input, rejections) {
      const axis = rows.findIndex(({ fields: [lowest] }) => lowest.field.input === input);
      const path = `axes.${asked.indexOf(axis)}.highest_steps`;
      const isFor = (/** @type {Rejection} */ one) => one.field === path && one.limits?.highest === null;
      return rejections.some(isFor) ? rejections.filter((one) => !isFor(one)) : rejections;
    },
    /** Show what is wrong with a field at it.
     * @param {Rejection[]} rejections @returns {Rejection[]} those of no field here */
    reject(rejections) {
      const places = rows.flatMap(({ fields }, axis) =>
        fields.map(({ side, field, problem }) => ({
          path: new RegExp(`^axes\\.${asked.indexOf(axis)}\\.${side}_steps$`),
          input: field.input,
          problem,
          text: (/** @type {Rejection} */ one) => field.refusal(one, side === 'lowest' ? 'Lowest' : 'Highest'),
        })),
      );
      return showAtPlaces(rejections, places);
    },
  };
}

/** @param {SoftLimits} limits @param {string} place of their fields @returns {Rejection[]} */
function refusalsOf({ lowest_steps: lowest, highest_steps: highest }, place) {
  const refused = Object.entries({ lowest_steps: lowest, highest_steps: highest }).flatMap(
    ([name, steps]) => (steps === null ? null : refusalOf(`${place}${name}`, steps, DEVICE_TAKES[name])) ?? [],
  );
  if (refused.length > 0 || lowest === null || highest === null || highest >= lowest) return refused;
  const behind = { lowest: Number(lowest), highest: null, is_whole: true, note: ', the lowest' };
  return [beyond(`${place}highest_steps`, highest, behind, 'steps')];
}
