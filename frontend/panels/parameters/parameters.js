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
  const method = createMethod(handlers, info.show);
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
 * The choice of the method and its arithmetic.
 * @param {{onEdit: (path: string, value: unknown) => void, onMethod: (name: MethodName) => void}} handlers
 * @param {(label: string, formula: string, help: string) => void} showInfo
 */
function createMethod({ onEdit, onMethod }, showInfo) {
  const name = picker('Method', (value) => onMethod(/** @type {MethodName} */ (value)));
  name.element.classList.add('quiet');
  name.select.id = 'method';
  const arithmetics = [...new Set(METHODS.flatMap((method) => method.arithmetic))].sort().reverse();
  const arithmetic = segmented(
    'Arithmetic',
    arithmetics.map((one) => [one, one]),
    (value) => onEdit('method.arithmetic', value),
  );
  arithmetic.element.classList.add('fill');
  const [nameBox, arithmeticBox] = [element('div'), element('div', { className: 'messages' })];
  arithmetic.element.id = 'arithmetic';
  const rows = {
    arithmetic: element(
      'div',
      { className: 'choice' },
      element('span', { textContent: 'Arithmetic' }),
      arithmetic.element,
      arithmeticBox,
    ),
    rounding: element(
      'div',
      { className: 'choice' },
      element('span', { textContent: 'Rounding' }),
      element('span', { className: 'value', textContent: 'to the nearest tick' }),
    ),
  };
  const head = element('div', { className: 'group-head' }, element('h2', { textContent: 'Method' }), name.element);
  for (const [part, path] of /** @type {[HTMLElement, string][]} */ ([
    [rows.arithmetic, 'method.arithmetic'],
    [rows.rounding, 'method.rounding'],
  ])) {
    const { label, formula, help } = CHOICES[path];
    for (const event of ['pointerenter', 'focusin']) part.addEventListener(event, () => showInfo(label, formula, help));
  }
  for (const event of ['pointerenter', 'focusin']) {
    head.addEventListener(event, () => {
      const { label, formula, help } = methodOf(/** @type {MethodName} */ (name.select.value));
      showInfo(label, formula, help);
    });
  }

  return {
    element: element(
      'section',
      { className: 'group', 'aria-label': 'Method' },
      head,
      nameBox,
      rows.arithmetic,
      rows.rounding,
    ),
    /** @param {Design} design */
    show(design) {
      name.offer(
        METHODS.map((method) => [method.name, method.label]),
        design.method.name,
      );
      const offered = methodOf(design.method.name).arithmetic;
      for (const button of arithmetic.element.querySelectorAll('button'))
        button.hidden = !offered.includes(button.dataset.value ?? '');
      arithmetic.press(valueAt(design, 'method.arithmetic'));
    },
    /** @param {Messages['fields']} messages */
    showMessage(messages) {
      showMessage(name.select, nameBox, messages.get('method.name'));
      showMessage(arithmetic.element, arithmeticBox, messages.get('method.arithmetic'));
    },
  };
}
