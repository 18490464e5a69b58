// @ts-check
// The choice of the method, its arithmetic, how its delays become ticks, and what it is tuned for.

import { element, picker, showMessage } from '../../ui/dom.js';
import { METHODS, methodOf } from '../../model/methods.js';
import { createChoice } from './choice.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').MethodName} MethodName */

/** @param {string[]} words @returns {[string, string][]} */
const asTheyAre = (words) => words.map((word) => [word, word]);

/**
 * @param {{onEdit: (path: string, value: unknown) => void, onMethod: (name: MethodName) => void}} handlers
 * @param {ReturnType<typeof import('./info.js').createInfo>} info
 */
export function createMethod({ onEdit, onMethod }, info) {
  const name = picker('Method', (value) => onMethod(/** @type {MethodName} */ (value)));
  name.element.classList.add('quiet');
  name.select.id = 'method';
  const nameBox = element('div');
  const arithmetics = [...new Set(METHODS.flatMap((method) => method.arithmetics))].sort().reverse();
  const arithmetic = createChoice('method.arithmetic', asTheyAre(arithmetics), onEdit);
  const rounding = createChoice('method.rounding', asTheyAre(['nearest', 'floor', 'carry']), onEdit);
  /** @type {[string, string][]} */
  const aims = [
    ['largest_error', 'largest error'],
    ['time', 'time'],
  ];
  const tunedFor = createChoice('method.tuned_for', aims, onEdit);
  const choices = [arithmetic, rounding, tunedFor];
  const title = element('h2', { textContent: 'Method' });
  const head = element('div', { className: 'group-head' }, title, name.element);
  info.explain(head, () => methodOf(/** @type {MethodName} */ (name.select.value)), title);
  for (const choice of choices) info.explain(choice.element, () => choice.explanation, choice.name);

  return {
    element: element(
      'section',
      { className: 'group', 'aria-label': 'Method' },
      head,
      nameBox,
      ...choices.map((choice) => choice.element),
    ),
    /** @param {Design} design */
    show(design) {
      const method = methodOf(design.method.name);
      name.offer(
        METHODS.map(({ name, label }) => [name, label]),
        design.method.name,
      );
      arithmetic.show(design, method.arithmetics);
      rounding.show(design);
      tunedFor.show(design);
      tunedFor.element.hidden = !method.is_tuned;
    },
    /** @param {import('../../model/messages.js').Messages['fields']} messages */
    showMessage(messages) {
      showMessage(name.select, nameBox, messages.get('method.name'));
      for (const choice of choices) choice.showMessage(messages);
    },
  };
}
