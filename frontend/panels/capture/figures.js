// @ts-check
// What a captured move says in figures, and which of its steps something is wrong with.

import { formatFigures, formatFixed } from '../../model/numbers.js';
import { deviationText, MARKS } from '../../plotting/captured.js';
import { element } from '../../ui/dom.js';

/** @typedef {import('../../model/types.js').Captured} Captured */
/** @typedef {import('../../model/types.js').MarkedSteps} MarkedSteps */

/** More of them are marked in the plots. */
const MOST_NAMED = 5;

export function createCaptureFigures() {
  const list = element('dl', { className: 'trace-figures' });
  const whole = element('div', { className: 'capture-figures', id: 'capture-figures' }, list);
  return {
    element: whole,
    /** @param {Captured} answer @param {boolean} isStale whether they are of an earlier design */
    show(answer, isStale) {
      whole.classList.toggle('stale', isStale);
      list.replaceChildren(
        ...rowsOf(answer).flatMap(([name, value, mark]) => [
          element('dt', { textContent: name }),
          element('dd', { className: mark, textContent: value }),
        ]),
      );
    },
  };
}

/** @param {Captured} answer @returns {[string, string, string][]} name, value, and the name of a mark that has any */
function rowsOf({ move, move_count }) {
  if (move === null) return [];
  const { deviation, short_pulses: short } = move;
  /** @type {[string, string, string][]} */
  const rows = [
    ['Move', `${formatFixed(move.move)} of ${formatFixed(move_count)}, ${formatFigures(move.duration_s, 5)} s`, ''],
    ['Steps', deviation ? `${formatFixed(move.steps)}; planned ${formatFixed(deviation.planned_steps)}` : formatFixed(move.steps), ''],
  ];
  if (deviation) {
    const { largest_us, largest_at_step, mean_us, rms_us, clock_ppm } = deviation.figures;
    rows.push(
      ['Largest deviation', `${deviationText(largest_us)}${deviationText(largest_us) === '0 µs' ? '' : `, at step ${formatFixed(largest_at_step)}`}`, ''],
      ['Mean, root mean square', `${deviationText(mean_us)}, ${deviationText(rms_us)}`, ''],
      ['Clock', clockText(clock_ppm), ''],
      marked('missing', deviation.missing),
      marked('extra', deviation.extra),
    );
  }
  if (short) rows.push(marked('short', short));
  return rows;
}

/** @param {keyof typeof MARKS} mark @param {MarkedSteps} steps @returns {[string, string, string]} */
function marked(mark, { count, step }) {
  const { sign, word } = MARKS[mark];
  const named = step.slice(0, MOST_NAMED).map((one) => formatFixed(one));
  const more = count > named.length ? ' …' : '';
  const text = count === 0 ? 'none' : `${formatFixed(count)}: step${count === 1 ? '' : 's'} ${named.join(', ')}${more}`;
  return [`${sign} ${word.charAt(0).toUpperCase()}${word.slice(1)}`, text, count === 0 ? '' : mark];
}

/** @param {number} ppm */
function clockText(ppm) {
  if (Math.abs(ppm) < 0.5) return 'as planned';
  return `${formatFixed(Math.abs(ppm))} ppm ${ppm > 0 ? 'slower' : 'faster'} than planned`;
}
