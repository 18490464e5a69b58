// @ts-check
// Which tab of the browser this is. A tab has a name, which it keeps over a reload, and holds it while it is open: so tabs
// know of each other which are. Whose name is free was closed, and its record is for the next to go on with.

import { presenceOfTabs } from './presence.js';
import { beyondBounds, isMachine, RECORD, records } from './records.js';
import { keysAfter, readText, removeText, writeText } from './storage.js';

/** @typedef {import('./records.js').TabRecord} TabRecord */

/** A tab has its name here: what is kept here goes with it, and with its duplicate. */
const OWN = 'stepramp.tab';
/** Where all tabs wrote before each had a record of its own. */
const SHARED = 'stepramp.work';
const SHARED_REPLACED = 'stepramp.work.replaced';

/** The tab's name, and what it begins with: its own record; that of the tab which it is a duplicate of; or the newest of the
 * closed ones. null: there is none.
 * @returns {Promise<{id: string, record: TabRecord | null}>} */
export async function openTab() {
  inheritShared();
  const own = readOwn();
  if (own !== null) {
    const record = records.read(own);
    const isReadable = record !== null || !records.exists(own);
    if (isReadable && (await presenceOfTabs().inherit(own))) return { id: own, record };
    return { id: await newTab(), record };
  }
  const open = await presenceOfTabs().open();
  for (const { id, record } of records.all()) {
    if (record.isOwn && !open.has(id) && (await presenceOfTabs().hold(id))) return { id: named(id), record };
  }
  return { id: await newTab(), record: null };
}

/** The open tabs, by their names. */
export const openTabs = () => presenceOfTabs().open();

/** Forget closed tabs beyond the bounds of what is remembered; never one that is open. */
export async function forgetOldTabs() {
  const open = await openTabs();
  const closed = keysAfter(RECORD).filter((id) => !open.has(id));
  for (const id of beyondBounds(closed)) {
    await presenceOfTabs().whileClosed(id, () => records.remove(id));
  }
}

/** @returns {Promise<string>} */
async function newTab() {
  const [high, low] = crypto.getRandomValues(new Uint32Array(2));
  const id = named(high.toString(36) + low.toString(36));
  await presenceOfTabs().hold(id);
  return id;
}

function readOwn() {
  try {
    return sessionStorage.getItem(OWN);
  } catch {
    return null;
  }
}

/** @param {string} id */
function named(id) {
  try {
    sessionStorage.setItem(OWN, id);
  } catch {
    // The next page of this tab is another one then, and begins with what this one keeps.
  }
  return id;
}

/** What all tabs shared becomes the record of a tab that was closed. */
function inheritShared() {
  const [machine, replaced] = [SHARED, SHARED_REPLACED].map((key) => {
    try {
      return JSON.parse(readText(key) ?? 'null');
    } catch {
      return null;
    }
  });
  if (!isMachine(machine)) return;
  const text = JSON.stringify({ at_ms: 0, machine, replaced });
  if (writeText(`${RECORD}before-${Date.now()}`, text) !== 'kept') return;
  removeText(SHARED);
  // What can't be read may be a newer version's.
  if (isMachine(replaced)) removeText(SHARED_REPLACED);
}
