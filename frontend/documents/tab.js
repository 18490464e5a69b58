// @ts-check
// Which tab of the browser this is. A tab has a name, which it keeps over a reload, and holds a lock of that name while it
// is open: so tabs know of each other which are. Whose lock is free was closed, and its record is for the next to go on with.

import { beyondBounds, isMachine, RECORD, records } from './records.js';
import { keysAfter, readText, removeText, writeText } from './storage.js';

/** @typedef {import('./records.js').TabRecord} TabRecord */

/** A tab has its name here: what is kept here goes with it, and with its duplicate. */
const OWN = 'stepramp.tab';
/** Where all tabs wrote before each had a record of its own. */
const SHARED = 'stepramp.work';
const SHARED_REPLACED = 'stepramp.work.replaced';
/** A reload waits so long for the page that it takes the place of; a duplicate as long in vain. */
const RELOAD_MS = 600;

/** The tab's name, and what it begins with: its own record; that of the tab which it is a duplicate of; or the newest of the
 * closed ones. null: there is none.
 * @returns {Promise<{id: string, record: TabRecord | null}>} */
export async function openTab() {
  takeOverShared();
  const own = readOwn();
  if (own !== null) {
    const record = records.read(own);
    const isReadable = record !== null || !records.exists(own);
    if (isReadable && (await claimPatiently(own))) return { id: own, record };
    return { id: await newTab(), record };
  }
  const all = records.all();
  if (navigator.locks === undefined) return { id: await newTab(), record: all[0]?.record ?? null };
  for (const { id, record } of all) {
    if (record.isOwn && (await claim(id, { ifAvailable: true }))) return { id: named(id), record };
  }
  return { id: await newTab(), record: null };
}

/** The open tabs, by their names; null: this browser can't tell. It has locks for pages that are served securely or from the
 * same machine.
 * @returns {Promise<Set<string> | null>} */
export async function openTabs() {
  if (navigator.locks === undefined) return null;
  const { held = [] } = await navigator.locks.query();
  return new Set(held.flatMap(({ name }) => (name?.startsWith(RECORD) ? [name.slice(RECORD.length)] : [])));
}

/** Forget closed tabs beyond the bounds of what is remembered; never one that is open. */
export async function forgetOldTabs() {
  const open = await openTabs();
  if (open === null) return;
  const closed = keysAfter(RECORD).filter((id) => !open.has(id));
  for (const id of beyondBounds(closed)) {
    await navigator.locks.request(RECORD + id, { ifAvailable: true }, (lock) => lock && records.remove(id));
  }
}

/** Hold the lock of a tab for as long as this page is there. Where there are no locks, nobody else is thought to.
 * @param {string} id @param {LockOptions} options @returns {Promise<boolean>} whether it is held */
function claim(id, options) {
  if (navigator.locks === undefined) return Promise.resolve(readOwn() === id);
  return new Promise((resolve) => {
    const asked = navigator.locks.request(RECORD + id, options, (lock) => {
      resolve(lock !== null);
      return lock && new Promise(() => {});
    });
    asked.catch(() => resolve(false));
  });
}

/** @param {string} id */
function claimPatiently(id) {
  const patience = new AbortController();
  setTimeout(() => patience.abort(), RELOAD_MS);
  return claim(id, { signal: patience.signal });
}

/** @returns {Promise<string>} */
async function newTab() {
  const [high, low] = crypto.getRandomValues(new Uint32Array(2));
  const id = named(high.toString(36) + low.toString(36));
  await claim(id, { ifAvailable: true });
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
function takeOverShared() {
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
