// @ts-check
// Handing a file to the browser, which saves it as it is used to.

import { element } from './dom.js';

// Browsers ask for what they save once the press is over; then it is let go of.
const RELEASE_MS = 10_000;

/** @param {Blob} file @param {string} name */
export function download(file, name) {
  const url = URL.createObjectURL(file);
  element('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), RELEASE_MS);
}
