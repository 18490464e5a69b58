// @ts-check
// The figures of the chosen method in one row, those of the pinned design beneath them in grey, and above both what is
// worth a second look.

import { urge } from '../../app/commands/told.js';
import { areAxesShown, pinnedOf, plottedStalenessOf, shownCurvesOf, summaryMessagesOf } from '../../app/selectors.js';
import { whenChanged } from '../../app/state.js';
import { activeProfile, unitsOf } from '../../plotting/curves.js';
import { closeButton, element, messageLine, showText } from '../../ui/dom.js';
import { comparisonWords } from '../../model/comparison_words.js';
import { methodOf, REFERENCE } from '../../model/methods.js';
import { formatFigures, formatFixed, formatSignedPercent } from '../../model/numbers.js';
import { watchStrip } from '../../ui/strip.js';
import { methodSwatch } from '../../ui/swatch.js';
import { axesFigures, createAxesFigures } from './axes_figures.js';
import { createExplanation } from './explanation.js';
import { createStat, durationWords, formatSpeed } from './stat.js';
import { shownValue, unitWord } from '../../model/units.js';

/** @typedef {import('../../model/types.js').Answer} Answer */
/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/units.js').Quantity} Quantity */

/** One figure of a design.
 * @typedef {object} Figure
 * @property {string} value
 * @property {string} unit
 * @property {string} more      a line about it
 * @property {boolean} isHigh   worth a look: more than a motor may bear */

// A motor that just bears the acceleration asked for, bears this much more; beyond it steps may be lost.
const BEARABLE = 1.25;

const METHOD_HELP = 'Whose figures these are: the method that is chosen, and the numbers it computes with.';
/** @type {{key: string, title: string, help: string, figureOf: (answer: Answer) => Figure}[]} */
const FIGURES = [
  {
    key: 'duration',
    title: 'Duration',
    help: 'From the first pulse to the end of the last interval, and the way it takes.',
    figureOf: duration,
  },
  {
    key: 'peak',
    title: 'Peak speed',
    help: 'The speed of the shortest interval. A short move slows down before it has the slew speed asked for.',
    figureOf: peak,
  },
  {
    key: 'error',
    title: 'Largest error',
    help: 'How far an interval is from that of the exact method, in parts of it, where it is farthest.',
    figureOf: largestError,
  },
  {
    key: 'acceleration',
    title: 'Implied acceleration',
    help: `What two neighbouring intervals ask of the motor, where it is most. Over ${BEARABLE} × what was asked for it is marked: the motor may lose steps.`,
    figureOf: acceleration,
  },
  {
    key: 'landing',
    title: 'Last-step speed',
    help: 'How much faster than the base speed the last step is: the motor has to stop from it at once.',
    figureOf: landing,
  },
];

