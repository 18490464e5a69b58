// @ts-check
// What the library keeps, in words: designs with their revisions, what was measured of them, pushes, and what a file has added.

import { LONGEST_NAME } from './design.js';
import { GROUPS } from './fields.js';
import { labelOf, nameOf } from './messages.js';
import { formatFixed } from './numbers.js';
import { quoted } from './quoted.js';
import { factorOf, shownEntry, unitOf } from './shown_entry.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {{name: string, notes: string, tags: string[]}} About */
/** @typedef {About & {id: string, version: number, saved_at: string, revisions: number}} Kept   revisions: the number of the newest */
/** @typedef {{number: number, note: string, content_hash: string, saved_at: string}} Revision */
/** @typedef {Kept & {history: Revision[]}} KeptWithRevisions   the newest first */
/** @typedef {'trace' | 'capture' | 'stall_map'} RecordKind */
/** @typedef {{id: string, revision: number, kind: RecordKind, note: string, kept_at: string}} KeptRecord */
/** @typedef {{field: string, before: unknown, after: unknown}} Difference */
/** @typedef {{id: string, family: string, identity: string, name: string, port: string, pushes: number}} SeenDevice */
/** @typedef {{axis: number, name: string, revisions: {design_id: string, name: string, number: number}[]}} PushedAxis */
/** @typedef {{id: string, device_id: string, device: string, pushed_at: string, client: string | null, mode: string,
 *   trouble: string | null, verified: boolean | null, backup: string | null, axes: PushedAxis[]}} PushTold */
/** @typedef {{designs: number, revisions: number, devices: number, pushes: number, records: number, there_already: number, described: number,
 *   copies: string[]}} Imported */

/** Which revision of which design an axis was opened from, or saved as: design is what the axis was then.
 * @typedef {{id: string, name: string, number: number, version: number, design: Design}} Link */

export const RECORD_NAMES = { trace: 'Trace', capture: 'Capture', stall_map: 'Stall map' };

const FIELDS = new Map(GROUPS.flatMap((group) => group.fields).map((field) => [field.path, field]));
const NOTHING = '–';
// A text longer than this is told as what it is: a row has no room for it.
const LONGEST_VALUE = 60;

/** When something was saved, on the person's clock.
 * @param {string} iso in UTC */
export const whenText = (iso) =>
  new Date(iso).toLocaleString('en-GB', { day: 'numeric', month: 'short', year: 'numeric', hour: '2-digit', minute: '2-digit' });

/** @param {number} count @param {string} one @param {string} [several] */
const counted = (count, one, several = `${one}s`) => `${formatFixed(count)} ${count === 1 ? one : several}`;

/** @param {number} count */
export const revisionsText = (count) => counted(count, 'revision');

/** What a search found, in words.
 * @param {number} count @param {number} shown @param {boolean} isSearched */
export function foundText(count, shown, isSearched) {
  if (count === 0) return isSearched ? 'No design has all these words and tags.' : 'Nothing is in the library yet: save this design as its first.';
  const found = `${counted(count, 'design')}${isSearched ? ' found' : ''}`;
  return shown < count ? `${found}; the ${formatFixed(shown)} that were saved last are listed: more words find the others.` : found;
}

/** @param {number} count of tags that have no button */
export const moreTagsText = (count) => `and ${counted(count, 'more tag')}: search for ${count === 1 ? 'its' : 'their'} words`;

/** What is wrong with the name that a design is to be kept under; null: nothing.
 * @param {string} name @param {string} [own] what it is called if none is typed */
export function nameProblem(name, own = '') {
  const isOwn = own.trim() !== '';
  if (name.trim() === '' && (name !== '' || !isOwn)) {
    return `The name is ${name === '' ? 'empty' : 'only spaces'}; allowed: a name that can be read${isOwn ? ', or none at all for the design’s own' : ''}.`;
  }
  const length = [...name.trim()].length;
  return length > LONGEST_NAME ? `The name has ${formatFixed(length)} characters; at most ${LONGEST_NAME} are allowed.` : null;
}

/** Tags as they are typed, with commas between them; each once.
 * @param {string} text */
export const tagsOf = (text) => [...new Set(text.split(',').map((tag) => tag.trim()).filter((tag) => tag !== ''))];

/** The tags of designs, those of most designs first.
 * @param {{tags: string[]}[]} designs @returns {string[]} */
export function tagsOfAll(designs) {
  /** @type {Map<string, number>} */
  const counts = new Map();
  for (const { tags } of designs) for (const tag of tags) counts.set(tag, (counts.get(tag) ?? 0) + 1);
  return [...counts].sort(([one, often], [other, oftener]) => oftener - often || one.localeCompare(other)).map(([tag]) => tag);
}

/** A difference as a person reads it, each value in the units shown, by the scale of its own revision.
 * @param {Difference} difference @param {import('./units.js').Units} units @param {Design} before @param {Design} after
 * @returns {{label: string, before: string, after: string}} */
export function differenceRow({ field, before: one, after: other }, units, before, after) {
  return { label: labelOf(field), before: valueText(field, one, units, before), after: valueText(field, other, units, after) };
}

/** @param {string} path @param {unknown} value @param {import('./units.js').Units} units @param {Design} design */
function valueText(path, value, units, design) {
  if (value === null || value === undefined || value === '') return NOTHING;
  const field = FIELDS.get(path);
  if (field && (typeof value === 'number' || typeof value === 'string')) {
    return `${shownEntry(value, factorOf(units, design, field))} ${unitOf(units, design, field)}`.trim();
  }
  if (path === 'ramp.shape') return nameOf(Reflect.get(/** @type {object} */ (value), 'name'));
  if (path.startsWith('table') && typeof value === 'object') return rowsText(value);
  const text = typeof value === 'object' ? JSON.stringify(value) : String(nameOf(value));
  return text.length > LONGEST_VALUE ? `${text.slice(0, LONGEST_VALUE)} …` : text;
}

