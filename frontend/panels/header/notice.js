// @ts-check
// A line that appears under the head of the page: what was just done where nothing else shows it, for a while; and what
// went wrong in the page itself, until it is closed. The page's live region tells the ear the same.

import { closeButton, element, icon } from '../../ui/dom.js';

const SHOWN_MS = 6000;
/** What it takes to read a character: what an import says has several lines. */
const READING_MS = 70;

/** @param {() => void} onClose  the fault was read */
export function createNotice(onClose) {
  const line = element('p', { className: 'notice', id: 'notice', hidden: true });
  /** @type {string | null} */
  let fault = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;

  /** @param {string} text @param {boolean} hasFailed @param {...Node} more */
  function fill(text, hasFailed, ...more) {
    line.replaceChildren(icon(hasFailed ? 'error' : 'ok'), element('span', { textContent: text }), ...more);
    line.classList.toggle('failed', hasFailed);
    // What can be closed has to be found by those who don't see it.
    line.setAttribute('aria-hidden', String(more.length === 0));
    line.hidden = false;
  }

  /** What stays comes back once what passes is over. */
  function settle() {
    timer = undefined;
    if (fault === null) line.hidden = true;
    else fill(fault, true, closeButton('Close this message', onClose));
  }

  return {
    element: line,
    /** @param {string} text @param {boolean} hasFailed */
    show(text, hasFailed) {
      clearTimeout(timer);
      fill(text, hasFailed);
      timer = setTimeout(settle, Math.max(SHOWN_MS, text.length * READING_MS));
    },
    /** End what passes: something else is asked for by now. */
    close() {
      clearTimeout(timer);
      settle();
    },
    /** @param {string | null} text null: it was closed */
    showFault(text) {
      fault = text;
      if (text !== null) clearTimeout(timer);
      if (text !== null || timer === undefined) settle();
    },
  };
}