/** @param {HTMLElement} root @param {import('../../app/state.js').Dispatch} dispatch */
export function createSummary(root, dispatch) {
  const messages = element('div', { className: 'summary-messages', role: 'status' });
  const figures = element('dl', { className: 'figures strip' });
  const comparison = element('p', { className: 'comparison', hidden: true });
  const ofAxes = createAxesFigures();
  root.replaceChildren(messages, figures, ofAxes.element, comparison);
  for (const strip of [figures, ofAxes.element]) watchStrip(strip);
  let drawn = '';

  const name = createStat('method', 'Method');
  const stats = FIGURES.map((figure) => ({ ...createFigure(figure.key, figure.title), ...figure }));
  figures.append(name.element, ...stats.map((stat) => stat.element));
  const explanation = createExplanation(root);
  explanation.explain(name.element, METHOD_HELP);
  for (const stat of stats) explanation.explain(stat.element, stat.help);

  /** @param {Answer | null} answer @param {Answer | null} pinned of the pinned design
   * @param {import('../../model/units.js').Units} units */
  function draw(answer, pinned, units) {
    figures.classList.toggle('blank', answer === null);
    if (answer === null) return;
    const present = { ...answer, units };
    const { name: method, arithmetic } = answer.design.method;
    const before = pinned && { ...pinned, units };
    // While a slider moves this comes many times a second: the names stay.
    const names = JSON.stringify([method, arithmetic, pinned?.design.method, pinned?.design.name]);
    if (names !== drawn) {
      name.value.replaceChildren(methodSwatch(method), methodOf(method).label);
      name.more.replaceChildren(arithmetic);
      name.pinned.replaceChildren(
        ...(before
          ? [element('i', { className: 'pinned-swatch' }), `pinned: ${methodOf(before.design.method.name).label}`]
          : []),
      );
    }
    drawn = names;
    for (const { value, number, unit, more, pinned: beneath, figureOf } of stats) {
      const figure = figureOf(present);
      showText(number, figure.value);
      showText(unit, figure.unit && ` ${figure.unit}`);
      value.classList.toggle('high', figure.isHigh);
      showText(more, figure.more);
      showText(beneath, before ? `${figureOf(before).value} ${figureOf(before).unit}`.trim() : '');
    }
    figures.classList.toggle('compared', before !== null);
    const words = before ? comparedWords(present, before) : '';
    comparison.hidden = words === '';
    showText(comparison, words);
  }

  /** @param {import('../../model/messages.js').Message} message */
  function line(message) {
    const { about } = message;
    const shown = messageLine(message);
    if (about !== undefined) shown.append(closeButton('Close this message', () => dispatch(urge, about, '')));
    return shown;
  }

  /** @param {import('../../app/state.js').AllAxes | null} all null: the plots show one axis
   * @param {import('../../model/units.js').Units} units */
  function showAxes(all, units) {
    const list = all === null ? [] : axesFigures(all, units);
    ofAxes.show(list);
    figures.hidden = list.length > 0;
  }

  const shows = [
    whenChanged((state) => [areAxesShown(state) ? state.answers.allAxes : null, state.units], showAxes),
    whenChanged((state) => [shownCurvesOf(state), pinnedOf(state), state.units], draw),
    // Whether the figures belong to earlier values.
    whenChanged(
      (state) => [plottedStalenessOf(state)],
      (staleness) => {
        root.classList.toggle('stale', staleness !== null);
        root.classList.toggle('awaited', staleness === 'awaited');
      },
    ),
    whenChanged(
      (state) => [summaryMessagesOf(state)],
      (list) => {
        if (list.length === 0 && messages.childElementCount === 0) return;
        messages.replaceChildren(...list.map(line));
      },
    ),
  ];

  return {
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      for (const show of shows) show(state);
    },
  };
}

/** A stat of a number and its unit, which are written where they stand: while a slider moves they change many times a second.
 * @param {string} key @param {string} title */
function createFigure(key, title) {
  const stat = createStat(key, title);
  const [number, unit] = [document.createTextNode(''), element('small')];
  stat.value.append(number, unit);
  return { ...stat, number, unit };
}

/** How the design in hand moves against the pinned one; empty while it is not known.
 * @param {Answer} answer @param {Answer} pinned */
function comparedWords(answer, pinned) {
  const [now, before] = [motionOf(answer), motionOf(pinned)];
  return now && before ? `Against the pinned design: ${comparisonWords(now, before)}.` : '';
}

/** @param {Answer} answer */
function motionOf(answer) {
  const motion = answer.errors[answer.design.method.name]?.motion;
  const largest = (/** @type {number[]} */ values) => values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  return motion && {
    duration: activeProfile(answer).summary.duration_s,
    acceleration: largest(motion.acceleration_steps_per_s2),
    jerk: largest(motion.jerk_steps_per_s3),
  };
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
    isHigh: isBeyond(errors[design.method.name]?.peak_ramp_acceleration_steps_per_s2?.value ?? 0, design),
  };
}

/** Whether the ramp itself, before its intervals are rounded to ticks, asks for more than is bearable.
 * @param {number} peak [steps/s²] of the ramp; negative while it slows down @param {Design} design */
function isBeyond(peak, { ramp }) {
  const { acceleration_steps_per_s2: up, deceleration_steps_per_s2: down } = ramp;
  return Math.abs(peak) > BEARABLE * Number(peak < 0 ? (down ?? up) : up);
}

/** @param {Answer} answer @returns {Figure} */
function landing(answer) {
  const speed = answer.errors[answer.design.method.name]?.landing_error_steps_per_s;
  if (speed === undefined) return { value: '–', unit: '', more: '', isHigh: false };
  const shown = shownValue(unitsOf(answer), answer.design, 'speed', speed);
  const unit = unitWord(unitsOf(answer), answer.design, 'speed');
  return { value: formatSigned(shown), unit, more: 'against base speed', isHigh: false };
}

/** @param {number} value */
function formatSigned(value) {
  return value > 0 ? `+${formatSpeed(value)}` : formatSpeed(value);
}

/** @param {Design} design */
function stepsPerRev({ axis }) {
  return Number(axis.full_steps_per_rev) * Number(axis.microsteps);
}
