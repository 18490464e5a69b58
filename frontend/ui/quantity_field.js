// @ts-check
// A field for a length or a speed in the unit that is chosen; what is asked for is in steps and seconds.

import { element } from './dom.js';
import { selectOnFocus } from './select_on_focus.js';
import { areEqual } from '../model/equal.js';
import { refusalText } from '../model/messages.js';
import { formatEntry, formatFixed, nearestWhole, parseEntry } from '../model/numbers.js';
import { isNothing, roundingText, tooShortText } from '../model/shown_entry.js';
import { shownValue, storedValue, unitsFor, unitWord } from '../model/units.js';
import { inShownUnit } from './refusal.js';

/** @typedef {import('../model/types.js').Design} Design */
/** @typedef {import('../model/types.js').Entry} Entry */
/** @typedef {import('../model/units.js').Units} Units */

const MOST_FIGURES = 7;
/** What is beyond them comes of the conversion: 0.14 mm at 0.02 mm a step are 7 steps, not 7.000000000000001. */
const EXACT_FIGURES = 12;

/**
 * @param {{id: string, label: string, quantity: 'length' | 'speed', start: Entry | ((design: Design) => Entry),
 *   toWhole?: (steps: number) => number}} what
 *   start: steps or steps/s, or how they follow from the design until something is typed; toWhole: which whole step
 *   a length in another unit becomes, the nearest one if it isn't said
 */
export function quantityField({ id, label, quantity, start, toWhole = nearestWhole }) {
  /** In steps or steps/s, or the text that is no number.
   * @type {Entry} */
  let entry = typeof start === 'function' ? '' : start;
  let isTyped = false;
  /** What was typed, where that is no whole number of steps.
   * @type {import('../model/shown_entry.js').Between | null} */
  let between = null;
  /** @type {{units: Units, design: Design} | null} */
  let shown = null;
  const input = element('input', {
    id,
    inputMode: 'decimal',
    autocomplete: 'off',
    spellcheck: false,
    'aria-label': label,
    oninput: read,
    onblur: write,
  });
  selectOnFocus(input);
  const unit = element('span', { className: 'unit' });
  const box = element('span', { className: 'field grow' }, input, unit);

  function read() {
    const typed = parseEntry(input.value);
    isTyped = true;
    entry = typed;
    between = null;
    if (typeof typed !== 'number' || shown === null) return;
    const stored = storedValue(shown.units, shown.design, quantity, typed);
    if (!Number.isFinite(stored)) {
      entry = input.value.trim(); // Too large to be converted: the server says what is allowed, as of any other text.
      return;
    }
    // A motor makes whole steps; in steps the server says so of any other number.
    const isInSteps = unitsFor(shown.units, shown.design).length === 'steps';
    entry = quantity === 'length' && !isInSteps ? wholeSteps(Number(stored.toPrecision(EXACT_FIGURES))) : stored;
  }

  /** @param {number} exact */
  function wholeSteps(exact) {
    const whole = toWhole(exact);
    if (whole !== exact) between = { text: input.value.trim(), exact };
    return whole;
  }

  /** What a length becomes that is no whole number of steps; '' where it is one. */
  function rounding() {
    if (shown === null || between === null) return '';
    const { units, design } = shown;
    return roundingText(between, Number(entry), unitWord(units, design, quantity), shownValue(units, design, quantity, 1));
  }

  function write() {
    if (typeof entry === 'string') input.value = entry;
    if (shown === null || typeof entry !== 'number') return;
    const value = shownValue(shown.units, shown.design, quantity, entry);
    input.value = formatEntry(Number(value.toPrecision(MOST_FIGURES)));
    if (unitsFor(shown.units, shown.design).length === 'steps' && quantity === 'length') input.value = formatEntry(entry);
  }

  return {
    element: box,
    input,
    value: () => entry,
    /** @param {Entry} value steps or steps/s, or '' for an empty field */
    set(value) {
      isTyped = true;
      entry = value;
      between = null;
      write();
    },
    /** Have what it begins with again. */
    reset() {
      entry = typeof start === 'function' ? (shown === null ? '' : start(shown.design)) : start;
      isTyped = false;
      between = null;
      write();
    },
    /** What the server says is wrong with it.
     * @param {import('../model/types.js').Rejection} rejection @param {string} label */
    refusal(rejection, label) {
      if (shown === null) return refusalText(rejection, label);
      const { units, design } = shown;
      if (between === null || !isNothing(rejection)) return inShownUnit(rejection, label, quantity, units, design);
      return tooShortText(between, unitWord(units, design, quantity), shownValue(units, design, quantity, 1));
    },
    rounding,
    /** What the motor does, where that isn't what the field says; '' where it is. */
    inSteps() {
      const isInSteps = shown === null || unitsFor(shown.units, shown.design).length === 'steps';
      if (isInSteps || typeof entry !== 'number') return '';
      if (between !== null) return rounding();
      return quantity === 'length' ? `${formatFixed(entry)} steps` : `${formatFixed(entry, 1)} steps/s`;
    },
    /** @param {Units} units @param {Design} design */
    show(units, design) {
      const word = unitWord(units, design, quantity);
      const isSame = shown !== null && unit.textContent === word && areEqual([shown.design.axis], [design.axis]);
      shown = { units, design };
      unit.textContent = word;
      if (!isSame) between = null;
      const proposed = typeof start === 'function' && !isTyped ? start(design) : entry;
      if (isSame && proposed === entry) return;
      entry = proposed;
      write();
    },
  };
}
