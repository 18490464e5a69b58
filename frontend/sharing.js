// @ts-check
// The link that holds the whole design, on the clipboard.

import { copyText } from './clipboard.js';
import { encodeLink } from './link.js';

/** @typedef {import('./workbench.js').Work} Work */

/**
 * @param {Work} work
 * @param {object} handlers
 * @param {(text: string, hasFailed: boolean) => void} handlers.say
 * @param {(link: string) => void} handlers.showLink  where the page may not copy it
 */
export async function shareLink(work, { say, showLink }) {
  try {
    const link = location.origin + location.pathname + (await encodeLink(work));
    const length = link.length.toLocaleString('en-US');
    if (await copyText(link))
      say(`Link copied, ${length} characters. It opens in a StepRamp at ${location.host}.`, false);
    else showLink(link);
  } catch (error) {
    if (!(error instanceof RangeError)) throw error;
    say(error.message, true);
  }
}
