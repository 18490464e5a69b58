// @ts-check
// What is told to the ear: the page's live region.

import { whenChanged } from '../../app/state.js';

/** @param {HTMLElement} root */
export function createAnnouncements(root) {
  return {
    show: whenChanged(
      ({ told }) => [told.announced],
      (announced) => {
        if (announced !== null) root.textContent = announced.text;
      },
    ),
  };
}
