// @ts-check
// What lies over the figure: titles, phases, the cursor with its tooltip, and the dot of a move that runs.

import { element, icon, svgElement } from '../../ui/dom.js';
import { xPixel, yPixel } from '../../plotting/frame.js';
import { drawingOrder, FEWEST_JOINED, PARTS } from '../../plotting/lines.js';
import { formatReading, isOfMotion, PLOTS, plotsShowing } from '../../plotting/plots.js';
import { methodOf } from '../../model/methods.js';
import { formatFigures, formatFixed } from '../../model/numbers.js';
import { lineSwatch, methodSwatch } from '../../ui/swatch.js';

/** @typedef {import('../../plotting/curves.js').MethodReading} MethodReading */
/** @typedef {import('../../plotting/curves.js').Reading} Reading */
/** @typedef {import('../../plotting/curves.js').MeasuredReading} MeasuredReading */
/** @typedef {{label: string, colour: string, reading: MeasuredReading}} MeasuredRow */
/** @typedef {import('../../plotting/curves.js').AxesReading} AxesReading */
/** @typedef {import('../../plotting/frame.js').Frame} Frame */
/** @typedef {import('../../plotting/frame.js').PlotName} PlotName */
/** @typedef {import('../../plotting/frame.js').Third} Third */
/** @typedef {import('../../model/types.js').MethodName} MethodName */

const PHASE_WORDS = /** @type {Record<string, string>} */ ({
  accelerate: 'Accelerate',
  slew: 'Slew',
  decelerate: 'Decelerate',
});
const PART_WORDS = { method: 'Method', arithmetic: 'Arithmetic', rounding: 'Rounding', compression: 'Segments' };
const TOOLTIP_GAP = 14;

const PERCENT_DIGITS = 2;

