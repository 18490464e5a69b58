// @ts-check
// The dialog for how the controller drives its pins, which is on trial until it is kept, and for the soft limits of axes,
// which the server keeps.

import { api, Refusal } from '../../server/api.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, icon, messageLine } from '../../ui/dom.js';
import { selectOnFocus } from '../../ui/select_on_focus.js';
import { formatEntry, parseEntry } from '../../model/numbers.js';
import { createLimitFields } from './limits.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').Settings} Settings */
/** @typedef {{name: string, label: string, explained: string} & ({choices: [string, string][]} | {axes: true} |
 *   {unit: string, nullable?: string})} Setting */

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
];
const MOST_AXES = 4;

/** @param {{limit: (device: Device, axes: import('../../model/types.js').SoftLimits[]) => Promise<void>,
 *   useSettings: (device: Device, settings: unknown) => Promise<void>}} handlers */
export function createSettingsDialog({ limit, useSettings }) {
  /** @type {Device | null} */
  let device = null;
  /** The settings as the device has them; null: not known.
   * @type {Settings | null} */
  let before = null;
  const limits = createLimitFields();
  const controls = SETTINGS.map(controlOf);
  const problem = element('div', { className: 'problem', role: 'alert' });
  const pins = element(
    'div',
    { id: 'pin-settings' },
    element('h3', { textContent: 'How the controller drives its pins' }),
    element('p', { className: 'reason', textContent: 'On trial until it is kept, in the Push section.' }),
    ...controls.map((control) => control.element),
  );
  const dialog = createDialog(
    { id: 'settings-dialog', title: 'Device settings', onSubmit: submitted },
    pins,
    element('h3', { textContent: 'Soft limits' }),
    element('p', {
      className: 'reason',
      textContent:
        'Positions that an axis is kept within: what leads beyond is refused, and a run slows down in time. Empty: none. ' +
        'The server keeps them until it ends; this page remembers them for the port.',
    }),
    limits.element,
    problem,
    dialogFoot(
      () => dialog.close(),
      element('button', { className: 'button primary', id: 'use-settings', type: 'submit', textContent: 'Use them' }),
    ),
  );

  /** @param {unknown} error */
  function showProblem(error) {
    const text = error instanceof Error ? error.message : String(error);
    problem.replaceChildren(messageLine({ text, isWarning: false }));
  }

  /** The settings as they are wanted; those that have no field here stay as they are.
   * @param {Settings} present */
  function wanted(present) {
    const shown = controls.filter((control) => control.name in present);
    return { ...present, ...Object.fromEntries(shown.map((control) => [control.name, control.value()])) };
  }

  /** What is changed is sent, and no more.
   * @param {SubmitEvent} event */
  async function submitted(event) {
    event.preventDefault();
    if (device === null) return;
    problem.replaceChildren();
    limits.reject([]);
    try {
      const axes = limits.changed();
      if (axes.length > 0) await limit(device, axes);
      const settings = before && wanted(before);
      if (settings && JSON.stringify(settings) !== JSON.stringify(before)) await useSettings(device, settings);
      dialog.close();
    } catch (error) {
      const others = error instanceof Refusal ? limits.reject(error.rejections) : [error];
      if (others.length > 0) showProblem(error);
    }
  }

  /** @param {Device} present */
  async function showSettings(present) {
    try {
      const settings = await api.settings(present.id);
      if (present !== device) return;
      for (const control of controls) {
        control.element.hidden = !(control.name in settings);
        control.show(settings[control.name]);
      }
      // As its fields say it: they know no order of axes, and no other spelling of a number.
      before = wanted(settings);
      pins.hidden = false;
    } catch (error) {
      if (present === device) showProblem(error);
    }
  }

  return {
    /** @param {Device} present @param {import('../../model/types.js').Situation} situation */
    async open(present, situation) {
      device = present;
      before = null;
      problem.replaceChildren();
      limits.show(present, situation);
      // Of settings that are not known nothing can be used: their fields come with them.
      pins.hidden = true;
      if (present.capabilities.includes('settings')) await showSettings(present);
      if (present !== device) return;
      dialog.open(pins.hidden ? limits.element.querySelector('input') : controls[0].first());
    },
  };
}

/** @param {Setting} setting */
function controlOf(setting) {
  const id = `setting-${setting.name}`;
  const hint = `${id}-hint`;
  const made =
    'choices' in setting ? choice(id, hint, setting.choices) : 'axes' in setting ? axesBoxes(setting.label, hint) : number(id, hint, setting);
  return {
    name: setting.name,
    value: made.value,
    show: made.show,
    first: () => /** @type {HTMLElement | null} */ (made.element.querySelector('input, select')),
    element: element(
      'div',
      { className: 'setting' },
      element('label', { htmlFor: id, textContent: setting.label }),
      made.element,
      element('p', { className: 'reason', id: hint, textContent: setting.explained }),
    ),
  };
}

/** @param {string} id @param {string} hint @param {[string, string][]} choices */
function choice(id, hint, choices) {
  const select = element(
    'select',
    { id, 'aria-describedby': hint },
    ...choices.map(([value, textContent]) => element('option', { value, textContent })),
  );
  return {
    element: /** @type {HTMLElement} */ (element('span', { className: 'picker' }, select, icon('down'))),
    value: () => /** @type {unknown} */ (select.value),
    /** @param {unknown} value */
    show(value) {
      select.value = String(value);
    },
  };
}

/** @param {string} label @param {string} hint */
function axesBoxes(label, hint) {
  const boxes = Array.from({ length: MOST_AXES }, (_, axis) =>
    element('input', { type: 'checkbox', 'aria-label': `${label}: axis ${axis}`, 'aria-describedby': hint }),
  );
  return {
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

/** @param {string} id @param {string} hint @param {{unit: string, nullable?: string}} setting */
function number(id, hint, { unit, nullable }) {
  const input = element('input', {
    id,
    inputMode: 'decimal',
    autocomplete: 'off',
    placeholder: nullable ?? '',
    'aria-describedby': hint,
  });
  selectOnFocus(input);
  return {
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
