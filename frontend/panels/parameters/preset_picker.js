// @ts-check
// The presets of a group: the list shows which one the values are those of.

import { element, picker } from '../../ui/dom.js';
import { GROUPS } from '../../model/fields.js';
import { formatEntry } from '../../model/numbers.js';
import { PRESETS, presetOf } from '../../model/presets.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/presets.js').Part} Part */
/** @typedef {import('../../model/presets.js').Preset} Preset */

const FIELDS = GROUPS.flatMap((group) => group.fields);
const NONE = '';

/**
 * @param {Part} part
 * @param {string} title of the group
 * @param {(part: Part, preset: Preset) => void} onPreset
 * @param {ReturnType<typeof import('./info.js').createInfo>} info
 */
export function createPresetPicker(part, title, onPreset, info) {
  const presets = PRESETS[part];
  const list = picker(`${title} presets`, (name) => {
    const preset = presets.find((one) => one.name === name);
    if (preset === undefined) return;
    onPreset(part, preset);
    info.show(explanation(preset));
  });
  list.element.classList.add('quiet');
  list.select.id = `${part}-presets`;
  const heading = element('h2', { textContent: title });
  const head = element('div', { className: 'group-head' }, heading, list.element);
  const general = {
    label: `${title} presets`,
    formula: '',
    help: 'Fill these fields in one go with the facts of a usual part. All other fields stay; undo takes it back.',
  };
  info.explain(
    head,
    () => {
      const preset = presets.find((one) => one.name === list.select.value);
      return preset ? { label: preset.name, formula: '', help: preset.help } : general;
    },
    heading,
  );

  /** @param {Preset} preset */
  function explanation(preset) {
    return { label: preset.name, formula: '', help: `Set: ${settingsOf(part, preset)}. ${preset.help}` };
  }

  return {
    element: head,
    /** @param {Design} design */
    show(design) {
      const chosen = presetOf(design, part)?.name ?? NONE;
      const names = presets.map((preset) => /** @type {[string, string]} */ ([preset.name, preset.name]));
      list.offer([[NONE, chosen === NONE ? 'Presets' : 'Other values'], ...names], chosen);
      // Nothing is set by it: it only tells that the values are nobody's.
      list.select.options[0].disabled = true;
    },
  };
}

/** What a preset sets, in words: "steps a turn 200 full steps, travel a turn 8 mm".
 * @param {Part} part
 * @param {Preset} preset */
function settingsOf(part, { values }) {
  const { travel_unit: travelUnit, ...numbers } = values;
  return Object.entries(numbers)
    .map(([name, value]) => {
      const field = FIELDS.find((one) => one.path === `${part}.${name}`);
      return `${field?.label.toLowerCase()} ${formatEntry(value)} ${field?.unit || travelUnit}`;
    })
    .join(', ');
}
