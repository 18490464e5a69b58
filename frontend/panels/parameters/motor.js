// @ts-check
// The motor of the design: which it is, what drives it and what it moves; then its own numbers, and what was measured of it.

import { setMeasured, setMechanism, setMotor } from '../../app/commands/work.js';
import { valueAt } from '../../model/design.js';
import { CHOICES } from '../../model/fields.js';
import { MECHANISMS } from '../../model/mechanisms.js';
import { isOpen, MOTOR_SECTIONS } from '../../model/motor_fields.js';
import { originsOf } from '../../model/motor_origins.js';
import { measuredText, motorText } from '../../model/motor_words.js';
import { MOTORS, motorPresetOf } from '../../model/motors.js';
import { hasField } from '../../model/shapes.js';
import { element, picker, showMessage, showText } from '../../ui/dom.js';
import { createChoice } from './choice.js';
import { createMotorFound } from './motor_found.js';
import { createStallPoint } from './stall_point.js';
import { createTorqueCurve } from './torque_curve.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/units.js').Units} Units */
/** @typedef {ReturnType<typeof import('./number.js').createNumber>} NumberRow */

const NONE = '';
const OWN = 'own';
const MECHANISM = 'load.mechanism';
const GENERAL = {
  label: 'Motor',
  formula: '',
  help: 'Whether the motor makes the move: its move is played, tick by tick, through a model of motor and driver. Optional.',
};

/** @param {import('../../app/state.js').Dispatch} dispatch @param {import('./number.js').Handlers} handlers
 * @param {ReturnType<typeof import('./info.js').createInfo>} info @param {NumberRow[]} numbers of the group
 * @param {import('./motor_found.js').Looks} looks */
