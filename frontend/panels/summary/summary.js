// @ts-check
// The figures of the chosen method in one row, and above them what is worth a second look.

import { activeProfile } from '../../curves.js';
import { element, messageLine } from '../../dom.js';
import { methodOf, REFERENCE } from '../../methods.js';
import { formatFigures, formatFixed, formatSignedPercent } from '../../numbers.js';
import { methodSwatch } from '../../swatch.js';

/** @typedef {import('../../types.js').Answer} Answer */

/** @param {HTMLElement} root */
export function createSummary(root) {
  const messages = element('div', { className: 'summary-messages', role: 'status' });
  const figures = element('dl', { className: 'figures' });
  root.replaceChildren(messages, figures);
  return {
    /** @param {Answer} answer */
    show(answer) {
      const { name, arithmetic } = answer.design.method;
      const { summary } = activeProfile(answer);
      const largest = answer.errors[name]?.largest_relative_error;
      const unit = answer.design.axis.travel_unit;
      const travel =
        (summary.steps * Number(answer.design.axis.travel_per_rev)) /
        (Number(answer.design.axis.full_steps_per_rev) * Number(answer.design.axis.microsteps));
      figures.replaceChildren(
        stat('method', 'Method', [methodSwatch(name), methodOf(name).label], arithmetic),
        stat(
          'duration',
          'Duration',
          duration(summary.duration_s),
          `${formatFixed(summary.steps)} steps = ${formatFigures(travel)} ${unit}`,
        ),
        stat(
          'peak',
          'Peak speed',
          [formatFixed(summary.peak_speed_steps_per_s, summary.peak_speed_steps_per_s < 100 ? 1 : 0), small('steps/s')],
          `of ${formatFixed(Number(answer.design.ramp.slew_speed_steps_per_s))} asked for`,
        ),
        name === REFERENCE
          ? stat('error', 'Largest error', ['–'], 'this is the reference')
          : stat(
              'error',
              'Largest error',
              largest ? [formatSignedPercent(largest.value), small('%')] : ['–'],
              largest && largest.value !== 0 ? `at step ${formatFixed(largest.step)}` : '',
            ),
        phases(summary),
      );
    },
    /** @param {boolean} isStale whether the figures belong to earlier values */
    showStale(isStale) {
      root.classList.toggle('stale', isStale);
    },
    /** @param {import('../../messages.js').Message[]} others */
    showMessages(others) {
      messages.replaceChildren(...others.map((message) => messageLine(message)));
    },
  };
}

/** @param {string} name @param {string} title @param {(Node | string)[]} value @param {string | Node} more */
function stat(name, title, value, more) {
  return element(
    'div',
    { className: `stat ${name}`, 'data-figure': name },
    element('dt', { textContent: title }),
    element('dd', {}, ...value),
    element('dd', { className: 'more' }, more),
  );
}

/** @param {string} text */
function small(text) {
  return element('small', { textContent: ` ${text}` });
}

/** @param {number} seconds */
function duration(seconds) {
  if (seconds < 1) return [formatFigures(seconds * 1000), small('ms')];
  if (seconds < 600) return [formatFixed(seconds, 3), small('s')];
  return [formatFixed(Math.floor(seconds / 60)), small('min '), formatFixed(Math.floor(seconds % 60)), small('s')];
}

/** @param {import('../../types.js').Profile['summary']} summary */
function phases({ accelerate_steps, slew_steps, decelerate_steps }) {
  const counts = [accelerate_steps, slew_steps, decelerate_steps];
  const bar = element(
    'div',
    { className: 'phase-bar', 'aria-hidden': 'true' },
    ...counts.map(
      (steps, index) =>
        steps > 0 && element('i', { className: index === 1 ? 'slew' : '', style: `flex: ${steps} 1 0` }),
    ),
  );
  const text = counts.map((steps) => formatFixed(steps)).join(' · ');
  const figures =
    text.length > 20 ? [element('span', { className: 'long', textContent: text })] : [text, small('steps')];
  return stat('phases', 'Up · slew · down', figures, bar);
}
