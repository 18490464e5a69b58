// @ts-check
// A figure of the summary: its title, its value, a line about it, and that of the pinned design.

import { formatFigures, formatFixed } from '../../model/numbers.js';
import { element } from '../../ui/dom.js';

/** @param {string} key @param {string} title */
export function createStat(key, title) {
  const value = element('dd', { className: 'value' });
  const more = element('dd', { className: 'more' });
  const pinned = element('dd', { className: 'more pinned', title: 'Of the pinned design' });
  const heading = element('dt', { textContent: title });
  const box = element('div', { className: `stat ${key}`, 'data-figure': key }, heading, value, more, pinned);
  return { element: box, value, more, pinned };
}

/** @param {number} speed */
export function formatSpeed(speed) {
  return Math.abs(speed) < 100 && !Number.isInteger(speed) ? formatFigures(speed) : formatFixed(speed);
}

/** @param {number} seconds @returns {[string, string]} */
export function durationWords(seconds) {
  if (seconds < 1) return [formatFigures(seconds * 1000), 'ms'];
  if (seconds < 600) return [formatFixed(seconds, 3), 's'];
  return [`${formatFixed(Math.floor(seconds / 60))} min ${formatFixed(Math.floor(seconds % 60))}`, 's'];
}