/** @param {Partial<Record<PlotName, HTMLElement>>} tools what can be switched at a plot's title */
export function createOverlay(tools) {
  const titles = PLOTS.map(({ name }) => {
    const heading = element('b');
    const unit = element('span');
    const key = element('span', { className: 'part-key', 'aria-hidden': 'true' });
    const reading = element('span', { className: 'reading' });
    // Without curves it has no place yet.
    const title = element('div', { className: 'plot-title', hidden: true }, heading, unit, tools[name], key, reading);
    return { name, heading, unit, key, reading, element: title };
  });
  titles[titles.length - 1].key.append(...PARTS.map(([part, dash]) => partKey(part, dash)));
  const phases = element('div', { className: 'phases' });
  const cursor = svgElement('g');
  const dot = svgElement('circle', { class: 'moving-dot', r: 5, visibility: 'hidden' });
  const run = svgElement('path', { class: 'moving-line', fill: 'none' });
  const drawing = svgElement('svg', { class: 'overlay', 'aria-hidden': 'true' });
  const tooltip = element('div', { className: 'tooltip', hidden: true });
  const reason = element('span');
  const remedy = element('span');
  const note = element(
    'div',
    { className: 'stale-note', role: 'status', hidden: true },
    icon('warning'),
    element('span', {}, reason, remedy),
  );
  const awaited = element('p', { className: 'awaited-note', role: 'status', hidden: true, textContent: 'Computing…' });
  let shownPhases = '';
  drawing.append(run, cursor, dot);

  /** @param {Frame} frame @param {Third} third */
  function place(frame, third) {
    for (const { name, heading, unit, key, element: title } of titles) {
      const plot = frame.plots.find((one) => one.name === name);
      title.hidden = !plot?.isVisible;
      if (!plot) continue;
      setText(heading, plot.title);
      setText(unit, plot.unit);
      key.hidden = name !== 'error' || third !== 'parts';
      // The topmost visible plot has the phases between its title and itself.
      const above = plot.top === frame.top ? 39 : 21;
      Object.assign(title.style, { left: `${frame.left}px`, width: `${frame.width}px`, top: `${plot.top - above}px` });
    }
    const present = JSON.stringify([frame.phases, frame.x, frame.left, frame.width, frame.top]);
    if (present !== shownPhases) phases.replaceChildren(...frame.phases.map((phase) => phaseBar(frame, phase)));
    shownPhases = present;
  }

  /** @param {Frame} frame @param {number} x */
  function drawCursor(frame, x) {
    const y2 = Math.max(...frame.plots.filter((plot) => plot.isVisible).map((plot) => plot.top + plot.height));
    cursor.append(svgElement('line', { class: 'cursor', x1: x, x2: x, y1: frame.top, y2 }));
  }

  /** @param {Frame} frame @param {PlotName} name @param {number} x @param {number} value @param {string} colour */
  function drawDot(frame, name, x, value, colour) {
    const plot = frame.plots.find((one) => one.name === name);
    if (!plot?.isVisible || !Number.isFinite(value)) return;
    const cy = yPixel(plot, value);
    if (!(cy >= plot.top - 1 && cy <= plot.top + plot.height + 1)) return;
    cursor.append(svgElement('circle', { class: 'cursor-dot', r: 3, cx: x, cy, style: `fill: ${colour}` }));
  }

  /** @param {Frame} frame @param {number} x @param {HTMLElement} table */
  function showTooltip(frame, x, table) {
    tooltip.replaceChildren(table);
    tooltip.hidden = false;
    // Of the one plot of a narrow window it would hide most: there it lies beneath.
    const isBeneath = frame.plots[1].top === frame.top;
    const isRight = x + TOOLTIP_GAP + tooltip.offsetWidth > frame.left + frame.width;
    const beside = isRight ? x - TOOLTIP_GAP - tooltip.offsetWidth : x + TOOLTIP_GAP;
    tooltip.classList.toggle('beneath', isBeneath);
    // Where neither side has room for it, it covers the cursor rather than leave the page.
    tooltip.style.left = isBeneath ? '' : `${Math.max(0, beside)}px`;
    tooltip.style.top = isBeneath ? '' : `${frame.plots[1].top + 8}px`;
  }

  function clear() {
    cursor.replaceChildren();
    tooltip.hidden = true;
    for (const { reading } of titles) reading.replaceChildren();
  }

  return {
    elements: [...titles.map((title) => title.element), phases, drawing, tooltip, note, awaited],
    place,
    clear,
    /** @param {Frame} frame @param {Reading} at @param {MethodName} active @param {ReadonlySet<MethodName>} shown
     * @param {Third} third @param {MeasuredRow[]} measured */
    read(frame, at, active, shown, third, measured) {
      clear();
      const x = xPixel(frame, at.x);
      drawCursor(frame, x);
      const visible = at.methods.filter((one) => shown.has(one.method));
      const drawn = drawingOrder(active).flatMap((name) => visible.filter((one) => one.method === name));
      const plots = plotsShowing(third).filter(({ name }) => name !== 'error' || third === 'error' || isOfMotion(third));
      for (const { name, read } of plots)
        for (const one of drawn) drawDot(frame, name, x, read(one), `var(--method-${one.method})`);
      const own = at.methods.find((one) => one.method === active);
      for (const { name, reading } of titles) {
        const plot = plots.find((one) => one.name === name);
        if (!own || !plot) continue;
        const value = plot.read(own);
        const text = plot.readingText(value);
        if (Number.isFinite(value)) reading.append(`${methodOf(active).label} `, element('b', { textContent: text }));
      }
      showTooltip(frame, x, readingTable(at, visible, measured, frame.plots[0].unit));
    },
    /** @param {Frame} frame @param {AxesReading} at */
    readAxes(frame, at) {
      clear();
      const x = xPixel(frame, at.x);
      drawCursor(frame, x);
      for (const axis of at.axes) {
        drawDot(frame, 'velocity', x, axis.velocity, `var(--axis-${axis.colour})`);
        drawDot(frame, 'delay', x, axis.delay, `var(--axis-${axis.colour})`);
      }
      showTooltip(frame, x, axesTable(at, frame.plots[0].unit));
    },
    /** The dot of a move that runs, and its line so far: drawn here, many times a second, without Plotly.
     * @param {Frame} frame @param {{x: number, speed: number, isOld: boolean} | null} at
     * @param {{x: number[], velocity: number[]} | null} live */
    showMove(frame, at, live) {
      const velocity = frame.plots[0];
      run.setAttribute('d', live && live.x.length >= FEWEST_JOINED && velocity.isVisible ? linePath(frame, velocity, live) : '');
      const x = at ? xPixel(frame, at.x) : NaN;
      const isInside = velocity.isVisible && x >= frame.left - 1 && x <= frame.left + frame.width + 1;
      dot.setAttribute('visibility', at && isInside ? 'visible' : 'hidden');
      if (!at || !isInside) return;
      dot.classList.toggle('old', at.isOld);
      const { low, high } = velocity.range;
      dot.setAttribute('cx', String(x));
      dot.setAttribute('cy', String(yPixel(velocity, Math.max(low, Math.min(at.speed, high)))));
    },
    /** @param {import('../../model/types.js').Staleness} staleness @param {boolean} areDrawn whether there are curves */
    showStale(staleness, areDrawn) {
      const isAwaited = staleness === 'awaited';
      awaited.hidden = !isAwaited || areDrawn;
      note.hidden = staleness === null || isAwaited;
      note.classList.toggle('alone', !areDrawn);
      remedy.classList.toggle('not-short', areDrawn);
      const words = staleness === 'unanswered' ? 'Earlier values' : 'Last valid values';
      reason.textContent = areDrawn ? words : 'No curves yet';
      remedy.textContent = staleness === 'unanswered' ? ': the server can’t be asked now' : ': correct what is marked';
    },
  };
}

/** @param {HTMLElement} box @param {string} text */
function setText(box, text) {
  if (box.textContent !== text) box.textContent = text;
}

