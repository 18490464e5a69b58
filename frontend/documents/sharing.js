// @ts-check
// The link that holds the whole design, on the clipboard.

import { copyText } from '../ui/clipboard.js';
import { encodeLink } from './link.js';

/** @typedef {import('../model/workbench.js').Work} Work */

/**
 * @param {Work} work
 * @param {object} handlers
 * @param {(text: string, hasFailed: boolean) => void} handlers.tell
 * @param {(link: string) => void} handlers.showLink  where the page may not copy it
 */
export async function shareLink(work, { tell, showLink }) {
  try {
    const promised = encodeLink(work).then((fragment) => location.origin + location.pathname + fragment);
    const isCopied = await copyText(promised);
    const link = await promised;
    const length = link.length.toLocaleString('en-US');
    if (isCopied) tell(`Link copied, ${length} characters. To open it, StepRamp has to run at ${location.host}.`, false);
    else showLink(link);
  } catch (error) {
    if (!(error instanceof RangeError)) throw error;
    tell(error.message, true);
  }
}
