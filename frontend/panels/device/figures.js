// @ts-check
// The figures of a push as people read them.

import { element } from '../../ui/dom.js';
import { formatFigures, formatFixed, tidy } from '../../model/numbers.js';
import { shownValue, unitWord } from '../../model/units.js';

/** What an axis converts of them. Counts of steps stay counts.
 * @type {Record<string, import('../../model/units.js').Quantity>} */
const CONVERTED = { 'steps/s': 'speed', 'steps/s²': 'acceleration' };
/** More than any controller here tells apart. */
const FIGURES = 8;

/** Write a figure in its unit: times to a ten-thousandth of a µs, which is finer than a tick of any controller here.
 * @param {number} value @param {string} unit */
export function formatFigure(value, unit) {
  if (unit === 'CRC-16') return `0x${value.toString(16).toUpperCase().padStart(4, '0')}`;
  if (unit !== 'µs' && Number.isInteger(value)) return formatFixed(value);
  return formatFixed(value, 4).replace(/0{1,3}$/, '');
}

/** The unit that an item's figures are shown in, and what writes them.
 * @param {{unit: string, axis: number | null}} item
 * @param {import('../../model/units.js').Units} units
 * @param {import('../../model/types.js').Design[]} designs  that were pushed, or would be: of one, its axis has it */
export function figuresOf({ unit, axis }, units, designs) {
  const design = designs.length === 1 ? designs[0] : designs[axis ?? -1];
  const quantity = CONVERTED[unit];
  const factor = quantity === undefined || design === undefined ? 1 : shownValue(units, design, quantity, 1);
  if (factor === 1) return { unit, write: (/** @type {number} */ value) => formatFigure(value, unit) };
  return {
    unit: unitWord(units, design, quantity),
    write: (/** @type {number} */ value) => withoutZeros(formatFigures(tidy(value * factor), FIGURES)),
  };
}

/** @param {string} text a number */
const withoutZeros = (text) => (text.includes('.') ? text.replace(/\.?0+$/, '') : text);

/** The head of a figure's row: its name and its unit, of a checksum what kind of number it is; and, in a line of its own, what the
 * controller calls it, and its unit there.
 * @param {string} name @param {string} unit @param {import('../../model/types.js').OwnTerms | null} [own] */
export function figureHead(name, unit, own = null) {
  const word = unit === 'CRC-16' ? 'CRC' : unit;
  const small = word !== '' && !name.endsWith(word) && element('small', { textContent: word });
  const term = own && element('small', { className: 'own', textContent: own.unit === '' ? own.term : `${own.term}, ${own.unit}` });
  return element('th', { scope: 'row' }, name, small && ' ', small, term && ' ', term);
}

/** A figure's cell: the number, and beneath that the controller's own.
 * @param {string} textContent @param {number | null} [value] in the controller's own unit @param {string} [className] */
export function figureCell(textContent, value = null, className = '') {
  const own = value !== null && element('small', { className: 'own', textContent: formatFigure(value, '') });
  return element('td', { className }, textContent, own);
}

/** @param {(string | HTMLElement)[]} columns */
export function tableHead(columns) {
  const heads = columns.map((column) => element('th', { scope: 'col' }, column));
  return element('thead', {}, element('tr', {}, ...heads));
}

/** A word for those who don't see the column.
 * @param {string} textContent */
export function unseen(textContent) {
  return element('span', { className: 'unseen', textContent });
}

/** What a push takes: segments, if the controller takes any, and bytes.
 * @param {{segments: number | null, bytes: number}} push */
export function sizeText({ segments, bytes }) {
  return [...(segments === null ? [] : [`${segments} segments`]), `${formatFixed(bytes)} bytes`].join(' · ');
}
