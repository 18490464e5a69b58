// @ts-check
// The parameters of the design: a number and a slider each, the method, presets, the units that all is shown in, and the
// explanation of the field in focus.

import { tell } from '../../app/commands/told.js';
import { setUnits } from '../../app/commands/view.js';
import { endGesture, setMethod, setPlan, setPreset, setShape, setValue } from '../../app/commands/work.js';
import { axisOf, designOf, messagesOf, motorOf, shownCurvesOf } from '../../app/selectors.js';
import { whenChanged, whenever } from '../../app/state.js';
import { element } from '../../ui/dom.js';
import { GROUPS } from '../../model/fields.js';
import { hasField, shapeOf } from '../../model/shapes.js';
import { shortMovesText } from '../../model/short_moves.js';
import { activeProfile } from '../../plotting/curves.js';
import { createChoice } from './choice.js';
import { createInfo } from './info.js';
import { createMethod } from './method.js';
import { createMotor } from './motor.js';
import { createNumber } from './number.js';
import { createPresetPicker } from './preset_picker.js';
import { createShape } from './shape.js';
import { createUnitsChoice } from './units_choice.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/units.js').Units} Units */

const WELCOME = {
  label: 'Parameters',
  formula: '',
  help: 'Point at a parameter to read what it is and what it does to the ramp. Arrow keys step it: Shift coarse, Alt fine.',
};

const MOTOR = 'Motor';
/** @type {[string, string][]} */
const PLANS = [
  ['this_move', 'by themselves'],
  ['any_move', 'cut out'],
];

/** @param {HTMLElement} root @param {import('../../app/state.js').Dispatch} dispatch
 * @param {{openFlight: () => void} & import('./motor_found.js').Looks} act */
export function createParameters(root, dispatch, { openFlight, ...looks }) {
  /** @type {import('./number.js').Handlers & Parameters<typeof createMethod>[0] & Parameters<typeof createShape>[0]} */
  const handlers = {
    onEdit: (path, value, gesture) => dispatch(setValue, path, value, gesture, performance.now()),
    onSlid: () => dispatch(endGesture),
    onMethod: (name) => dispatch(setMethod, name),
    onShape: (name) => dispatch(setShape, name),
  };
  /** @type {Parameters<typeof createPresetPicker>[2]} */
  const onPreset = (part, preset) => {
    dispatch(setPreset, part, preset);
    dispatch(tell, `${preset.name}: set`, false);
  };
  const info = createInfo(WELCOME);
  const choice = createUnitsChoice((units) => dispatch(setUnits, units), info);
  const numbers = GROUPS.flatMap((group) => group.fields).map((field) => createNumber(field, handlers));
  const method = createMethod(handlers, info);
  const shape = createShape(handlers, info);
  const ofMotor = numbers.filter(({ field }) => GROUPS.some(({ title, fields }) => title === MOTOR && fields.includes(field)));
  const motor = createMotor(dispatch, handlers, info, ofMotor, looks);
  const plan = createChoice('move.plan', PLANS, (_, value) => dispatch(setPlan, String(value)));
  info.explain(plan.element, () => plan.explanation, plan.name);
  const pickers = [
    createPresetPicker('axis', 'Axis', onPreset, info),
    createPresetPicker('timer', 'Timer', onPreset, info),
  ];
  const inFlight = element('button', {
    className: 'button quiet small',
    id: 'open-flight',
    type: 'button',
    title: 'What the motor does when its target or speed changes while it moves. Computed only; no device moves.',
    textContent: 'In flight',
    onclick: openFlight,
  });
  const groups = GROUPS.map((group, index) =>
    element(
      'section',
      { className: 'group', 'aria-label': group.title },
      pickers[index]?.element ??
        /** @type {Record<string, HTMLElement>} */ ({ Ramp: shape.head, [MOTOR]: motor.head })[group.title] ??
        element('div', { className: 'group-head' }, element('h2', { textContent: group.title }), group.title === 'Move' && inFlight),
      group.title === 'Ramp' && shape.nameBox,
      ...(group.title === MOTOR ? [motor.body] : numbers.filter((number) => group.fields.includes(number.field)).map((number) => number.element)),
      group.title === 'Ramp' && shape.points,
      group.title === 'Move' && plan.element,
    ),
  );
  root.replaceChildren(
    choice.element,
    element('div', { className: 'groups' }, ...groups, method.element),
    info.element,
  );
  for (const { element: row, field, label } of numbers) info.explain(row, () => field, label);

  /** @param {Design | null} design @param {Units} units */
  function show(design, units) {
    if (design === null) return;
    choice.show(units, design);
    for (const number of numbers) {
      number.element.hidden = !hasField(design, number.field.path);
      if (!number.element.hidden) number.show(design, units);
    }
    shape.show(design, units);
    motor.show(design);
    plan.show(design);
    plan.element.hidden = shapeOf(design).begins_alike;
    for (const picker of pickers) picker.show(design);
    method.show(design);
  }

  /** @param {import('../../app/state.js').State} state */
  function showMessages(state) {
    const { fields } = messagesOf(state);
    for (const number of numbers) number.showMessage(fields);
    method.showMessage(fields);
    shape.showMessage(fields);
    motor.showMessage(fields, designOf(state));
    plan.showMessage(fields);
  }

  /** @param {import('../../model/types.js').Answer | null} curves @param {Units} units */
  function showOtherLengths(curves, units) {
    plan.showNote(curves === null ? '' : shortMovesText(curves.design, activeProfile(curves).summary, units));
  }

  const shows = [
    whenChanged((state) => [designOf(state), state.units], show),
    whenChanged((state) => [shownCurvesOf(state), state.units], showOtherLengths),
    whenChanged((state) => [motorOf(state), state.units, designOf(state), axisOf(state)], motor.showFound),
    // They are told in the units and with the values that are shown.
    whenever((state) => [messagesOf(state), designOf(state), state.units], showMessages),
  ];

  return {
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      for (const part of shows) part(state);
    },
  };
}
