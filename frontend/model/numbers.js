// @ts-check
// Numbers as people type and read them.

/** @typedef {import('./types.js').Entry} Entry */

const GROUPED = /^[+-]?[1-9]\d{0,2}([,'\u2019\u00a0\u202f ]\d{3})+(\.\d*)?$/;
const PLAIN = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
const DECIMAL_COMMA = /^[+-]?\d+,\d+$/;
// What conversions leave of a double's digits is noise beyond these.
const FIGURES = 12;
const SEPARATORS = /[,'\u2019\u00a0\u202f ]/g;

/**
 * Turn the text of a field into what is sent: a number if it is one, else the text as it was typed.
 * Separators are removed only where they part thousands: "1,5" and "0,500" mean parts of one, so they stay text.
 * @param {string} text
 * @returns {Entry}
 */
export function parseEntry(text) {
  const typed = text.trim().replace(/^\u2212/, '-');
  const digits = GROUPED.test(typed) ? typed.replace(SEPARATORS, '') : typed;
  const value = PLAIN.test(digits) ? Number(digits) : NaN;
  return Number.isFinite(value) ? value : text.trim();
}

/** Whether a text is a number, be it too large for one.
 * @param {string} text */
export const isNumberText = (text) => PLAIN.test(text.trim().replace(/^\u2212/, '-'));

/** A number without the noise that conversions leave behind its twelfth figure.
 * @param {number} value */
export function tidy(value) {
  return Number(value.toPrecision(FIGURES));
}

/** The nearest whole number; a half goes away from 0, so that forwards and backwards are alike.
 * @param {number} value */
export const nearestWhole = (value) => Math.sign(value) * Math.round(Math.abs(value));

/** What to write in place of a decimal comma, as a sentence to add to a refusal; '' where there is none.
 * @param {unknown} entry */
export function pointHint(entry) {
  const typed = typeof entry === 'string' ? entry.trim().replace(/^\u2212/, '-') : '';
  return DECIMAL_COMMA.test(typed) ? ` A point is expected for the comma: ${typed.replace(',', '.')}.` : '';
}

/**
 * Write a field's content with thousands separators and no digit lost; text that isn't a number as it is.
 * @param {Entry} entry
 */
export function formatEntry(entry) {
  const text = String(entry);
  if (typeof entry === 'string' || text.includes('e')) return text;
  const [whole, fraction] = text.split('.');
  const grouped = whole.replace(/\B(?=(\d{3})+$)/g, ',');
  return fraction === undefined ? grouped : `${grouped}.${fraction}`;
}

/** By digits after the point: to make one takes a hundred times as long as to use it.
 * @type {Intl.NumberFormat[]} */
const formats = [];

/** @param {number} value @param {number} [digits] digits after the point */
export function formatFixed(value, digits = 0) {
  const options = { minimumFractionDigits: digits, maximumFractionDigits: digits };
  formats[digits] ??= new Intl.NumberFormat('en-US', options);
  return formats[digits]
    .format(value)
    .replace(/^-(?=[0.,]*$)/, '')
    .replace('-', '\u2212');
}

/** Write a value with about `figures` significant figures, whole digits never dropped.
 * @param {number} value @param {number} [figures] */
export function formatFigures(value, figures = 4) {
  const magnitude = value === 0 || !Number.isFinite(value) ? 0 : Math.floor(Math.log10(Math.abs(value)));
  return formatFixed(value, Math.min(6, Math.max(0, figures - 1 - magnitude)));
}

/** Write a value that is a figure of a machine, such as "250" and "1,066.667": no more than is known of it, and no zeros at its end.
 * @param {number} value @param {number} figures significant ones that are known */
export function formatKnown(value, figures) {
  const [whole, fraction] = formatFigures(Number(value.toPrecision(figures)), figures).split('.');
  const kept = fraction?.replace(/0+$/, '') ?? '';
  return kept === '' ? whole : `${whole}.${kept}`;
}

/** The same of a greatest value: never more than it is.
 * @param {number} value 0 or more @param {number} [figures] */
export function formatHighest(value, figures = 4) {
  const magnitude = value > 0 && Number.isFinite(value) ? Math.floor(Math.log10(value)) : 0;
  const digits = Math.min(6, Math.max(0, figures - 1 - magnitude));
  // What is a round number but for floating point stays one.
  return formatFixed(Math.floor(value * 10 ** digits * (1 + 1e-12)) / 10 ** digits, digits);
}

/** So many of something, such as "1 row" and "2 rows".
 * @param {number} count @param {string} one what one of them is called; several have an s */
export function counted(count, one) {
  return `${formatFixed(count)} ${one}${count === 1 ? '' : 's'}`;
}

/** Round values evenly apart, the first not above and the last not below a span that they divide into so many parts at
 * most, or two more.
 * @param {number} from @param {number} to @param {number} most
 * @returns {{at: number, text: string}[]} */
export function roundParts(from, to, most) {
  const least = (to - from) / most;
  const power = 10 ** Math.floor(Math.log10(least));
  const apart = tidy(([1, 2, 5].find((part) => tidy(part * power) >= tidy(least)) ?? 10) * power);
  const digits = Math.max(0, -Math.floor(Math.log10(apart)));
  const [first, last] = [Math.floor(tidy(from / apart)), Math.ceil(tidy(to / apart))];
  return Array.from({ length: last - first + 1 }, (_, part) => {
    const at = tidy((first + part) * apart);
    return { at, text: formatFixed(at, digits) };
  });
}

/** Write a fraction as a signed percentage: 0.061 as "+6.1".
 * @param {number} fraction */
export function formatSignedPercent(fraction) {
  const percent = fraction * 100;
  if (Math.abs(percent) < 0.0005) return '0';
  const digits = Math.abs(percent) >= 9.95 ? 0 : Math.abs(percent) >= 0.0995 ? 1 : 3;
  return `${percent > 0 ? '+' : ''}${formatFixed(percent, digits)}`;
}
