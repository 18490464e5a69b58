// @ts-check
// What the server says, with its quantities in the units that are shown. It speaks of steps and seconds, and says which
// parts of a sentence are quantities.

import { limitsInUnit, roundedTo } from './limits_text.js';
import { formatEntry } from './numbers.js';
import { shownEntry } from './shown_entry.js';
import { shownValue, unitWord } from './units.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Told} Told */
/** @typedef {import('./units.js').Quantity} Quantity */
/** @typedef {import('./units.js').Units} Units */
/** @typedef {Partial<import('./types.js').Rejection> & {field: string | null, message: string}} Said  a refusal, or a remark */

/** @type {Record<string, Quantity>} */
const QUANTITIES = { steps: 'length', 'steps/s': 'speed', 'steps/s²': 'acceleration', 'steps/s³': 'jerk' };
const ROUND = { nearest: Math.round, down: Math.floor, up: Math.ceil };
/** A field's name tells its unit; the first number of a drawn point is a speed. */
const FIELD = /(?:^|[._])(steps(?:_per_s[23]?)?)$/;
const DRAWN_SPEED = /\.points\.\d+\.0$/;
/** What is about several axes calls their designs by their places. */
const OF_AXIS = /^(?:designs|axes)\.(\d+)\./;

/** What has refusals and remarks about designs told in the units that are shown.
 * @param {Units} units @param {Design[]} designs in the order of the fields' numbers; of one there need be no number */
export function inShownUnits(units, designs) {
  /** @template {Said} T @param {T} said @returns {T} */
  return (said) => {
    const own = Number(OF_AXIS.exec(said.field ?? '')?.[1] ?? 0);
    const told = (said.told ?? []).filter(({ axis }) => designs[axis ?? own] !== undefined);
    const put = (/** @type {string} */ text) => told.reduce(withQuantity(units, designs, own), ['', text]).join('');
    const allowed = typeof said.allowed === 'string' ? { allowed: put(said.allowed) } : {};
    return { ...said, message: put(said.message), ...allowed, ...limitWords(said, units, designs[own]) };
  };
}

/** Sentences about designs in the units that are shown.
 * @param {Units} units @param {Design[]} designs as for inShownUnits
 * @param {string[]} sentences @param {Told[][]} told the quantities of each @returns {string[]} */
export function sentencesInUnits(units, designs, sentences, told) {
  const shown = inShownUnits(units, designs);
  return sentences.map((message, place) => shown({ field: null, message, told: told[place] }).message);
}

/** What a remedy is called on a button, in the units that are shown.
 * @param {Units} units @param {Design} design whose it is @param {import('./types.js').Remedy} remedy */
export function remedyWords(units, design, { text, told }) {
  const { message } = inShownUnits(units, [design])({ field: null, message: text, told });
  return message.charAt(0).toUpperCase() + message.slice(1);
}

/** What puts the next quantity of a sentence into its place, after what is done.
 * @param {Units} units @param {Design[]} designs @param {number} own */
const withQuantity = (units, designs, own) => (/** @type {string[]} */ [done, rest], /** @type {Told} */ one) => {
  const at = rest.indexOf(one.text);
  if (at < 0) return [done, rest];
  return [done + rest.slice(0, at) + words(one, units, designs[one.axis ?? own]), rest.slice(at + one.text.length)];
};

/** @param {Told} one @param {Units} units @param {Design} design */
function words({ text, value, unit, rounding }, units, design) {
  const quantity = QUANTITIES[unit];
  const factor = shownValue(units, design, quantity, 1);
  if (factor === 1) return text;
  return `${formatEntry(roundedTo(value * factor, factor, ROUND[rounding]))} ${unitWord(units, design, quantity)}`;
}

/** The value, and limits that are in its unit.
 * @param {Said} said @param {Units} units @param {Design | undefined} design */
function limitWords({ field, value, limits, told, unit }, units, design) {
  const own = unitOf(field ?? '');
  const quantity = QUANTITIES[own];
  if (quantity === undefined || design === undefined || (limits === undefined ? told === undefined : unit !== own)) return {};
  const [factor, word] = [shownValue(units, design, quantity, 1), unitWord(units, design, quantity)];
  if (factor === 1) return {};
  const given = typeof value === 'number' ? { given: `${shownEntry(value, factor)} ${word} (${formatEntry(value)} ${own})` } : {};
  return limits === undefined ? given : { ...given, allowed: limitsInUnit(limits, word, factor, value) };
}

/** The unit of a field, which its name tells; '' when it is none that an axis converts.
 * @param {string} field */
function unitOf(field) {
  const name = DRAWN_SPEED.test(field) ? 'steps_per_s' : (FIELD.exec(field)?.[1] ?? '');
  return name.replace('_per_', '/').replace('2', '²').replace('3', '³');
}
