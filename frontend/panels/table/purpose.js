// @ts-check
// What the rows of a dialog are for: the axis that it was opened for, whichever is in hand when they are used, and whether
// they become its method.

import { quoted } from '../../model/quoted.js';
import { element } from '../../ui/dom.js';
import { methodOf } from '../../model/methods.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {{axis: number, asMethod: boolean}} Purpose */

/** @param {string} id */
export function createPurpose(id) {
  /** @type {{axis: number, design: Design} | null} */
  let opened = null;
  const check = element('input', { type: 'checkbox', id: `${id}-as-method` });
  const offer = element(
    'label',
    { className: 'as-method', htmlFor: check.id },
    check,
    'Use this table as the method: it is then what is pushed and exported',
  );
  const elsewhere = element('p', { className: 'muted fit-about', role: 'status', hidden: true });

  return {
    element: element('div', { className: 'purpose' }, offer, elsewhere),
    /** @param {Design} design @param {number} axis */
    open(design, axis) {
      opened = { axis, design };
      elsewhere.hidden = true;
      // What is the method already needs no choice.
      offer.hidden = methodOf(design.method.name).plays_table;
      check.checked = true;
    },
    /** Say it when another axis is in hand than the one that the rows go to.
     * @param {number} axis in hand */
    show(axis) {
      elsewhere.hidden = opened === null || opened.axis === axis;
      elsewhere.textContent = `The rows go to ${quoted(opened?.design.name || 'unnamed')}, the axis that this was opened for, not to the one in hand.`;
    },
    /** The id of the axis that it was opened for. */
    axis: () => opened?.axis ?? -1,
    /** @returns {Purpose | null} null: it was never opened */
    purpose: () => opened && { axis: opened.axis, asMethod: !offer.hidden && check.checked },
  };
}
