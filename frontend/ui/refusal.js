// @ts-check
// What the server refuses, at the field that it is about, in the page's words and the unit that is shown.

import { limitsInUnit } from '../model/limits_text.js';
import { refusalText } from '../model/messages.js';
import { formatEntry } from '../model/numbers.js';
import { inShownUnits } from '../model/told.js';
import { shownValue, unitWord } from '../model/units.js';
import { showMessage } from './dom.js';

/** @typedef {import('../model/types.js').Design} Design */
/** @typedef {import('../model/types.js').Rejection} Rejection */
/** @typedef {import('../model/units.js').Quantity} Quantity */
/** @typedef {import('../model/units.js').Units} Units */

/** A field, and which rejections are about it.
 * @typedef {object} Place
 * @property {RegExp} path
 * @property {HTMLInputElement | HTMLSelectElement} input
 * @property {HTMLElement} problem
 * @property {(rejection: Rejection) => string} text */

/** What the server's numbers are in. */
const SERVER_UNITS = { length: 'steps', speed: 'steps/s' };
const MOST_FIGURES = 7;

/** What each field shows.
 * @type {WeakMap<EventTarget, Rejection>} */
const rejectionsAt = new WeakMap();

/** What a field that is typed in was refused for: that was said of what stood there before.
 * @param {EventTarget | null} input @param {Rejection[]} rejections @returns {Rejection[]} the others; the same list
 *   when none is of that field */
export function withoutThatOf(input, rejections) {
  const settled = input && rejectionsAt.get(input);
  return settled && rejections.includes(settled) ? rejections.filter((one) => one !== settled) : rejections;
}

/** Show rejections at their fields, and nothing at the others.
 * @param {Rejection[]} rejections @param {Place[]} places @returns {Rejection[]} those of no field here */
export function showAtPlaces(rejections, places) {
  const shown = places.map(({ path, input, problem, text }) => {
    const found = rejections.find(({ field }) => path.test(field ?? ''));
    showMessage(input, problem, found && { text: text(found), isWarning: false });
    if (found) rejectionsAt.set(input, found);
    else rejectionsAt.delete(input);
    return found;
  });
  return rejections.filter((one) => !shown.includes(one));
}

/** The sentence in the unit that is shown, and the limits too, as far as they are numbers in the server's unit. What it
 * says in words says its units itself.
 * @param {Rejection} rejection @param {string} label @param {'length' | 'speed'} quantity of the field
 * @param {Units} units @param {Design} design */
export function inShownUnit(rejection, label, quantity, units, design) {
  const { value, limits, unit } = rejection;
  const factor = shownValue(units, design, quantity, 1);
  if (factor === 1) return refusalText(rejection, label);
  // It is one field's: whichever number its axis has in the request, this is its design.
  const told = inShownUnits(units, [design])({ ...rejection, field: null, limits: undefined });
  const word = unitWord(units, design, quantity);
  const given =
    typeof value === 'number'
      ? `${formatEntry(Number((value * factor).toPrecision(MOST_FIGURES)))} ${word} (${formatEntry(value)} ${SERVER_UNITS[quantity]})`
      : undefined;
  const allowed = limits && unit === SERVER_UNITS[quantity] ? limitsInUnit(limits, word, factor, value) : undefined;
  return refusalText(told, label, { given, allowed });
}
