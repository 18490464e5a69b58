// @ts-check
// The parameters of the design: a number and a slider each, the method, and the explanation of the field in focus.

import { valueAt } from '../../design.js';
import { element, picker, segmented, showMessage } from '../../dom.js';
import { CHOICES, GROUPS } from '../../fields.js';
import { METHODS, methodOf } from '../../methods.js';
import { createNumber } from './number.js';

/** @typedef {import('../../types.js').Design} Design */
/** @typedef {import('../../types.js').MethodName} MethodName */
/** @typedef {import('../../messages.js').Messages} Messages */

/**
 * @param {HTMLElement} root
 * @param {object} handlers
 * @param {(path: string, value: unknown) => void} handlers.onEdit
 * @param {(name: MethodName) => void} handlers.onMethod
 * @param {(isMoving: boolean) => void} handlers.onSliding
 */
export function createParameters(root, handlers) {
  const info = createInfo();
  const numbers = GROUPS.flatMap((group) => group.fields).map((field) => createNumber(field, handlers));
  const method = createMethod(handlers, info);
  const groups = GROUPS.map((group) =>
    element(
      'section',
      { className: 'group', 'aria-label': group.title },
      element('div', { className: 'group-head' }, element('h2', { textContent: group.title })),
      ...numbers.filter((number) => group.fields.includes(number.field)).map((number) => number.element),
    ),
  );
  root.replaceChildren(element('div', { className: 'groups' }, ...groups, method.element), info.element);
  for (const { element: row, field } of numbers)
    info.explain(row, () => info.show(field.label, field.formula, field.help));
  info.show('Parameters', '', 'Point at a parameter to read what it is and what it does to the ramp.');

  return {
    /** @param {Design} design */
    show(design) {
      for (const number of numbers) number.show(design);
      method.show(design);
    },
    /** @param {Messages} messages */
    showMessages({ fields }) {
      for (const number of numbers) number.showMessage(fields);
      method.showMessage(fields);
    },
  };
}

/** The box under the parameters that explains what is pointed at or in focus. */
function createInfo() {
  const box = element('div', { className: 'info', id: 'parameter-info' });
  return {
    element: box,
    /** @param {string} label @param {string} formula @param {string} help */
    show(label, formula, help) {
      const numbers =
        formula === ''
          ? ''
          : `formula${formula.includes(',') ? 's' : ''} ${formula
              .split(', ')
              .map((number) => `(${number})`)
              .join(' ')}`;
      box.replaceChildren(element('b', {}, label, element('span', { textContent: numbers })), help);
    },
    /** @param {HTMLElement} part @param {() => void} show */
    explain(part, show) {
      part.addEventListener('pointerenter', show);
      part.addEventListener('focusin', show);
    },
  };
}

/**
 * The choice of the method, its arithmetic and how its delays become ticks.
 * @param {{onEdit: (path: string, value: unknown) => void, onMethod: (name: MethodName) => void}} handlers
 * @param {ReturnType<typeof createInfo>} info
 */
function createMethod({ onEdit, onMethod }, info) {
  const name = picker('Method', (value) => onMethod(/** @type {MethodName} */ (value)));
  name.element.classList.add('quiet');
  name.select.id = 'method';
  const nameBox = element('div');
  const arithmetics = [...new Set(METHODS.flatMap((method) => method.arithmetic))].sort().reverse();
  const arithmetic = createChoice('method.arithmetic', arithmetics, onEdit);
  const rounding = createChoice('method.rounding', ['nearest', 'floor', 'carry'], onEdit);
  const head = element('div', { className: 'group-head' }, element('h2', { textContent: 'Method' }), name.element);
  info.explain(head, () => {
    const { label, formula, help } = methodOf(/** @type {MethodName} */ (name.select.value));
    info.show(label, formula, help);
  });
  for (const { path, element: row } of [arithmetic, rounding])
    info.explain(row, () => info.show(CHOICES[path].label, CHOICES[path].formula, CHOICES[path].help));

  return {
    element: element(
      'section',
      { className: 'group', 'aria-label': 'Method' },
      head,
      nameBox,
      arithmetic.element,
      rounding.element,
    ),
    /** @param {Design} design */
    show(design) {
      name.offer(
        METHODS.map((method) => [method.name, method.label]),
        design.method.name,
      );
      arithmetic.show(design, methodOf(design.method.name).arithmetic);
      rounding.show(design);
    },
    /** @param {Messages['fields']} messages */
    showMessage(messages) {
      showMessage(name.select, nameBox, messages.get('method.name'));
      arithmetic.showMessage(messages);
      rounding.showMessage(messages);
    },
  };
}

/**
 * One choice of a few, with its message beneath.
 * @param {string} path where it stands in the design
 * @param {string[]} values
 * @param {(path: string, value: unknown) => void} onEdit
 */
function createChoice(path, values, onEdit) {
  const { label } = CHOICES[path];
  const control = segmented(
    label,
    values.map((value) => [value, value]),
    (value) => onEdit(path, value),
  );
  control.element.classList.add('fill');
  control.element.id = label.toLowerCase();
  const box = element('div', { className: 'messages' });
  return {
    path,
    element: element('div', { className: 'choice' }, element('span', { textContent: label }), control.element, box),
    /** @param {Design} design @param {string[]} [offered] */
    show(design, offered = values) {
      for (const button of control.element.querySelectorAll('button'))
        button.hidden = !offered.includes(button.dataset.value ?? '');
      control.press(valueAt(design, path));
    },
    /** @param {Messages['fields']} messages */
    showMessage: (messages) => showMessage(control.element, box, messages.get(path)),
  };
}
