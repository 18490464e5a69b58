// @ts-check
// Which tabs of the browser are open. Each holds its name for as long as its page is there: by a lock, where the browser has
// locks, which it has for pages that are served securely or from the same machine; elsewhere tabs ask each other.

import { RECORD } from './records.js';

/** A reload waits so long for the page that it takes the place of; a duplicate as long in vain. */
const RELOAD_MS = 600;
/** So long the other tabs are listened to when they are asked who they are. */
const ANSWER_MS = 200;
const CHANNEL = 'stepramp.tabs';

/** @typedef {object} Presence
 * @property {(id: string) => Promise<boolean>} hold     at once, or not at all: another tab has the name
 * @property {(id: string) => Promise<boolean>} inherit as soon as the page lets go of it that this one is a reload of
 * @property {() => Promise<Set<string>>} open           the names of the open tabs
 * @property {(id: string, act: () => void) => Promise<void>} whileClosed  do something unless a tab of that name is open */

/** @returns {Presence} */
function byLocks() {
  /** @param {string} id @param {LockOptions} options @returns {Promise<boolean>} whether it is held */
  function hold(id, options) {
    return new Promise((resolve) => {
      const asked = navigator.locks.request(RECORD + id, options, (lock) => {
        resolve(lock !== null);
        return lock && new Promise(() => {});
      });
      asked.catch(() => resolve(false));
    });
  }

  return {
    hold: (id) => hold(id, { ifAvailable: true }),
    inherit(id) {
      const patience = new AbortController();
      setTimeout(() => patience.abort(), RELOAD_MS);
      return hold(id, { signal: patience.signal });
    },
    async open() {
      const { held = [] } = await navigator.locks.query();
      return new Set(held.flatMap(({ name }) => (name?.startsWith(RECORD) ? [name.slice(RECORD.length)] : [])));
    },
    async whileClosed(id, act) {
      await navigator.locks.request(RECORD + id, { ifAvailable: true }, (lock) => lock && act());
    },
  };
}

/** @returns {Presence} */
function byAsking() {
  const channel = new BroadcastChannel(CHANNEL);
  /** @type {string | null} */
  let own = null;
  /** @type {Set<string>} */
  let heard = new Set();
  channel.onmessage = ({ data: { here } }) => {
    if (here !== undefined) heard.add(here);
    else if (own !== null) channel.postMessage({ here: own });
  };

  async function others() {
    heard = new Set();
    const hearing = heard;
    channel.postMessage({});
    await new Promise((resolve) => setTimeout(resolve, ANSWER_MS));
    return hearing;
  }

  /** @param {string} id */
  async function hold(id) {
    if ((await others()).has(id)) return false;
    own = id;
    return true;
  }

  return {
    hold,
    // The page before has ended by then: what answers is another tab.
    inherit: hold,
    open: async () => (await others()).add(own ?? ''),
    async whileClosed(id, act) {
      if (id !== own && !(await others()).has(id)) act();
    },
  };
}

/** Begun once: this tab answers the others from then on.
 * @type {Presence | null} */
let asking = null;

/** How this browser knows. */
export function presenceOfTabs() {
  if (navigator.locks !== undefined) return byLocks();
  asking ??= byAsking();
  return asking;
}
