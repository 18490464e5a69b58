// @ts-check
// Rows to look at before they are used.

import { element } from '../../ui/dom.js';

/** A table to look at.
 * @param {string[]} heads @param {string[][]} rows */
export function previewTable(heads, rows) {
  const cells = (/** @type {string[]} */ row) => row.map((cell) => element('td', { textContent: cell }));
  return element(
    'table',
    {},
    element('thead', {}, element('tr', {}, ...heads.map((name) => element('th', { scope: 'col', textContent: name })))),
    element('tbody', {}, ...rows.map((row) => element('tr', {}, ...cells(row)))),
  );
}
