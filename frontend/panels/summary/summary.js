// @ts-check
// The figures of the chosen method in one row, those of the kept design beneath them in grey, and above both what is
// worth a second look.

import { activeProfile, unitsOf } from '../../curves.js';
import { element, messageLine } from '../../dom.js';
import { methodOf, REFERENCE } from '../../methods.js';
import { formatFigures, formatFixed, formatSignedPercent } from '../../numbers.js';
import { methodSwatch } from '../../swatch.js';
import { shownValue, STEPS_AND_SECONDS, unitWord } from '../../units.js';

/** @typedef {import('../../types.js').Answer} Answer */
/** @typedef {import('../../types.js').Design} Design */
/** @typedef {import('../../units.js').Quantity} Quantity */

/** One figure of a design.
 * @typedef {object} Figure
 * @property {string} value
 * @property {string} unit
 * @property {string} more      a line about it
 * @property {boolean} isHigh   worth a look: more than a motor may bear */

// A motor that just bears the acceleration asked for, bears this much more; beyond it steps may be lost.
const BEARABLE = 1.25;

/** @type {[string, string, (answer: Answer) => Figure][]} */
const FIGURES = [
  ['duration', 'Duration', duration],
  ['peak', 'Peak speed', peak],
  ['error', 'Largest error', largestError],
  ['acceleration', 'Implied acceleration', acceleration],
  ['landing', 'Landing error', landing],
];

/** @param {HTMLElement} root */
export function createSummary(root) {
  const messages = element('div', { className: 'summary-messages', role: 'status' });
  const figures = element('dl', { className: 'figures' });
  root.replaceChildren(messages, figures);
  /** @type {Answer | null} */
  let answer = null;
  /** @type {Answer | null} */
  let kept = null;
  let units = STEPS_AND_SECONDS;
  let drawn = '';

  const name = createStat('method', 'Method');
  const stats = FIGURES.map(([key, title, figureOf]) => ({ ...createStat(key, title), figureOf }));
  figures.append(name.element, ...stats.map((stat) => stat.element));

  function draw() {
    if (answer === null) return;
    const present = { ...answer, units };
    const { name: method, arithmetic } = answer.design.method;
    const before = kept && { ...kept, units };
    // While a slider moves this comes many times a second: the names stay.
    const names = JSON.stringify([method, arithmetic, kept?.design.method, kept?.design.name]);
    if (names !== drawn) {
      name.value.replaceChildren(methodSwatch(method), methodOf(method).label);
      name.more.replaceChildren(arithmetic);
      name.kept.replaceChildren(
        ...(before
          ? [element('i', { className: 'kept-swatch' }), `kept: ${methodOf(before.design.method.name).label}`]
          : []),
      );
    }
    drawn = names;
    for (const { value, more, kept: beneath, figureOf } of stats) {
      const figure = figureOf(present);
      value.replaceChildren(figure.value, element('small', { textContent: figure.unit && ` ${figure.unit}` }));
      value.classList.toggle('high', figure.isHigh);
      more.textContent = figure.more;
      beneath.textContent = before ? `${figureOf(before).value} ${figureOf(before).unit}`.trim() : '';
    }
    figures.classList.toggle('compared', before !== null);
  }

  return {
    /** @param {Answer} newest */
    show(newest) {
      answer = newest;
      draw();
    },
    /** @param {Answer | null} compared the answer to the design kept to compare with */
    showKept(compared) {
      if (kept === compared) return;
      kept = compared;
      draw();
    },
    /** @param {import('../../units.js').Units} chosen */
    showUnits(chosen) {
      units = chosen;
      draw();
    },
    /** @param {boolean} isStale whether the figures belong to earlier values */
    showStale(isStale) {
      root.classList.toggle('stale', isStale);
    },
    /** @param {import('../../messages.js').Message[]} others */
    showMessages(others) {
      if (others.length === 0 && messages.childElementCount === 0) return;
      messages.replaceChildren(...others.map((message) => messageLine(message)));
    },
  };
}

