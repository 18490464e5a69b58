// @ts-check
// What the server refuses of a device, at the field that it is about, in the page's words and the unit that is shown.

import { showMessage } from '../../dom.js';
import { formatEntry } from '../../numbers.js';
import { shownValue, unitWord } from '../../units.js';

/** @typedef {import('../../types.js').Design} Design */
/** @typedef {import('../../types.js').Rejection} Rejection */
/** @typedef {import('../../units.js').Quantity} Quantity */
/** @typedef {import('../../units.js').Units} Units */

/** A field, and which rejections are about it.
 * @typedef {object} Place
 * @property {RegExp} path
 * @property {HTMLInputElement} input
 * @property {HTMLElement} problem
 * @property {(rejection: Rejection) => string} text */

/** An axis has a number, too, which is in no unit; others are in one that stays. */
const NUMBER = /(axis )?(at least )?(-?\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?)(?![.,]?\d| µs| %)( to )?/g;
/** Each axis has units of its own. */
const SEVERAL_AXES = /axis \d.*axis \d/;
// The figures of a converted number.
const FIGURES = 7;

/** Show rejections at their fields, and nothing at the others.
 * @param {Rejection[]} rejections @param {Place[]} places @returns {Rejection[]} those of no field here */
export function showAtPlaces(rejections, places) {
  const shown = places.map(({ path, input, problem, text }) => {
    const found = rejections.find(({ field }) => path.test(field ?? ''));
    showMessage(input, problem, found && { text: text(found), isWarning: false });
    return found;
  });
  return rejections.filter((one) => !shown.includes(one));
}

/** The server's sentence with the field called what the page calls it.
 * @param {Rejection} rejection @param {string} label */
export function named({ field, message }, label) {
  return message.startsWith(field ?? '') ? label + message.slice(field?.length ?? 0) : message;
}

/** The sentence in the unit that is shown; the server speaks of steps and seconds.
 * @param {Rejection} rejection @param {string} label @param {Quantity} quantity of the field
 * @param {Units} units @param {Design} design */
export function inShownUnit(rejection, label, quantity, units, design) {
  const { value, allowed } = rejection;
  const isText = typeof value === 'string';
  const isOfField = allowed !== null && !SEVERAL_AXES.test(allowed) && (isText || typeof value === 'number');
  if (shownValue(units, design, quantity, 1) === 1 || !isOfField) return named(rejection, label);
  const given = isText ? `'${value}'` : `${converted(value, Math.round)} ${unitWord(units, design, quantity)}`;
  return `${label} is ${given}; allowed: ${limits()}.`;

  /** @param {number} stored @param {(value: number) => number} toWhole */
  function converted(stored, toWhole, of = quantity) {
    return formatEntry(roundedTo(shownValue(units, design, of, stored), toWhole));
  }

  /** A speed may be refused because of where it leads: a sentence speaks of one unit, its own. Rounded inwards, what is
   * told is allowed. */
  function limits() {
    const told = allowed ?? '';
    const of = /steps\/s/.test(told) ? 'speed' : 'length';
    const numbers = told.replace(NUMBER, (whole, axis, atLeast, digits, to) => {
      if (axis) return whole;
      const toWhole = atLeast || to ? Math.ceil : Math.floor;
      return `${atLeast ?? ''}${converted(Number(digits.replaceAll(',', '')), toWhole, of)}${to ?? ''}`;
    });
    const word = unitWord(units, design, of);
    // Not the steps of a name, as lowest_steps.
    return numbers.replace(/\bsteps(\/s)?/, word).replace('a whole number', 'whole steps');
  }
}

/** @param {number} value @param {(value: number) => number} toWhole */
function roundedTo(value, toWhole) {
  if (value === 0) return 0;
  const scale = 10 ** (FIGURES - 1 - Math.floor(Math.log10(Math.abs(value))));
  // Noise of the conversion must not push a limit to its neighbour.
  return Number((toWhole(Number((value * scale).toPrecision(12))) / scale).toPrecision(FIGURES));
}
