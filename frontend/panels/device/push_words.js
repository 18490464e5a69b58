// @ts-check
// What a push is called: by the designs and by the methods that their ramps are computed with.

import { methodOf } from '../../model/methods.js';
import { sentencesInUnits } from '../../model/told.js';

/** @typedef {import('../../model/types.js').Design} Design */

/** From when on a wait is explained. */
const LONG_MS = 2_000;

/** Such as "\u2018Gauge\u2019" and "by table"; of several their number, and each method once.
 * @param {Design[]} designs @returns {[string, string]} */
export function pushedParts(designs) {
  const methods = [...new Set(designs.map(({ method }) => wordOf(methodOf(method.name))))].join(', ');
  const what = designs.length === 1 ? `\u2018${designs[0].name || 'unnamed'}\u2019` : `${designs.length} ramps`;
  return [what, `by ${methods}`];
}

/** What works, but not as the designs say, in the units that are shown.
 * @param {Pick<import('../../model/types.js').Preview, 'warnings' | 'warnings_told'>} told of a push or its preview
 * @param {import('../../model/units.js').Units} units @param {Design[]} designs that are pushed @returns {string[]} */
export const warningsOf = ({ warnings, warnings_told }, units, designs) => sentencesInUnits(units, designs, warnings, warnings_told);

/** The same in one.
 * @param {Design[]} designs */
export const pushedWords = (designs) => pushedParts(designs).join(' ');

/** @param {import('../../model/types.js').RampMethod} method */
const wordOf = (method) => (method.plays_table ? 'table' : method.label);

/** Tells whether something has gone on for long, and when it begins to.
 * @param {number} [longMs] */
export function ratherLong(longMs = LONG_MS) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  let isLong = false;

  function end() {
    clearTimeout(timer);
    [timer, isLong] = [undefined, false];
  }

  return {
    end,
    /** @param {boolean} goesOn @param {() => void} onLong */
    isSo(goesOn, onLong) {
      if (!goesOn) end();
      else if (timer === undefined) {
        timer = setTimeout(() => {
          isLong = true;
          onLong();
        }, longMs);
      }
      return isLong;
    },
  };
}
