// @ts-check
// A line that appears for a while under the head of the page: what was just done where nothing else shows it. It is for
// the eye; the page's live region tells the ear.

import { element, icon } from '../../dom.js';

const SHOWN_MS = 6000;

export function createNotice() {
  const line = element('p', { className: 'notice', id: 'notice', 'aria-hidden': 'true', hidden: true });
  let timer = 0;
  return {
    element: line,
    /** @param {string} text @param {boolean} hasFailed */
    show(text, hasFailed) {
      line.replaceChildren(icon(hasFailed ? 'error' : 'ok'), element('span', { textContent: text }));
      line.classList.toggle('failed', hasFailed);
      line.hidden = false;
      clearTimeout(timer);
      timer = setTimeout(() => (line.hidden = true), SHOWN_MS);
    },
  };
}
