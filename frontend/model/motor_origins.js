// @ts-check
// Where the numbers of a motor come from, as the server says it: a verdict is worth what they are.

import { GROUPS } from './fields.js';

/** @typedef {import('./types.js').MotorAnswer['origins'][string]} Origin */

/** @type {[Origin, string][]} */
const WORDS = [
  ['measured', 'Measured'],
  ['datasheet', 'By a data sheet'],
  ['given', 'Your own'],
  ['assumed', 'Guessed'],
  ['unused', 'Doesn’t count'],
];
/** What a field is called away from its place.
 * @type {Record<string, string>} */
const LABELS = {
  'motor.full_steps_per_rev': 'its steps a turn',
  'drive.current_a': 'current',
};
/** In the order in which they are told.
 * @type {[string, string][]} */
const TOLD = [
  ['motor.stalled', 'stall point'],
  ['motor.torque_curve', 'torque curve'],
  ['motor.measured_with', 'what drove it then'],
  ...(GROUPS.find(({ title }) => title === 'Motor')?.fields ?? []).map(
    ({ path, label }) => /** @type {[string, string]} */ ([path, LABELS[path] ?? label.toLowerCase()]),
  ),
  ['drive.current_is', 'RMS or peak'],
];

/** What is said of them, by where they come from: "Guessed: friction, damping".
 * @param {Record<string, Origin>} origins by path @returns {{origin: Origin, word: string, text: string}[]} */
export function originsOf(origins) {
  const all = TOLD.map(([path, label]) => ({ origin: origins[path], label }));
  // Of damping nobody can say more: it is played with three.
  all.push({ origin: 'assumed', label: 'damping' });
  return WORDS.flatMap(([origin, word]) => {
    const labels = all.filter((one) => one.origin === origin).map(({ label }) => label);
    return labels.length === 0 ? [] : [{ origin, word, text: labels.join(', ') }];
  });
}
