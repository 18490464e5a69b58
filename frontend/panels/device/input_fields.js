// @ts-check
// What each input of the controller is for, as fields: one line an input, and one more for what is to be known of it.

import { refusalText } from '../../model/messages.js';
import { element, icon, messageLine } from '../../ui/dom.js';

/** @typedef {import('../../model/types.js').InputRole} InputRole */
/** @typedef {import('../../model/types.js').Rejection} Rejection */

/** As the board names them, in its order. */
export const INPUTS = ['A0', 'A1', 'A2', 'A3', 'A4', 'A5', 'D9', 'D10', 'D11'];
/** Only their edges interrupt what the controller does. */
export const EMERGENCY_INPUTS = INPUTS.slice(0, 6);
const MOST_AXES = 4;
const WRONG_LEVEL =
  'An input with the wrong level is active all along: an emergency stop or a driver’s fault then stops the machine at once, and a ' +
  'limit switch lets an axis go one way only. Look under Inputs whether the right ones are active before you keep this.';

/** All inputs with their roles. */
export function createInputFields() {
  /** The inputs last asked for, in the order that a refusal counts them.
   * @type {string[]} */
  let asked = [];
  const rows = INPUTS.map(createRow);
  const rolesNow = () => rows.flatMap((row) => row.value() ?? []);

  return {
    element: element(
      'fieldset',
      { className: 'input-roles' },
      element('legend', { textContent: 'Inputs' }),
      messageLine({ text: WRONG_LEVEL, isWarning: true }),
      ...rows.map((row) => row.element),
    ),
    value() {
      const roles = rolesNow();
      asked = roles.map(({ input }) => input);
      return roles;
    },
    /** @param {InputRole[]} roles */
    show(roles) {
      rows.forEach((row, at) => row.show(roles.find(({ input }) => input === INPUTS[at]) ?? null));
    },
    /** Where each refusal belongs. */
    places: () => rows.map((row) => row.place(asked.indexOf(row.input))),
  };
}

/** @param {string} input */
function createRow(input) {
  const id = (/** @type {string} */ what) => `input-${input}-${what}`;
  const isFast = EMERGENCY_INPUTS.includes(input);
  const role = choice(id('role'), `What ${input} is for`, [
    ['', 'Nothing'],
    ...(isFast ? [/** @type {[string, string]} */ (['emergency_stop', 'Emergency stop'])] : []),
    ['driver_fault', 'Driver’s fault'],
    ['limit', 'Limit switch'],
  ]);
  const active = choice(id('active'), `Level at which ${input} is active`, [
    ['low', 'Active when low'],
    ['high', 'Active when high'],
  ]);
  const axes = Array.from({ length: MOST_AXES }, (_, axis) => /** @type {[string, string]} */ ([String(axis), `Axis ${axis}`]));
  const axis = choice(id('axis'), `Axis of the switch at ${input}`, axes);
  const end = choice(id('end'), `End of the axis of the switch at ${input}`, [
    ['low', 'Low end'],
    ['high', 'High end'],
  ]);
  const stops = choice(id('stops'), `How the switch at ${input} stops the axis`, [
    ['ramp', 'Stops with the ramp'],
    ['at_once', 'Stops at once'],
  ]);
  const pullUp = element('input', { type: 'checkbox', id: id('pull-up'), 'aria-label': `${input}: pull-up of the controller on` });
  const ofLimit = [axis, end, stops].map((one) => one.element);
  const details = element(
    'div',
    { className: 'input-details' },
    ...ofLimit,
    active.element,
    element('label', { className: 'line check' }, pullUp, 'Pull-up'),
  );
  const problem = element('div', { className: 'problem' });

  function follow() {
    details.hidden = role.select.value === '';
    for (const one of ofLimit) one.hidden = role.select.value !== 'limit';
  }
  role.select.onchange = follow;

  return {
    input,
    element: element(
      'div',
      { className: 'input-role', role: 'group', 'aria-label': `Input ${input}` },
      element('label', { htmlFor: id('role'), textContent: input }),
      role.element,
      details,
      problem,
    ),
    /** @returns {InputRole | null} null: it is for nothing */
    value() {
      if (role.select.value === '') return null;
      const isLimit = role.select.value === 'limit';
      return /** @type {InputRole} */ ({
        input,
        role: role.select.value,
        active: active.select.value,
        pull_up: pullUp.checked,
        axis: isLimit ? Number(axis.select.value) : null,
        end: isLimit ? end.select.value : null,
        stops: isLimit ? stops.select.value : null,
      });
    },
    /** @param {InputRole | null} known */
    show(known) {
      role.select.value = known?.role ?? '';
      active.select.value = known?.active ?? 'low';
      pullUp.checked = known?.pull_up ?? true;
      axis.select.value = String(known?.axis ?? 0);
      end.select.value = known?.end ?? 'low';
      stops.select.value = known?.stops ?? 'ramp';
      follow();
    },
    /** @param {number} at its place in what was asked for; -1: it was none of that
     * @returns {import('../../ui/refusal.js').Place} */
    place: (at) => ({
      path: new RegExp(`^inputs\\.${at}(\\.|$)`),
      input: role.select,
      problem,
      text: (one) => refusalText(one, input),
    }),
  };
}

/** @param {string} id @param {string} label @param {[string, string][]} choices */
function choice(id, label, choices) {
  const select = element(
    'select',
    { id, 'aria-label': label },
    ...choices.map(([value, textContent]) => element('option', { value, textContent })),
  );
  return { select, element: element('span', { className: 'picker' }, select, icon('down')) };
}