/** @param {object} table or its rows */
function rowsText(table) {
  const rows = Array.isArray(table) ? table : Reflect.get(table, 'rows');
  return Array.isArray(rows) ? counted(rows.length, 'row') : NOTHING;
}

/** What became of a push.
 * @param {PushTold} push */
export function pushOutcome({ trouble, verified, mode }) {
  if (trouble !== null) return { text: `Failed: ${trouble}`, hasFailed: true };
  const purpose = mode === 'try' ? 'to be tried' : 'to be kept';
  return verified === true ? { text: `Read back as sent, ${purpose}`, hasFailed: false } : { text: `Not read back as sent, ${purpose}`, hasFailed: true };
}

/** What each axis was given, by the library's own names where it has the same.
 * @param {PushedAxis[]} axes */
export function pushedText(axes) {
  return axes
    .map(({ axis, name, revisions: [same] }) => {
      const what = same ? `${quoted(same.name)}, revision ${same.number}` : `${quoted(name || 'unnamed')}, in no revision`;
      return axes.length === 1 && axis === 0 ? what : `axis ${axis}: ${what}`;
    })
    .join('; ');
}

/** What a file has added.
 * @param {Imported} imported */
export function importedText({ designs, revisions, devices, pushes, records, there_already: known, described, copies }) {
  const added = /** @type {[number, string, string?][]} */ ([
    [designs, 'design'],
    [revisions, 'revision'],
    [records, 'trace, capture or stall map', 'traces, captures and stall maps'],
    [pushes, 'push', 'pushes'],
    [devices, 'device'],
  ]).filter(([count]) => count > 0);
  const first = added.length === 0 ? (described > 0 ? '' : 'Nothing was added.') : `Added: ${added.map(([count, one, several]) => counted(count, one, several)).join(', ')}.`;
  const said = described > 0 ? ` More is said of ${counted(described, 'design')} that the library had.` : '';
  const there = known > 0 ? ` There already: ${formatFixed(known)}.` : '';
  const beside = copies.length > 0 ? ` Beside what the library has under the same name, as it differs: ${copies.map(quoted).join(', ')}.` : '';
  return (first + said + there + beside).trim();
}

/** Which revisions were drawn into the plots, and which had to give way to them.
 * @param {string} name of the design @param {number[]} numbers @param {string[]} gone labels of those that gave way */
export function pinnedText(name, numbers, gone) {
  const drawn = `Drawn into the plots, beside the design in hand: ${numbers.map((number) => `revision ${number}`).join(' and ')} of ${quoted(name)}`;
  return gone.length === 0 ? `${drawn}.` : `${drawn}, in the place of ${gone.map(quoted).join(' and ')}: more could not be told from each other.`;
}

/** What is in hand, and what it is in the library.
 * @param {string} name of the design @param {Link | null} link @param {boolean} isSame whether it is as that revision */
export function inHandText(name, link, isSame) {
  const called = `In hand: ${quoted(name || 'unnamed')}`;
  if (link === null) return `${called}, not in the library`;
  const revision = `revision ${link.number}${link.name === name ? '' : ` of ${quoted(link.name)}`}`;
  return isSame ? `${called}, ${revision}` : `${called}, changed since ${revision}`;
}

/** Why the library can't be used now, and what still can be.
 * @param {string} reason of the server, or that it does not answer */
export const outOfReachText = (reason) => `${reason} The page goes on without the library, and keeps your design in this browser as ever.`;

/** What is told of a change that somebody else was quicker with.
 * @param {KeptWithRevisions} theirs @param {Link} link what the change was of */
export function conflictText({ name, revisions, history: [newest] }, link) {
  if (revisions === link.number || newest === undefined) return `Somebody else has given ${quoted(name)} another name, notes or tags meanwhile. Nothing was overwritten.`;
  const note = newest.note === '' ? '' : `, ${quoted(newest.note)}`;
  return (
    `Somebody else has saved revision ${revisions} of ${quoted(name)} meanwhile, on ${whenText(newest.saved_at)}${note}. ` +
    `Yours began with what was there before it. Nothing was overwritten.`
  );
}

/** More steps of a trace aren't kept: four values each, and a document may have twice as many at most. */
const MOST_KEPT_STEPS = 5_000;

/** A trace of no more steps than are kept, the first and the last of them.
 * @param {any} trace @returns {any} */
export function thinnedTrace(trace) {
  const count = trace.step.length;
  if (count <= MOST_KEPT_STEPS) return trace;
  const places = Array.from({ length: MOST_KEPT_STEPS }, (_, index) => Math.round((index * (count - 1)) / (MOST_KEPT_STEPS - 1)));
  const columns = Object.entries(trace).map(([name, value]) => [name, Array.isArray(value) && value.length === count ? places.map((place) => value[place]) : value]);
  return Object.fromEntries(columns);
}

/** Whether something is a link, as it is kept.
 * @param {any} kept @returns {kept is Link} */
export const isLink = (kept) =>
  typeof kept?.id === 'string' && typeof kept.name === 'string' && Number.isSafeInteger(kept.number) && Number.isSafeInteger(kept.version) && typeof kept.design === 'object' && kept.design !== null;
