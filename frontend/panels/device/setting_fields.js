// @ts-check
// How the controller drives its pins, as fields: what they hold, what is changed, and what is refused of it at its field.

import { element, icon } from '../../ui/dom.js';
import { selectOnFocus } from '../../ui/select_on_focus.js';
import { limitsInUnit } from '../../model/limits_text.js';
import { refusalText } from '../../model/messages.js';
import { formatEntry, parseEntry } from '../../model/numbers.js';
import { DEVICE_TAKES, refusalOf } from '../../model/taken.js';
import { showAtPlaces } from '../../ui/refusal.js';
import { createInputFields } from './input_fields.js';

/** @typedef {import('../../model/types.js').Rejection} Rejection */
/** @typedef {import('../../model/types.js').Settings} Settings */
/** ofInputs: only controllers with inputs have it, for others it is null.
 * @typedef {{name: string, label: string, explained: string, ofInputs?: true} & ({choices: [string, string][]} | {axes: true} |
 *   {isYesOrNo: true} | {unit: string, nullable?: string})} Setting */

/** @type {Setting[]} */
const SETTINGS = [
  {
    name: 'outputs',
    label: 'Outputs',
    explained: 'A step and a direction pin for each axis, or four coil pins for each of three gauges.',
    choices: [
      ['step_and_direction', 'Step and direction'],
      ['gauges', 'Gauges'],
    ],
  },
  { name: 'both_edges', label: 'Step at both edges', explained: 'Axes whose driver steps when the pin rises and when it falls.', axes: true },
  { name: 'step_inverted', label: 'Step pin inverted', explained: 'Axes whose step pin rests high.', axes: true },
  { name: 'direction_inverted', label: 'Direction inverted', explained: 'Axes whose direction pin is low for forwards: they turn the other way.', axes: true },
  { name: 'pulse_width_us', label: 'Pulse width', explained: 'Least width of a step pulse; 0: as short as the controller makes it. See the data sheet of the driver. With wide pulses the fastest speeds are out of reach.', unit: 'µs' },
  { name: 'direction_setup_us', label: 'Direction setup', explained: 'Time from a change of direction to the next pulse.', unit: 'µs' },
  {
    name: 'enable_level',
    label: 'Enable level',
    explained: 'Level of the enable pin while the motors are on. Most drivers want it low.',
    choices: [
      ['low', 'Low'],
      ['high', 'High'],
    ],
  },
  { name: 'enable_lead_ms', label: 'Enable lead', explained: 'Time from switching the motors on to the first pulse.', unit: 'ms' },
  { name: 'enable_hold_ms', label: 'Enable hold', explained: 'Time from the last step to switching the motors off; empty: they stay on.', unit: 'ms', nullable: 'stay on' },
  { name: 'silence_s', label: 'Lease', explained: 'Runs and homing slow down when the controller has heard nothing for so long. It is taken in steps of 0.256 s.', unit: 's', ofInputs: true },
  { name: 'silence_ends_moves', label: 'Lease holds for moves', explained: 'Moves and lines slow down then, too.', isYesOrNo: true, ofInputs: true },
  { name: 'looks', label: 'Debounce', explained: 'An input counts as changed once it was found so in so many looks in a row: 1 ms apart, at an emergency stop 4 µs.', unit: 'looks', ofInputs: true },
];
const MOST_AXES = 4;

export function createSettingFields() {
  /** The settings as the device has them; null: not known.
   * @type {Settings | null} */
  let before = null;
  const controls = SETTINGS.map(controlOf);
  const inputs = createInputFields();

  /** The settings as they are wanted; those that have no field here stay as they are.
   * @param {Settings} present */
  function wanted(present) {
    const shown = controls.filter((control) => control.isIn(present));
    const roles = present.inputs ? { inputs: inputs.value() } : {};
    return { ...present, ...Object.fromEntries(shown.map((control) => [control.name, control.value()])), ...roles };
  }

  return {
    elements: [...controls.map((control) => control.element), inputs.element],
    first: controls[0].first,
    /** @param {Settings} settings */
    show(settings) {
      for (const control of controls) {
        control.element.hidden = !control.isIn(settings);
        control.show(settings[control.name]);
      }
      inputs.element.hidden = !settings.inputs;
      inputs.show(/** @type {import('../../model/types.js').InputRole[]} */ (settings.inputs ?? []));
      // As its fields say it: they know no order of axes, and no other spelling of a number.
      before = wanted(settings);
    },
    /** They are not known, until they are shown. */
    forget() {
      before = null;
    },
    /** All settings, once one is wanted otherwise; null: none is. */
    changed() {
      const now = before && wanted(before);
      return JSON.stringify(now) === JSON.stringify(before) ? null : now;
    },
    /** They are in use now.
     * @param {Settings} settings */
    taken(settings) {
      before = settings;
    },
    /** What the server would refuse of changed ones.
     * @param {Settings} settings @returns {Rejection[]} */
    refusals: (settings) =>
      controls.flatMap((control) => (control.isIn(settings) ? control.refusal(settings[control.name]) : null) ?? []),
    /** Show what is wrong with a field at it.
     * @param {Rejection[]} rejections @returns {Rejection[]} those of no field here */
    reject(rejections) {
      return showAtPlaces(rejections, [...controls.flatMap(({ place }) => place ?? []), ...inputs.places()]);
    },
  };
}