/** @param {string} key @param {string} title */
function createStat(key, title) {
  const value = element('dd', { className: 'value' });
  const more = element('dd', { className: 'more' });
  const kept = element('dd', { className: 'more kept', title: 'Of the kept design' });
  const heading = element('dt', { textContent: title });
  const box = element('div', { className: `stat ${key}`, 'data-figure': key }, heading, value, more, kept);
  return { element: box, value, more, kept };
}

/** @param {Answer} answer @returns {Figure} */
function duration(answer) {
  const { steps, duration_s } = activeProfile(answer).summary;
  const { design } = answer;
  const travel = (steps * Number(design.axis.travel_per_rev)) / stepsPerRev(design);
  const more = `${formatFixed(steps)} steps = ${formatFigures(travel)} ${design.axis.travel_unit}`;
  const [value, unit] = durationWords(duration_s);
  return { value, unit, more, isHigh: false };
}

/** @param {Answer} answer @returns {Figure} */
function peak(answer) {
  const { design } = answer;
  const inUnit = (/** @type {number} */ speed) => formatSpeed(shownValue(unitsOf(answer), design, 'speed', speed));
  return {
    value: inUnit(activeProfile(answer).summary.peak_speed_steps_per_s),
    unit: unitWord(unitsOf(answer), design, 'speed'),
    more: `of ${inUnit(Number(design.ramp.slew_speed_steps_per_s))} asked for`,
    isHigh: false,
  };
}

/** @param {Answer} answer @returns {Figure} */
function largestError({ design, errors }) {
  const largest = errors[design.method.name]?.largest_relative_error;
  if (design.method.name === REFERENCE) return { value: '–', unit: '', more: 'the reference', isHigh: false };
  if (!largest) return { value: '–', unit: '', more: '', isHigh: false };
  const more = largest.value === 0 ? '' : `at step ${formatFixed(largest.step)}`;
  return { value: formatSignedPercent(largest.value), unit: '%', more, isHigh: false };
}

/** @param {Answer} answer @returns {Figure} */
function acceleration(answer) {
  const { design, errors } = answer;
  const largest = errors[design.method.name]?.peak_acceleration_steps_per_s2;
  if (!largest) return { value: '–', unit: '', more: '', isHigh: false };
  const { acceleration_steps_per_s2, deceleration_steps_per_s2 } = design.ramp;
  const asked = Number(
    largest.value < 0 ? (deceleration_steps_per_s2 ?? acceleration_steps_per_s2) : acceleration_steps_per_s2,
  );
  const value = formatSpeed(shownValue(unitsOf(answer), design, 'acceleration', largest.value));
  const times = formatFixed(Math.abs(largest.value) / asked, 2);
  return {
    value,
    unit: unitWord(unitsOf(answer), design, 'acceleration'),
    more: `${times} × ${largest.value < 0 ? 'd' : 'a'}, step ${formatFixed(largest.step)}`,
    isHigh: Math.abs(largest.value) > BEARABLE * asked,
  };
}

/** @param {Answer} answer @returns {Figure} */
function landing(answer) {
  const speed = answer.errors[answer.design.method.name]?.landing_error_steps_per_s;
  if (speed === undefined) return { value: '–', unit: '', more: '', isHigh: false };
  const shown = shownValue(unitsOf(answer), answer.design, 'speed', speed);
  const unit = unitWord(unitsOf(answer), answer.design, 'speed');
  return { value: formatSigned(shown), unit, more: 'against base speed', isHigh: false };
}

/** @param {number} speed */
function formatSpeed(speed) {
  return Math.abs(speed) < 100 && !Number.isInteger(speed) ? formatFigures(speed) : formatFixed(speed);
}

/** @param {number} value */
function formatSigned(value) {
  return value > 0 ? `+${formatSpeed(value)}` : formatSpeed(value);
}

/** @param {Design} design */
function stepsPerRev({ axis }) {
  return Number(axis.full_steps_per_rev) * Number(axis.microsteps);
}

/** @param {number} seconds @returns {[string, string]} */
function durationWords(seconds) {
  if (seconds < 1) return [formatFigures(seconds * 1000), 'ms'];
  if (seconds < 600) return [formatFixed(seconds, 3), 's'];
  return [`${formatFixed(Math.floor(seconds / 60))} min ${formatFixed(Math.floor(seconds % 60))}`, 's'];
}
