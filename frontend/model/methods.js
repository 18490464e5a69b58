// @ts-check
// The ramp methods, in the order of the legend. The server makes the list: what it can compute, the page can show.

// @ts-expect-error  No file, but what GET /api/v1/methods answers, as a module: so it is there before all else begins.
import served from '../assets/methods.js';

/** @typedef {import('./types.js').MethodName} MethodName */

/** @type {import('./types.js').RampMethod[]} */
export const METHODS = served.methods;

/** The method that the others are held against.
 * @type {MethodName} */
export const REFERENCE = served.reference;

/** What is shown until a person chooses. */
export const SHOWN_AT_FIRST = METHODS.filter((method) => method.is_shown_at_first).map((method) => method.name);

/** @param {MethodName} name */
export function methodOf(name) {
  return METHODS.find((method) => method.name === name) ?? METHODS[0];
}

/** The methods of these names, in their order, unknown names left out.
 * @param {string[]} names */
export const knownMethods = (names) => METHODS.map((method) => method.name).filter((name) => names.includes(name));
