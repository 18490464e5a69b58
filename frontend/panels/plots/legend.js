// @ts-check
// The legend: one switch a method, with its largest error, and what was measured.

import { quoted } from '../../model/quoted.js';
import { shapeOf } from '../../model/shapes.js';
import { element, icon, showText } from '../../ui/dom.js';
import { deviationText, markedStepsText, MARKS } from '../../plotting/captured.js';
import { BESIDE_DASHES } from '../../plotting/lines.js';
import { METHODS, REFERENCE } from '../../model/methods.js';
import { formatFixed, formatSignedPercent } from '../../model/numbers.js';
import { lineSwatch, methodSwatch } from '../../ui/swatch.js';
import { watchStrip } from '../../ui/strip.js';

/** @typedef {import('../../model/types.js').Answer} Answer */
/** @typedef {import('../../model/types.js').MethodName} MethodName */

/** @param {(name: MethodName) => void} onSwitch @param {() => void} onOwn @param {{onOpen: () => void, onRemove: () => void}} capture
 * @param {(key: string) => void} onTakeAway of what is laid beside @param {() => void} onTakeTrace */
export function createLegend(onSwitch, onOwn, { onOpen, onRemove }, onTakeAway, onTakeTrace) {
  const chips = METHODS.map(({ name, label, plays_table: playsTable }) => {
    const figure = element('em');
    const chip = element(
      'button',
      { className: 'chip', type: 'button', 'data-method': name, onclick: () => onSwitch(name) },
      methodSwatch(name),
      element('span', { textContent: label }),
      figure,
    );
    return { name, label, playsTable, chip, figure };
  });
  const traceFigure = element('em');
  const traceRemoval = { className: 'remove', id: 'remove-trace', type: 'button', title: 'Remove the trace', 'aria-label': 'Remove the trace' };
  const removeTrace = element('button', { ...traceRemoval, onclick: onTakeTrace }, icon('remove'));
  const trace = element(
    'span',
    { className: 'chip trace', hidden: true },
    lineSwatch('--measured'),
    element('span', { textContent: 'Trace' }),
    traceFigure,
    removeTrace,
  );
  const [ownLabel, ownFigure] = [element('span', { textContent: 'As the controller plays it' }), element('em')];
  const own = element(
    'button',
    { className: 'chip', id: 'own-chip', type: 'button', hidden: true, onclick: onOwn },
    lineSwatch('--own', '6 2'),
    ownLabel,
    ownFigure,
  );
  const captureFigure = element('em');
  const captureChip = element(
    'button',
    { className: 'chip', id: 'capture-chip', type: 'button', onclick: onOpen },
    lineSwatch('--capture'),
    element('span', { textContent: 'Capture' }),
    captureFigure,
  );
  /** @type {{isOfAnother: boolean, isLonger: boolean, record?: string}} */
  let told = { isOfAnother: false, isLonger: false };
  function tellTrace() {
    const { isOfAnother, isLonger, record } = told;
    showText(traceFigure, isLonger ? 'longer than planned' : isOfAnother ? 'of another ramp' : '');
    const words = record ? `${record}, from the library` : 'What the controller measured of the last move';
    trace.title = isLonger
      ? 'The move that runs is longer than the plotted one, which has no place for its middle'
      : isOfAnother
        ? `${words}. It is not known to have followed the ramp that is plotted: the design has changed since, or was pushed before.`
        : words;
  }
  const removal = { className: 'chip', id: 'remove-capture', type: 'button', title: 'Remove the capture', 'aria-label': 'Remove the capture' };
  const capture = element(
    'span',
    { className: 'capture-chip', hidden: true },
    captureChip,
    element('button', { ...removal, onclick: onRemove }, icon('remove')),
  );
  const beside = element('span', { className: 'beside-chips', hidden: true });
  const legend = element(
    'div',
    { className: 'legend strip', role: 'group', 'aria-label': 'Methods shown' },
    ...chips.map(({ chip }) => chip),
    own,
    trace,
    capture,
    beside,
  );
  watchStrip(legend);
  return {
    element: legend,
    /** isTraced: whether there is a trace among the lines. isOfAnother: whether it is not known to be of the ramp that is plotted.
     * isRunning: whether it is still growing. record: see MeasuredMove.
     * @param {{isTraced: boolean, isOfAnother: boolean, isRunning: boolean, record?: string}} now */
    showTrace({ isTraced, isOfAnother, isRunning, record }) {
      trace.hidden = !isTraced;
      removeTrace.hidden = isRunning;
      told = { ...told, isOfAnother, record };
      tellTrace();
    },
    /** @param {boolean} isLonger whether a move runs that is longer than the plotted one, and faster than that ever gets */
    showLonger(isLonger) {
      if (isLonger === told.isLonger) return;
      told = { ...told, isLonger };
      tellTrace();
    },
    /** @param {import('../../model/types.js').OwnRamp | null} ramp what the controller in view plays itself
     * @param {string} family its title @param {boolean} isShown */
    showOwn(ramp, family, isShown) {
      own.hidden = ramp === null;
      if (ramp === null) return;
      showText(ownLabel, `As ${family} plays it`);
      showText(ownFigure, `${formatSignedPercent(ramp.max_relative_error)} %`);
      own.setAttribute('aria-pressed', String(isShown));
      const longer = ramp.duration_s - ramp.planned_duration_s;
      const lasts = `${formatFixed(Math.abs(longer) * 1000, 1)} ms ${longer < 0 ? 'shorter' : 'longer'} than planned`;
      own.title = `${isShown ? 'Hide' : 'Show'} what ${family} works out itself; largest error at step ${ramp.max_error_step}, the move is ${lasts}`;
    },
    /** @param {import('../../plotting/captured.js').ShownCapture | null} shown */
    showCapture(shown) {
      capture.hidden = shown === null;
      if (shown === null) return;
      const [text, words] = captureTexts(shown);
      showText(captureFigure, text);
      captureChip.title = `What a logic analyser measured: ${words}`;
    },
    /** @param {import('../../app/state.js').State['library']['beside']} laid revisions of the library that are laid beside */
    showBeside(laid) {
      beside.hidden = laid.length === 0;
      beside.replaceChildren(...laid.map(({ key, label }, index) => besideChip(label, BESIDE_DASHES[index], () => onTakeAway(key))));
    },
    /** @param {Answer | null} answer @param {ReadonlySet<MethodName>} shown @param {MethodName} active */
    show(answer, shown, active) {
      for (const { name, label, playsTable, chip, figure } of chips) {
        const largest = answer?.errors[name]?.largest_relative_error;
        const failure = answer?.failures[name];
        const shape = answer && shapeOf(answer.design);
        const isForOthers = shape !== null && !shape.methods.includes(name);
        const isEmpty = answer !== null && playsTable && answer.design.table === null;
        chip.setAttribute('aria-pressed', String(shown.has(name)));
        chip.dataset.active = String(name === active);
        const text =
          name === REFERENCE
            ? 'reference'
            : isEmpty
              ? 'no rows'
              : isForOthers
                ? 'constant a'
                : failure
                  ? 'fails'
                  : largest
                    ? `${formatSignedPercent(largest.value)} %`
                    : '';
        const title =
          failure ??
          (isForOthers ? `${label} is for constant acceleration only: this ramp’s shape is ${shape.label}` : null) ??
          `${shown.has(name) ? 'Hide' : 'Show'} ${label}${largest ? `; largest error at step ${largest.step}` : ''}`;
        // While a slider moves this comes many times a second: what stays the same is left alone.
        if (figure.textContent !== text) figure.textContent = text;
        if (chip.title !== title) chip.title = title;
      }
    },
  };
}

