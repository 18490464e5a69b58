// @ts-check
// What two revisions of a design differ in, each value in the units shown.

import { differenceRow } from '../../model/library.js';
import { element, picker } from '../../ui/dom.js';
import { button } from './rows.js';

/** @typedef {import('../../model/library.js').KeptWithRevisions} KeptWithRevisions */
/** @typedef {import('../../model/library.js').Difference} Difference */
/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {{differences: Difference[], before: Design, after: Design}} Compared */

/** @param {{compare: (kept: KeptWithRevisions, one: number, other: number) => Promise<Compared | null>,
 *   pin: (kept: KeptWithRevisions, numbers: number[]) => void, units: () => import('../../model/units.js').Units}} act */
export function createCompare({ compare, pin, units }) {
  /** @type {KeptWithRevisions | null} */
  let kept = null;
  /** @type {Compared | null} */
  let compared = null;
  const one = picker('Compare revision', () => ask());
  one.select.id = 'library-before';
  const other = picker('With revision', () => ask());
  other.select.id = 'library-after';
  const both = button('Pin both', () => kept && pin(kept, numbers()), { title: 'Draw both into the plots, beside the design in hand' });
  const result = element('div', { className: 'library-differences', id: 'library-differences', role: 'region', 'aria-label': 'What they differ in', tabIndex: 0 });
  const whole = element(
    'section',
    { className: 'library-section', id: 'library-compare' },
    element('h4', { textContent: 'Compare' }),
    element('div', { className: 'library-line' }, one.element, element('span', { className: 'muted', textContent: 'with' }), other.element, both),
    result,
  );

  const numbers = () => [Number(one.select.value), Number(other.select.value)];

  async function ask() {
    const [of, [from, to]] = [kept, numbers()];
    if (of === null) return;
    compared = null;
    const found = await compare(of, from, to);
    const [nowFrom, nowTo] = numbers();
    if (of !== kept || nowFrom !== from || nowTo !== to) return;
    compared = found;
    draw();
  }

  function draw() {
    if (compared === null) return result.replaceChildren();
    const { differences, before, after } = compared;
    const rows = differences.map((difference) => differenceRow(difference, units(), before, after));
    const [from, to] = numbers();
    result.replaceChildren(
      rows.length === 0
        ? element('p', { className: 'muted', textContent: 'They are the same.' })
        : element(
            'table',
            {},
            element('thead', {}, element('tr', {}, ...['', `Revision ${from}`, `Revision ${to}`].map((text) => element(text === '' ? 'td' : 'th', text === '' ? {} : { scope: 'col', textContent: text })))),
            element('tbody', {}, ...rows.map(({ label, before: was, after: is }) => element('tr', {}, element('th', { scope: 'row', textContent: label }), element('td', { textContent: was }), element('td', { textContent: is })))),
          ),
    );
  }

  return {
    element: whole,
    draw,
    /** @param {KeptWithRevisions} design */
    show(design) {
      kept = design;
      whole.hidden = design.history.length < 2;
      result.replaceChildren();
      if (whole.hidden) return;
      const choices = design.history.map(({ number }) => /** @type {[string, string]} */ ([String(number), `Revision ${number}`]));
      one.offer(choices, String(design.history[1].number));
      other.offer(choices, String(design.history[0].number));
      ask();
    },
  };
}
