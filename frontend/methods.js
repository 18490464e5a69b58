// @ts-check
// The ramp methods, in the order of the legend. The server has the list: what it can compute, the page can show.

import { api, Refusal, ServerGone } from './api.js';

/** @typedef {import('./types.js').MethodName} MethodName */

const AGAIN_AFTER_MS = 500;

/** Without the methods there is nothing to show: a server that is busy is asked again. */
async function served() {
  for (;;) {
    try {
      return await api.methods();
    } catch (error) {
      if (!(error instanceof Refusal || error instanceof ServerGone)) throw error;
      await new Promise((resolve) => setTimeout(resolve, AGAIN_AFTER_MS));
    }
  }
}

const list = await served();

export const METHODS = list.methods;

/** The method that the others are held against. */
export const REFERENCE = list.reference;

/** What is shown until a person chooses. */
export const SHOWN_AT_FIRST = METHODS.filter((method) => method.is_shown_at_first).map((method) => method.name);

/** @param {MethodName} name */
export function methodOf(name) {
  return METHODS.find((method) => method.name === name) ?? METHODS[0];
}