/** @param {string} label of a revision @param {string} dash of its line @param {() => void} onclick */
function besideChip(label, dash, onclick) {
  const removal = `Unpin ${quoted(label)}`;
  return element(
    'span',
    { className: 'chip beside', title: `Pinned from the library: ${label}` },
    lineSwatch('--pinned', dash),
    element('span', { textContent: label }),
    element('button', { className: 'remove', type: 'button', title: removal, 'aria-label': removal, onclick }, icon('remove')),
  );
}

/** What is wrong with the steps, or else how far they are off: in signs, and in words.
 * @param {import('../../plotting/captured.js').ShownCapture} shown @returns {[string, string]} */
function captureTexts({ move, isStale }) {
  if (isStale) return ['…', 'held against an earlier design'];
  const { deviation, short_pulses: short } = move;
  const all = { missing: deviation?.missing, extra: deviation?.extra, short };
  const wrong = Object.entries(all).flatMap(([name, steps]) => {
    const mark = /** @type {keyof typeof MARKS} */ (name);
    const { sign, word } = MARKS[mark];
    if (!steps?.count) return [];
    const count = formatFixed(steps.count);
    return [{ text: `${sign} ${count}`, words: `${count} ${word} (${markedStepsText(mark, steps)})` }];
  });
  if (wrong.length > 0) return [wrong.map(({ text }) => text).join('  '), wrong.map(({ words }) => words).join(', ')];
  const largest = deviation ? deviationText(deviation.figures.largest_us) : '';
  return [largest, `largest deviation ${largest}`];
}