export function createMotor(dispatch, { onEdit }, info, numbers, looks) {
  const list = picker('Motor', choose);
  list.element.classList.add('quiet');
  list.select.id = 'motor-presets';
  const heading = element('h2', { textContent: 'Motor' });
  const head = element('div', { className: 'group-head' }, heading, list.element);
  const currentIs = createChoice('drive.current_is', [['rms', 'RMS'], ['peak', 'peak']], onEdit, NONE); // prettier-ignore
  const kind = createChoice('motor.kind', [['hybrid', 'hybrid'], ['gauge', 'gauge']], onEdit); // prettier-ignore
  const mechanism = picker(CHOICES[MECHANISM].label, (name) => dispatch(setMechanism, name));
  mechanism.select.id = 'mechanism';
  const mechanismName = element('span', { textContent: CHOICES[MECHANISM].label });
  const mechanismBox = element('div', { className: 'messages' });
  const movedBy = element('div', { className: 'choice' }, mechanismName, mechanism.element, mechanismBox);
  const thenIs = createChoice('motor.measured_with.current_is', [['rms', 'RMS'], ['peak', 'peak']], onEdit, NONE); // prettier-ignore
  /** @type {import('./stall_point.js').OnMeasured} */
  const onMeasured = (...changed) => dispatch(setMeasured, ...changed);
  const curve = createTorqueCurve(onMeasured);
  const found = createMotorFound(dispatch, looks);
  const origins = element('dl', { className: 'motor-origins', id: 'motor-origins', hidden: true });
  const data = section('Its own numbers', 'motor-data', ...rowsOf('data'), kind.element);
  const [rpm, torque, supply, current, factor] = rowsOf('measured');
  const stall = createStallPoint(onMeasured, rpm);
  const measured = section('Measured', 'motor-measured', rpm, torque, stall.element, factor, curve.element, supply, current, thenIs.element);
  const body = element(
    'div',
    { className: 'motor-body', hidden: true },
    found.element,
    ...rowsOf('drive'),
    currentIs.element,
    movedBy,
    ...rowsOf('load'),
    data.element,
    measured.element,
    origins,
  );
  info.explain(head, () => MOTORS.map((one) => ({ ...one, label: one.name, formula: '' })).find(({ name }) => name === list.select.value) ?? GENERAL, heading);
  for (const choice of [currentIs, thenIs, kind]) info.explain(choice.element, () => choice.explanation, choice.name);
  info.explain(movedBy, () => CHOICES[MECHANISM], mechanismName);
  info.explain(curve.element, () => CHOICES['motor.torque_curve'], curve.name);

  /** The parts of the design that are shown; null: none yet.
   * @type {unknown[]} */
  let shown = [null];

  /** @param {keyof typeof MOTOR_SECTIONS} name */
  function rowsOf(name) {
    const paths = MOTOR_SECTIONS[name].map(({ path }) => path);
    return numbers.filter(({ field }) => paths.includes(field.path)).map((row) => row.element);
  }

  /** @param {string} name */
  function choose(name) {
    const preset = MOTORS.find((one) => one.name === name);
    if (preset) dispatch(setMotor, preset);
    else if (name === NONE) dispatch(setMotor, null);
  }

  /** @param {Design} design */
  function showNumbers(design) {
    currentIs.show(design);
    currentIs.element.hidden = isOpen(valueAt(design, 'drive.current_a'));
    thenIs.show(design);
    thenIs.element.hidden = isOpen(valueAt(design, 'motor.measured_with.current_a'));
    kind.show(design);
    mechanism.offer(
      [[NONE, 'the shaft itself'], ...MECHANISMS.map(({ name, label }) => /** @type {[string, string]} */ ([name, label]))],
      design.load?.mechanism?.name ?? NONE,
    );
    stall.show(design);
    curve.show(design);
    data.tell(motorText(design));
    measured.tell(measuredText(design));
  }

  /** @type {typeof found.show} */
  function showFound(known, units, design, axis) {
    found.show(known, units, design, axis);
    const answer = known?.answer ?? null;
    // Of a design that is refused nothing new is known.
    origins.hidden = known === null || (answer === null && origins.childElementCount === 0);
    if (answer === null) return;
    const lines = originsOf(answer.origins).flatMap(({ word, text }) => [element('dt', { textContent: word }), element('dd', { textContent: text })]);
    if (origins.textContent !== lines.map(({ textContent }) => textContent).join('')) origins.replaceChildren(...lines);
  }

  return {
    head,
    body,
    /** @param {Design} design */
    show(design) {
      const parts = [design.motor, design.drive, design.load];
      // A slider of the ramp changes nothing here, many times a second.
      if (parts.every((part, index) => part === shown[index])) return;
      shown = parts;
      const isThere = design.motor !== undefined;
      const chosen = isThere ? (motorPresetOf(design)?.name ?? OWN) : NONE;
      const names = MOTORS.map(({ name }) => /** @type {[string, string]} */ ([name, name]));
      list.offer([[NONE, 'none'], ...names, ...(chosen === OWN ? [/** @type {[string, string]} */ ([OWN, 'Own values'])] : [])], chosen);
      body.hidden = !isThere;
      if (isThere) showNumbers(design);
    },
    showFound,
    /** @param {import('../../model/messages.js').Messages['fields']} messages @param {Design | null} design */
    showMessage(messages, design) {
      currentIs.showMessage(messages);
      thenIs.showMessage(messages);
      kind.showMessage(messages);
      curve.showMessage(messages);
      stall.showMessage(messages);
      showMessage(mechanism.select, mechanismBox, messages.get(MECHANISM) ?? messages.get(`${MECHANISM}.name`));
      // What is wrong, or doesn't fit together, is seen.
      const wrong = [...messages.keys()].filter((path) => design !== null && hasField(design, path));
      if (wrong.some((path) => MOTOR_SECTIONS.measured.some((field) => field.path === path) || path === 'motor.torque_curve' || path.startsWith('motor.measured_with.'))) measured.open();
      if (wrong.some((path) => MOTOR_SECTIONS.data.some((field) => field.path === path))) data.open();
    },
  };
}

/** A part that is rarely looked at, with what is in it in a line.
 * @param {string} title @param {string} id @param {...HTMLElement} content */
function section(title, id, ...content) {
  const told = element('span', { className: 'muted' });
  const details = element('details', { className: 'motor-section', id }, element('summary', {}, title, told), ...content);
  return {
    element: details,
    tell: (/** @type {string} */ text) => showText(told, text),
    open() {
      details.open = true;
    },
  };
}
