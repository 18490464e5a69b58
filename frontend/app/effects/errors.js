// @ts-check
// What goes wrong where nobody expects it is shown and logged, never swallowed.

import { tellFault } from '../commands/told.js';

// Browsers say so when a box is measured again within one frame: nothing is wrong then.
const HARMLESS = /^ResizeObserver loop/;

/** @param {Pick<import('../state.js').Store, 'dispatch'>} store */
export function watchErrors({ dispatch }) {
  addEventListener('unhandledrejection', ({ reason }) => show(reason));
  addEventListener('error', ({ error, message }) => {
    if (!HARMLESS.test(message)) show(error ?? message);
  });

  /** @param {unknown} error */
  function show(error) {
    console.error(error);
    const text = (error instanceof Error ? error.message : String(error)).replace(/\.$/, '');
    dispatch(tellFault, `Something went wrong in the page: ${text}. Your design is kept; reload the page if anything looks odd.`);
  }

  return { show };
}
