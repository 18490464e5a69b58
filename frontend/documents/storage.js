// @ts-check
// The browser's storage. It may refuse to keep anything, as some private windows do, or be full: that is told, never thrown.

/** What became of a text: it is kept; there is no room for it; nothing is kept at all.
 * @typedef {'kept' | 'full' | 'refused'} Keeping */

/** @param {string} key */
export function readText(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** Where it is not kept, what was kept before stays.
 * @param {string} key @param {string} text @returns {Keeping} */
export function writeText(key, text) {
  try {
    localStorage.setItem(key, text);
    return 'kept';
  } catch (error) {
    return error instanceof DOMException && /quota/i.test(error.name) ? 'full' : 'refused';
  }
}

/** @param {string} key */
export function removeText(key) {
  try {
    localStorage.removeItem(key);
  } catch {
    // Nothing is kept: so it is gone.
  }
}

/** What the keys that begin so go on with.
 * @param {string} start @returns {string[]} */
export function keysAfter(start) {
  try {
    const keys = Array.from({ length: localStorage.length }, (_, index) => localStorage.key(index) ?? '');
    return keys.filter((key) => key.startsWith(start)).map((key) => key.slice(start.length));
  } catch {
    return [];
  }
}
