// @ts-check
// The legend: one switch a method, with its largest error.

import { element } from '../../dom.js';
import { METHODS, REFERENCE } from '../../methods.js';
import { formatSignedPercent } from '../../numbers.js';
import { methodSwatch } from '../../swatch.js';

/** @typedef {import('../../types.js').Answer} Answer */
/** @typedef {import('../../types.js').MethodName} MethodName */

/** @param {(name: MethodName) => void} onSwitch */
export function createLegend(onSwitch) {
  const chips = METHODS.map(({ name, label, plays_table: playsTable }) => {
    const figure = element('em');
    const chip = element(
      'button',
      { className: 'chip', type: 'button', 'data-method': name, onclick: () => onSwitch(name) },
      methodSwatch(name),
      element('span', { textContent: label }),
      figure,
    );
    return { name, label, playsTable, chip, figure };
  });
  return {
    element: element(
      'div',
      { className: 'legend', role: 'group', 'aria-label': 'Methods shown' },
      ...chips.map(({ chip }) => chip),
    ),
    /** @param {Answer | null} answer @param {ReadonlySet<MethodName>} shown @param {MethodName} active */
    show(answer, shown, active) {
      for (const { name, label, playsTable, chip, figure } of chips) {
        const largest = answer?.errors[name]?.largest_relative_error;
        const failure = answer?.failures[name];
        const isEmpty = answer !== null && playsTable && answer.design.table === null;
        chip.setAttribute('aria-pressed', String(shown.has(name)));
        chip.dataset.active = String(name === active);
        const text =
          name === REFERENCE
            ? 'reference'
            : isEmpty
              ? 'no rows'
              : failure
                ? 'fails'
                : largest
                  ? `${formatSignedPercent(largest.value)} %`
                  : '';
        const title =
          failure ??
          `${shown.has(name) ? 'Hide' : 'Show'} ${label}${largest ? `; largest error at step ${largest.step}` : ''}`;
        // While a slider moves this comes many times a second: what stays the same is left alone.
        if (figure.textContent !== text) figure.textContent = text;
        if (chip.title !== title) chip.title = title;
      }
    },
  };
}