/** @param {Setting} setting */
function controlOf(setting) {
  const id = `setting-${setting.name}`;
  const hint = `${id}-hint`;
  const made =
    'choices' in setting ? choice(id, hint, setting.choices) : 'axes' in setting
      ? axesBoxes(setting.label, hint)
      : 'isYesOrNo' in setting
        ? yesOrNo(id, hint)
        : number(id, hint, setting);
  return {
    name: setting.name,
    isIn: (/** @type {Settings} */ settings) => setting.name in settings && !(setting.ofInputs && settings[setting.name] === null),
    value: made.value,
    show: made.show,
    refusal: made.refusal,
    place: made.place,
    first: () => /** @type {HTMLElement | null} */ (made.element.querySelector('input, select')),
    element: element(
      'div',
      { className: 'setting' },
      element('label', { htmlFor: id, textContent: setting.label }),
      made.element,
      element('p', { className: 'reason', id: hint, textContent: setting.explained }),
      made.place?.problem,
    ),
  };
}

/** What is chosen of what there is can't be refused.
 * @type {{refusal: (value: unknown) => Rejection | null, place: import('../../ui/refusal.js').Place | null}} */
const NEVER_REFUSED = { refusal: () => null, place: null };

/** @param {string} id @param {string} hint @param {[string, string][]} choices */
function choice(id, hint, choices) {
  const select = element(
    'select',
    { id, 'aria-describedby': hint },
    ...choices.map(([value, textContent]) => element('option', { value, textContent })),
  );
  return {
    ...NEVER_REFUSED,
    element: /** @type {HTMLElement} */ (element('span', { className: 'picker' }, select, icon('down'))),
    value: () => /** @type {unknown} */ (select.value),
    /** @param {unknown} value */
    show(value) {
      select.value = String(value);
    },
  };
}

/** @param {string} id @param {string} hint */
function yesOrNo(id, hint) {
  const box = element('input', { id, type: 'checkbox', 'aria-describedby': hint });
  return {
    ...NEVER_REFUSED,
    element: /** @type {HTMLElement} */ (element('span', { className: 'line check' }, box)),
    value: () => /** @type {unknown} */ (box.checked),
    /** @param {unknown} value */
    show(value) {
      box.checked = value === true;
    },
  };
}

/** @param {string} label @param {string} hint */
function axesBoxes(label, hint) {
  const boxes = Array.from({ length: MOST_AXES }, (_, axis) =>
    element('input', { type: 'checkbox', 'aria-label': `${label}: axis ${axis}`, 'aria-describedby': hint }),
  );
  return {
    ...NEVER_REFUSED,
    element: /** @type {HTMLElement} */ (
      element(
        'span',
        { className: 'line check' },
        ...boxes.map((box, axis) => element('label', { className: 'line' }, box, String(axis))),
      )
    ),
    value: () => /** @type {unknown} */ (boxes.flatMap((box, axis) => (box.checked ? [axis] : []))),
    /** @param {unknown} value */
    show(value) {
      const chosen = Array.isArray(value) ? value : [];
      boxes.forEach((box, axis) => {
        box.checked = chosen.includes(axis);
      });
    },
  };
}

/** @param {string} id @param {string} hint @param {{name: string, label: string, unit: string, nullable?: string}} setting */
function number(id, hint, { name, label, unit, nullable }) {
  const note = nullable ? `, or empty: they ${nullable}` : '';
  const input = element('input', {
    id,
    inputMode: 'decimal',
    autocomplete: 'off',
    placeholder: nullable ?? '',
    'aria-describedby': hint,
    'data-explained-by': hint,
  });
  selectOnFocus(input);
  /** @type {import('../../ui/refusal.js').Place} */
  const place = {
    path: new RegExp(`^${name}$`),
    input,
    problem: element('div', { className: 'problem' }),
    text: (one) => refusalText(one, label, { allowed: one.limits && limitsInUnit({ ...one.limits, note }, one.unit ?? unit, 1) }),
  };
  return {
    place,
    /** @param {unknown} value @returns {Rejection | null} */
    refusal: (value) => (nullable && value === null ? null : refusalOf(name, value, DEVICE_TAKES[name], note)),
    element: /** @type {HTMLElement} */ (
      element('span', { className: 'field' }, input, element('span', { className: 'unit', textContent: unit }))
    ),
    value: () => /** @type {unknown} */ (nullable && input.value.trim() === '' ? null : parseEntry(input.value)),
    /** @param {unknown} value */
    show(value) {
      input.value = value === null ? '' : formatEntry(/** @type {number} */ (value));
    },
  };
}
