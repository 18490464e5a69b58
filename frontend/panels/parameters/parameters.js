// @ts-check
// The parameters of the design: a number and a slider each, the method, presets, the units that all is shown in, and the
// explanation of the field in focus.

import { element } from '../../dom.js';
import { GROUPS } from '../../fields.js';
import { STEPS_AND_SECONDS } from '../../units.js';
import { createInfo } from './info.js';
import { createMethod } from './method.js';
import { createNumber } from './number.js';
import { createPresetPicker } from './preset_picker.js';
import { createUnitsChoice } from './units_choice.js';

/** @typedef {import('../../types.js').Design} Design */
/** @typedef {import('../../types.js').MethodName} MethodName */
/** @typedef {import('../../messages.js').Messages} Messages */
/** @typedef {import('../../presets.js').Part} Part */
/** @typedef {import('../../presets.js').Preset} Preset */
/** @typedef {import('../../units.js').Units} Units */

const WELCOME = {
  label: 'Parameters',
  formula: '',
  help: 'Point at a parameter to read what it is and what it does to the ramp. Arrow keys step it: Shift coarse, Alt fine.',
};

/**
 * @param {HTMLElement} root
 * @param {object} handlers
 * @param {(path: string, value: unknown, gesture?: string) => void} handlers.onEdit  changes in a row with the same
 *   gesture are one
 * @param {(name: MethodName) => void} handlers.onMethod
 * @param {(part: Part, preset: Preset) => void} handlers.onPreset
 * @param {(units: Units) => void} handlers.onUnits
 * @param {(isMoving: boolean) => void} handlers.onSliding
 */
export function createParameters(root, handlers) {
  const info = createInfo(WELCOME);
  const choice = createUnitsChoice(handlers.onUnits, info);
  const numbers = GROUPS.flatMap((group) => group.fields).map((field) => createNumber(field, handlers));
  const method = createMethod(handlers, info);
  const pickers = [
    createPresetPicker('axis', 'Axis', handlers.onPreset, info),
    createPresetPicker('timer', 'Timer', handlers.onPreset, info),
  ];
  const groups = GROUPS.map((group, index) =>
    element(
      'section',
      { className: 'group', 'aria-label': group.title },
      pickers[index]?.element ??
        element('div', { className: 'group-head' }, element('h2', { textContent: group.title })),
      ...numbers.filter((number) => group.fields.includes(number.field)).map((number) => number.element),
    ),
  );
  root.replaceChildren(
    choice.element,
    element('div', { className: 'groups' }, ...groups, method.element),
    info.element,
  );
  for (const { element: row, field, label } of numbers) info.explain(row, () => field, label);

  /** @type {Design | null} */
  let design = null;
  /** @type {Messages | null} */
  let messages = null;
  let units = STEPS_AND_SECONDS;

  function show() {
    if (design === null) return;
    choice.show(units, design);
    for (const number of numbers) number.show(design, units);
    for (const picker of pickers) picker.show(design);
    method.show(design);
  }

  function showMessages() {
    if (messages === null) return;
    for (const number of numbers) number.showMessage(messages.fields);
    method.showMessage(messages.fields);
  }

  return {
    /** @param {Design} present */
    show(present) {
      design = present;
      show();
      showMessages();
    },
    /** @param {Units} chosen */
    showUnits(chosen) {
      units = chosen;
      show();
      showMessages();
    },
    /** @param {Messages} sorted */
    showMessages(sorted) {
      messages = sorted;
      showMessages();
    },
  };
}