/** @param {import('../../plotting/curves.js').ErrorPart} part @param {string} dash */
function partKey(part, dash) {
  const drawing = svgElement('svg', { class: 'swatch', viewBox: '0 0 18 8' });
  const style = `stroke: var(--part-${part}); stroke-dasharray: ${dash === 'solid' ? 'none' : dash}`;
  drawing.append(svgElement('line', { x1: 0, y1: 4, x2: 18, y2: 4, 'stroke-width': 2.5, style }));
  return element('span', {}, drawing, PART_WORDS[part]);
}

/** @param {Frame} frame @param {Frame['phases'][0]} phase */
function phaseBar(frame, phase) {
  const inside = (/** @type {number} */ x) =>
    Math.min(frame.left + frame.width, Math.max(frame.left, frame.x.isLog && x <= 1 ? frame.left : xPixel(frame, x)));
  const [from, to] = [inside(phase.from), inside(phase.to)].sort((a, b) => a - b);
  const width = Math.max(0, to - from - 2);
  const bar = element('div', { className: `phase ${phase.name}`, 'data-phase': phase.name });
  Object.assign(bar.style, { left: `${from + 1}px`, width: `${width}px`, top: `${frame.top - 20}px` });
  if (width > 62) bar.append(element('b', { textContent: PHASE_WORDS[phase.name] }));
  if (width > 124) bar.append(` ${formatFixed(phase.steps)} steps`);
  return bar;
}

/** @param {string} text */
const cell = (text) => element('td', { textContent: text });

/** What of a line lies within a plot, as a path.
 * @param {Frame} frame @param {import('../../plotting/frame.js').PlotFrame} plot @param {{x: number[], velocity: number[]}} line */
function linePath(frame, plot, { x, velocity }) {
  const { low, high } = plot.range;
  const points = x.flatMap((value, index) => {
    const across = xPixel(frame, value);
    const isInside = across >= frame.left && across <= frame.left + frame.width && Number.isFinite(velocity[index]);
    return isInside ? [`${across.toFixed(1)},${yPixel(plot, Math.max(low, Math.min(velocity[index], high))).toFixed(1)}`] : [];
  });
  return points.length === 0 ? '' : `M${points.join('L')}`;
}

/** @param {Reading} at @param {MethodReading[]} methods @param {MeasuredRow[]} measured @param {string} speedUnit */
function readingTable(at, methods, measured, speedUnit) {
  const rows = methods.map((one) => {
    const about = one.isExact ? '' : '≈ ';
    return element(
      'tr',
      {},
      element('td', {}, methodSwatch(one.method), methodOf(one.method).label),
      cell(about + formatFixed(one.ticks)),
      cell(formatFixed(one.delay_us, 1)),
      cell(formatReading(one.shownSpeed)),
      cell(Number.isFinite(one.percent) ? `${formatFixed(one.percent, PERCENT_DIGITS)} %` : ''),
    );
  });
  return element(
    'table',
    {},
    element(
      'tr',
      {},
      element('th', { colSpan: 2, textContent: `Step ${formatFixed(at.step)}` }),
      element('th', { colSpan: 3, textContent: `${formatFixed(at.time_s * 1e3, 2)} ms` }),
    ),
    element('tr', { className: 'head' }, cell(''), cell('ticks'), cell('µs'), cell(speedUnit), cell('error')),
    ...rows,
    ...measured.map(measuredRow),
  );
}

/** How much later than planned stands where methods have their errors.
 * @param {MeasuredRow} row */
function measuredRow({ label, colour, reading: { delay_us, shownSpeed, deviation_us } }) {
  const late = Number.isFinite(deviation_us) ? `${deviation_us > 0 ? '+' : ''}${formatFixed(deviation_us, 1)} µs` : '';
  return element(
    'tr',
    { className: 'measured' },
    element('td', {}, lineSwatch(colour), label),
    cell(''),
    cell(Number.isFinite(delay_us) ? formatFixed(delay_us, 1) : ''),
    cell(Number.isFinite(shownSpeed) ? formatReading(shownSpeed) : ''),
    cell(late),
  );
}

/** @param {AxesReading} at @param {string} speedUnit */
function axesTable(at, speedUnit) {
  const rows = at.axes.map(({ label, colour, velocity, delay }) => {
    const swatch = element('i', { className: 'axis-swatch', style: `background: var(--axis-${colour})` });
    return element(
      'tr',
      {},
      element('td', {}, swatch, label),
      cell(formatReading(delay)),
      cell(formatReading(velocity)),
    );
  });
  return element(
    'table',
    {},
    element('tr', {}, element('th', { colSpan: 3, textContent: `${formatFixed(at.x * 1e3, 2)} ms` })),
    element('tr', { className: 'head' }, cell(''), cell('µs'), cell(speedUnit)),
    ...rows,
  );
}
