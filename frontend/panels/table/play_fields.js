// @ts-check
// Where a gauge is to go, and when: three whole numbers, each with what is wrong with it.

import { refusalText } from '../../model/messages.js';
import { formatEntry, parseEntry } from '../../model/numbers.js';
import { beyond } from '../../model/taken.js';
import { element } from '../../ui/dom.js';
import { showAtPlaces } from '../../ui/refusal.js';

/** @typedef {import('../../model/types.js').Rejection} Rejection */
/** @typedef {import('./play_chart.js').Target} Target */

const FIELDS = [
  { name: 'first', label: 'Go to', unit: 'step', field: 'targets.0.target' },
  { name: 'after', label: 'and after', unit: 'ms', field: 'targets.1.at_us' },
  { name: 'second', label: 'to', unit: 'step', field: 'targets.1.target' },
];
const US_PER_MS = 1000;
const TOO_MANY_STEPS = 'Both moves together have too many steps';

/** @param {string} explainedBy the id of what explains the fields @param {() => void} onInput */
export function createPlayFields(explainedBy, onInput) {
  const inputs = FIELDS.map(({ name, label }) =>
    element('input', {
      id: `play-${name}`,
      inputMode: 'numeric',
      autocomplete: 'off',
      'aria-label': label,
      'aria-describedby': explainedBy,
      'data-explained-by': explainedBy,
      oninput: onInput,
    }),
  );
  const problems = FIELDS.map(() => element('div', { role: 'status' }));
  const boxes = FIELDS.flatMap(({ label, unit }, at) => [
    element('span', { className: 'muted', textContent: label }),
    element('span', { className: 'fit-field' }, inputs[at], element('span', { textContent: unit })),
  ]);
  const places = FIELDS.map(({ label, field }, at) => ({
    path: new RegExp(`^${field}$`),
    input: inputs[at],
    problem: problems[at],
    text: (/** @type {Rejection} */ one) => refusalText({ ...one, value: parseEntry(inputs[at].value) }, `“${label}”`),
  }));

  return {
    element: element('div', {}, element('div', { className: 'fit-wishes play-fields' }, ...boxes), ...problems),
    first: inputs[0],
    /** @param {number[]} proposed for fields that are empty */
    propose(proposed) {
      inputs.forEach((input, at) => {
        if (input.value === '') input.value = formatEntry(proposed[at]);
      });
    },
    /** What the fields say, as the server takes it; null: it is no number, which is said there.
     * @returns {Target[] | null} */
    targets() {
      const entries = inputs.map(({ value }) => parseEntry(value));
      const wrong = FIELDS.filter((_, at) => !isWhole(entries[at])).map(({ field }) => notWhole(field));
      showAtPlaces(wrong, places);
      if (wrong.length > 0) return null;
      const [first, afterMs, second] = entries.map(Number);
      // What is too large for a number can't be sent; the server refuses the largest one, too.
      const afterUs = Math.min(afterMs * US_PER_MS, Number.MAX_VALUE);
      return [{ at_us: 0, target: first }, { at_us: afterUs, target: second }]; // prettier-ignore
    },
    /** Say at the fields what was refused.
     * @param {Rejection[]} rejections @param {Target[]} targets @returns {Rejection[]} those of no field */
    reject: (rejections, targets) => showAtPlaces(inWordsOfFields(rejections, targets), places),
  };
}

/** @param {import('../../model/types.js').Entry} entry */
const isWhole = (entry) => typeof entry === 'number' && Number.isInteger(entry) && entry >= 0;

/** @param {string} field @returns {Rejection} */
const notWhole = (field) => ({ field, value: null, allowed: 'a whole number from 0 on', message: '' });

/** The server speaks of a range, which follows from the targets, and of microseconds.
 * @param {Rejection[]} rejections @param {Target[]} targets @returns {Rejection[]} */
function inWordsOfFields(rejections, targets) {
  const most = rejections.find(({ field }) => field === 'range_steps')?.limits?.highest;
  const own = rejections.map(inMilliseconds).map(ofBothMoves);
  if (!most) return own;
  // A target that is refused by itself is beyond every range.
  const tooFar = targets.flatMap(({ target }, at) => (target < most ? [] : [beyondMost(`targets.${at}.target`, most - 1)]));
  return [...tooFar, ...own.filter(({ field }) => !/^range_steps$|\.target$/.test(field ?? ''))];
}

/** @param {string} field @param {number} highest */
const beyondMost = (field, highest) => beyond(field, null, { lowest: 0, highest, is_whole: true, note: '' }, 'steps');

/** @param {Rejection} one @returns {Rejection} */
function inMilliseconds(one) {
  if (one.unit !== 'µs' || !one.limits) return one;
  const [lowest, highest] = [one.limits.lowest, one.limits.highest].map((us) => us && us / US_PER_MS);
  return beyond(one.field ?? '', one.value, { ...one.limits, lowest, highest }, 'ms');
}

/** @param {Rejection} one @returns {Rejection} */
const ofBothMoves = (one) => (one.field === 'targets' ? { ...one, message: `${TOO_MANY_STEPS}; allowed: ${one.allowed}.` } : one);
