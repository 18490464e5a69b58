// @ts-check
// What each tab of the browser keeps, under its own name: what is worked on in it and how that is looked at. No tab writes
// another's record.

import { isDesign } from '../model/design.js';
import { areTold } from '../model/flight.js';
import { knownAnswers } from '../model/guide.js';
import { isLink } from '../model/library.js';
import { knownMethods, SHOWN_AT_FIRST } from '../model/methods.js';
import { unitsNamed, unitsText } from '../model/units.js';
import { MOST_AXES } from '../model/workbench.js';
import { keysAfter, readText, removeText, writeText } from './storage.js';

/** @typedef {import('../model/workbench.js').Machine} Machine */
/** @typedef {import('../model/types.js').View} View */

/** @typedef {object} TabRecord
 * @property {number} at_ms               when it was written, by the clock
 * @property {boolean} isOwn              whether it would be missed: it is no example as it came
 * @property {boolean} isExample          whether what is worked on is an example as it came
 * @property {Machine} machine            what is worked on
 * @property {Machine | null} replaced    what an example, a file or a link took the place of
 * @property {import('../model/units.js').Units} units
 * @property {import('../model/types.js').MethodName[]} shown
 * @property {Record<number, View>} views by the axes' ids
 * @property {boolean} areAllShown
 * @property {[number, number] | null} allZoom
 * @property {Pick<import('../model/guide.js').Guide, 'drive' | 'player'>} guide  what no design can hold of its answers
 * @property {import('../model/flight.js').Told[] | null} inFlight  what the motor is told while it moves
 * @property {Record<number, import('../model/library.js').Link>} links  which revision of the library each axis began with */

/** @typedef {{id: string, record: TabRecord}} Kept */

export const RECORD = 'stepramp.tab.';
/** So many tabs that were closed are remembered, the newest, and so much of them [characters]. Of the 5 million that a
 * browser keeps for a page the rest is for the open ones. */
const MOST_CLOSED = 12;
const MOST_CLOSED_LENGTH = 2_000_000;

/** The words that may say how an axis is looked at.
 * @type {Record<string, string[]>} */
const VIEW_WORDS = {
  against: ['step', 'time', 'position'],
  part: ['whole', 'start', 'up', 'down'],
  third: ['error', 'parts', 'deviation', 'acceleration', 'jerk'],
};

export const records = {
  /** @param {string} id of the tab @returns {TabRecord | null} null: there is none that can be shown */
  read: (id) => parseRecord(readText(RECORD + id)),
  /** Whether there is something under that name, be it readable or not.
   * @param {string} id */
  exists: (id) => readText(RECORD + id) !== null,
  /** @param {string} id @param {TabRecord} record */
  write: (id, record) => writeText(RECORD + id, JSON.stringify(record)),
  /** @param {string} id */
  remove: (id) => removeText(RECORD + id),
  /** All that can be shown, the newest first.
   * @returns {Kept[]} */
  all: () =>
    keysAfter(RECORD)
      .flatMap((id) => {
        const record = records.read(id);
        return record === null ? [] : [{ id, record }];
      })
      .sort((one, other) => other.record.at_ms - one.record.at_ms),
};

/** @param {string | null} text @returns {TabRecord | null} null: none, or none that can be shown */
export function parseRecord(text) {
  /** @type {any} */
  let kept;
  try {
    kept = JSON.parse(text ?? 'null');
  } catch {
    return null;
  }
  if (!Number.isFinite(kept?.at_ms) || !isMachine(kept.machine)) return null;
  const { at_ms, isOwn, isExample, machine, replaced, units, shown, views, areAllShown, allZoom, guide, inFlight, links } = kept;
  return {
    at_ms,
    isOwn: isOwn !== false,
    isExample: isExample === true,
    machine: withIds(machine),
    replaced: isMachine(replaced) ? withIds(replaced) : null,
    units: unitsNamed(unitsText(units ?? {})),
    shown: Array.isArray(shown) ? knownMethods(shown) : SHOWN_AT_FIRST,
    views: readViews(views),
    areAllShown: areAllShown === true,
    allZoom: isZoom(allZoom) ? allZoom : null,
    guide: knownAnswers(guide),
    inFlight: areTold(inFlight) ? inFlight : null,
    links: Object.fromEntries(Object.entries(links ?? {}).filter(([, one]) => isLink(one))),
  };
}

/** The tabs whose records go, of those that are closed: examples as they came, and the oldest that are too many or too long.
 * What can't be read is the oldest.
 * @param {string[]} closed their ids @returns {string[]} */
export function beyondBounds(closed) {
  const aged = closed.map((id) => {
    const text = readText(RECORD + id) ?? '';
    const record = parseRecord(text);
    return { id, length: text.length, at_ms: record?.at_ms ?? 0, isOwn: record?.isOwn ?? true };
  });
  const missed = aged.filter(({ isOwn }) => isOwn).sort((one, other) => other.at_ms - one.at_ms);
  let length = 0;
  const remembered = missed.filter((one, index) => index < MOST_CLOSED && (length += one.length) <= MOST_CLOSED_LENGTH);
  return aged.filter((one) => !remembered.includes(one)).map(({ id }) => id);
}

/** @param {any} state @returns {state is Machine} */
export function isMachine(state) {
  return (
    Array.isArray(state?.axes) &&
    state.axes.length >= 1 &&
    state.axes.length <= MOST_AXES &&
    state.axes.every(isDesign) &&
    Number.isInteger(state.active) &&
    state.active >= 0 &&
    state.active < state.axes.length &&
    (state.together === 'independent' || state.together === 'line') &&
    (state.kept === null || isDesign(state.kept))
  );
}

/** Each axis has an id of its own: before they had some, none was kept.
 * @param {Machine} machine @returns {Machine} */
function withIds(machine) {
  const { ids, axes } = machine;
  const haveIds = Array.isArray(ids) && ids.length === axes.length && ids.every(Number.isSafeInteger) && new Set(ids).size === ids.length;
  return haveIds ? machine : { ...machine, ids: axes.map((_, index) => index) };
}

/** @param {any} kept @returns {Record<number, View>} */
function readViews(kept) {
  return Object.fromEntries(
    Object.entries(kept ?? {}).flatMap(([id, view]) =>
      isView(view) ? [[id, { ...view, zoom: isZoom(view.zoom) ? view.zoom : null, range: null }]] : [],
    ),
  );
}

/** @param {any} view @returns {view is View} */
function isView(view) {
  const words = Object.entries(VIEW_WORDS);
  return words.every(([name, known]) => known.includes(view?.[name])) && typeof view.only === 'string' && typeof view.acceleration === 'boolean';
}

/** @param {any} zoom @returns {zoom is [number, number]} */
function isZoom(zoom) {
  return Array.isArray(zoom) && zoom.length === 2 && zoom.every(Number.isFinite) && zoom[0] < zoom[1];
}
