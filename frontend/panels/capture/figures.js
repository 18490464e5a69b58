// @ts-check
// What a captured move says in figures, and which of its steps something is wrong with.

import { formatFigures, formatFixed } from '../../model/numbers.js';
import { deviationText, markedStepsText, MARKS } from '../../plotting/captured.js';
import { element } from '../../ui/dom.js';

/** @typedef {import('../../model/types.js').Captured} Captured */
/** @typedef {import('../../model/types.js').MarkedSteps} MarkedSteps */

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
    ['Move', `${formatFixed(move.move)} of ${formatFixed(move_count)}`, ''],
    ['Steps', nextTo(formatFixed(move.steps), deviation && formatFixed(deviation.planned_steps)), ''],
    // A plan's duration goes on to the end of the last wait, which no capture shows.
    ['From first to last', nextTo(secondsText(move.duration_s), deviation && secondsText(deviation.planned_duration_s)), ''],
  ];
  if (deviation) {
    const { largest_us, largest_at_step, mean_us, rms_us, clock_ppm } = deviation.figures;
    rows.push(
      ['Largest deviation', `${deviationText(largest_us)}${deviationText(largest_us) === '0 µs' ? '' : `, at measured step ${formatFixed(largest_at_step)}`}`, ''],
      ['Mean, root mean square', `${deviationText(mean_us)}, ${deviationText(rms_us)}`, ''],
      ...(clock_ppm === null ? [] : [/** @type {[string, string, string]} */ (['Clock', clockText(clock_ppm), ''])]),
      marked('missing', deviation.missing),
      marked('extra', deviation.extra),
    );
  }
  if (short) rows.push(marked('short', short));
  return rows;
}

/** @param {number} duration_s */
const secondsText = (duration_s) => `${formatFigures(duration_s, 5)} s`;

/** @param {string} measured @param {string | null} planned */
const nextTo = (measured, planned) => (planned === null ? measured : `${measured}; planned ${planned}`);

/** @param {keyof typeof MARKS} mark @param {MarkedSteps} steps @returns {[string, string, string]} */
function marked(mark, steps) {
  const { sign, word } = MARKS[mark];
  const { count } = steps;
  const text = count === 0 ? 'none' : `${formatFixed(count)}: ${markedStepsText(mark, steps)}`;
  return [`${sign} ${word.charAt(0).toUpperCase()}${word.slice(1)}`, text, count === 0 ? '' : mark];
}

/** @param {number} ppm */
function clockText(ppm) {
  if (Math.abs(ppm) < 0.5) return 'as planned';
  return `${formatFixed(Math.abs(ppm))} ppm ${ppm > 0 ? 'slower' : 'faster'} than planned`;
}
