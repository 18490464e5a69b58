// @ts-check
// Why a push is refused, and what would be accepted instead, each as a button that does it.

import { remedyWords } from '../../model/told.js';
import { element, messageLine } from '../../ui/dom.js';

/** @typedef {import('../../model/types.js').PushRefusal} PushRefusal */
/** @typedef {import('../../model/types.js').Remedy} Remedy */
/** @typedef {import('../../model/units.js').Units} Units */

/** @param {(axis: number, remedy: Remedy) => void} onMend */
export function createRefusals(onMend) {
  const box = element('div', { className: 'problem', id: 'push-problem' });
  /** @type {PushRefusal[]} */
  let known = [];
  /** What the buttons said it in.
   * @type {Units | null} */
  let knownUnits = null;

  /** @param {PushRefusal} refusal @param {string} where @param {(remedy: Remedy) => string} wordsOf */
  function lines({ text, axis, remedies }, where, wordsOf) {
    const buttons = remedies.map((remedy) =>
      element('button', {
        className: 'button small',
        type: 'button',
        textContent: wordsOf(remedy),
        'aria-label': `${wordsOf(remedy)}${where}`,
        onclick: () => axis !== null && onMend(axis, remedy),
      }),
    );
    const line = messageLine({ text, isWarning: false });
    return buttons.length === 0 || axis === null ? [line] : [line, element('div', { className: 'remedies' }, ...buttons)];
  }

  return {
    element: box,
    /** @param {import('../../model/types.js').Situation} situation */
    show({ refusals, toPush, designs, ids, units }) {
      if (refusals === known && units === knownUnits) return;
      [known, knownUnits] = [refusals, units];
      const axes = [...new Set(refusals.map(({ axis }) => axis))];
      const where = (/** @type {number | null} */ axis) => (toPush.length > 1 && axes.length > 1 ? `, refusal ${axes.indexOf(axis) + 1}` : '');
      const wordsOf = (/** @type {number | null} */ axis) => (/** @type {Remedy} */ remedy) =>
        remedyWords(units, designs[ids.indexOf(axis ?? -1)] ?? toPush[0], remedy);
      box.replaceChildren(...refusals.flatMap((refusal) => lines(refusal, where(refusal.axis), wordsOf(refusal.axis))));
    },
  };
}
