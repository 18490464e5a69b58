// @ts-check
// What the browser remembers between visits.

import { isDesign } from './design.js';
import { METHODS } from './methods.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').MethodName} MethodName */

const DESIGN = 'stepramp.design';
const REPLACED = 'stepramp.design.replaced';
const UNREADABLE = 'stepramp.design.unreadable';
const SHOWN = 'stepramp.shown';
const THEME = 'stepramp.theme';

/** Private windows may refuse storage: the page then works without a memory.
 * @param {string} key */
function read(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** @param {string} key @param {string} text @returns {boolean} whether it is kept */
function write(key, text) {
  try {
    localStorage.setItem(key, text);
    return true;
  } catch {
    return false;
  }
}

/** @param {string} key @returns {Design | null} */
function readDesign(key) {
  const text = read(key);
  if (text === null) return null;
  try {
    const document = JSON.parse(text);
    if (isDesign(document)) return document;
  } catch {
    // Not even JSON: kept aside below, like a document of another shape.
  }
  write(UNREADABLE, text);
  return null;
}

export const memory = {
  /** The design last worked on; one that can't be shown is kept aside. */
  design: () => readDesign(DESIGN),
  /** @param {Design} design */
  keepDesign: (design) => write(DESIGN, JSON.stringify(design)),
  /** The design that an example took the place of. */
  replacedDesign: () => readDesign(REPLACED),
  /** @param {Design} design */
  keepReplacedDesign: (design) => write(REPLACED, JSON.stringify(design)),
  /** The methods last shown, unknown names left out; null: nothing is kept. @returns {MethodName[] | null} */
  shown: () => {
    const names = read(SHOWN)?.split(' ');
    return names ? METHODS.map((method) => method.name).filter((name) => names.includes(name)) : null;
  },
  /** @param {Iterable<MethodName>} names */
  keepShown: (names) => write(SHOWN, [...names].join(' ')),
  /** @returns {string | null} */
  theme: () => read(THEME),
  /** @param {string} theme */
  keepTheme: (theme) => write(THEME, theme),
};
