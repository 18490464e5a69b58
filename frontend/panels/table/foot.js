// @ts-check
// The foot of the table: how large it is and what can be done with it and, in a line of its own, what was done last.

import { element, icon, showText } from '../../ui/dom.js';
import { counted } from '../../model/numbers.js';

const BYTES_PER_ROW = 4;

/** @param {Record<'simulate' | 'copyC' | 'copyCsv' | 'refit' | 'putBack', () => void>} handlers */
export function createFoot({ simulate, copyC, copyCsv, refit, putBack }) {
  const told = element('span', { className: 'grow', role: 'status' });
  const fitAgain = button('Refit', 'Fit the rows to the ramp as it is now', refit);
  const back = button('', 'Put the rows before back', putBack);
  const noteLine = element('div', { className: 'foot-line note' }, told, fitAgain, back);
  const size = element('span', { className: 'grow' });
  const buttons = [
    button('Simulate', 'See what a gauge does when its target changes in flight', simulate),
    button('C', 'Copy the rows as C', copyC, icon('copy')),
    button('CSV', 'Copy the rows as CSV', copyCsv, icon('copy')),
  ];

  return {
    element: element(
      'div',
      { className: 'table-foot' },
      noteLine,
      element('div', { className: 'foot-line' }, size, ...buttons),
    ),
    /** @param {{rows: number, note: string, canRefit: boolean, replaced: number}} shown
     *   replaced: how many rows can be put back; 0: none */
    show({ rows, note, canRefit, replaced }) {
      const bytes = (rows * BYTES_PER_ROW).toLocaleString('en-US');
      showText(size, rows === 0 ? 'No rows: add one, fit them, or paste a table.' : `${counted(rows, 'row')} · ${bytes} bytes`);
      for (const one of buttons) one.hidden = rows === 0;
      // Read aloud when it is another.
      if (told.textContent !== note) told.textContent = told.title = note;
      fitAgain.hidden = !canRefit;
      back.hidden = replaced === 0;
      showText(back, `Put the ${replaced} before back`);
      noteLine.hidden = note === '' && fitAgain.hidden && back.hidden;
    },
  };
}

/** @param {string} text @param {string} title @param {() => void} onclick @param {...Node} before */
function button(text, title, onclick, ...before) {
  const label = before.length === 0 ? {} : { 'aria-label': title };
  const properties = { className: 'button quiet small', type: 'button', title, ...label, onclick };
  return element('button', properties, ...before, text);
}
