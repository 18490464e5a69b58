// @ts-check
// What lies over the figure: titles, phases, the cursor with its tooltip, and the dot of a move that runs.

import { element, icon, svgElement } from '../../dom.js';
import { drawingOrder } from '../../figure.js';
import { PLOTS, xPixel, yPixel } from '../../frame.js';
import { methodOf } from '../../methods.js';
import { formatFixed } from '../../numbers.js';
import { methodSwatch } from '../../swatch.js';

/** @typedef {import('../../curves.js').MethodReading} MethodReading */
/** @typedef {import('../../curves.js').Reading} Reading */
/** @typedef {import('../../frame.js').Frame} Frame */
/** @typedef {import('../../types.js').MethodName} MethodName */

const PHASE_WORDS = /** @type {Record<string, string>} */ ({
  accelerate: 'Accelerate',
  slew: 'Slew',
  decelerate: 'Decelerate',
});
const TOOLTIP_GAP = 14;

/** What each plot shows of a reading. @type {Record<string, {value: (at: MethodReading) => number, digits: number}>} */
const READ = {
  velocity: { value: (at) => at.speed, digits: 1 },
  delay: { value: (at) => at.delay_us, digits: 1 },
  error: { value: (at) => at.percent, digits: 2 },
};

export function createOverlay() {
  const titles = PLOTS.map((plot) => {
    const reading = element('span', { className: 'reading' });
    return {
      name: plot.name,
      reading,
      element: element(
        'div',
        { className: 'plot-title' },
        element('b', { textContent: plot.title }),
        plot.unit,
        reading,
      ),
    };
  });
  const phases = element('div', { className: 'phases' });
  const cursor = svgElement('g');
  const dot = svgElement('circle', { class: 'moving-dot', r: 5, visibility: 'hidden' });
  const drawing = svgElement('svg', { class: 'overlay', 'aria-hidden': 'true' });
  const tooltip = element('div', { className: 'tooltip', hidden: true });
  const reason = element('span');
  const remedy = element('span', { className: 'not-phone' });
  const note = element(
    'div',
    { className: 'stale-note', role: 'status', hidden: true },
    icon('warning'),
    element('span', {}, reason, remedy),
  );
  drawing.append(cursor, dot);

  /** @param {Frame} frame */
  function place(frame) {
    for (const { name, element: title } of titles) {
      const plot = frame.plots.find((one) => one.name === name);
      title.hidden = !plot?.isVisible;
      if (!plot) continue;
      // The topmost visible plot has the phases between its title and itself.
      const above = plot.top === frame.top ? 39 : 21;
      Object.assign(title.style, { left: `${frame.left}px`, width: `${frame.width}px`, top: `${plot.top - above}px` });
    }
    phases.replaceChildren(...frame.phases.map((phase) => phaseBar(frame, phase)));
  }

  /** @param {Frame} frame @param {Reading | null} at @param {MethodName} active @param {ReadonlySet<MethodName>} shown */
  function read(frame, at, active, shown) {
    cursor.replaceChildren();
    tooltip.hidden = at === null;
    for (const { reading } of titles) reading.replaceChildren();
    if (at === null) return;
    const x = xPixel(frame, at.x);
    cursor.append(
      svgElement('line', {
        class: 'cursor',
        x1: x,
        x2: x,
        y1: frame.top,
        y2: Math.max(...frame.plots.map((plot) => plot.top + plot.height)),
      }),
    );
    const visible = at.methods.filter((one) => shown.has(one.method));
    const drawn = drawingOrder(active).flatMap((name) => visible.filter((one) => one.method === name));
    for (const plot of frame.plots.filter((one) => one.isVisible)) {
      for (const one of drawn) {
        const value = READ[plot.name].value(one);
        if (Number.isFinite(value))
          cursor.append(
            svgElement('circle', {
              class: 'cursor-dot',
              r: 3,
              cx: x,
              cy: yPixel(plot, value),
              style: `fill: var(--method-${one.method})`,
            }),
          );
      }
    }
    const own = at.methods.find((one) => one.method === active);
    for (const { name, reading } of titles) {
      const { value, digits } = READ[name];
      if (own && Number.isFinite(value(own)))
        reading.replaceChildren(
          `${methodOf(active).label} `,
          element('b', { textContent: formatFixed(value(own), digits) }),
        );
    }
    tooltip.replaceChildren(readingTable(at, visible));
    const isRight = x + TOOLTIP_GAP + tooltip.offsetWidth > frame.left + frame.width;
    Object.assign(tooltip.style, {
      // Where neither side has room for it, it covers the cursor rather than leave the page.
      left: `${Math.max(0, isRight ? x - TOOLTIP_GAP - tooltip.offsetWidth : x + TOOLTIP_GAP)}px`,
      top: `${(frame.plots[1].top === frame.top ? frame.top : frame.plots[1].top) + 8}px`,
    });
  }

  return {
    elements: [...titles.map((title) => title.element), phases, drawing, tooltip, note],
    place,
    read,
    /** @param {Frame} frame @param {{x: number, speed: number} | null} at */
    showMove(frame, at) {
      const velocity = frame.plots[0];
      const x = at ? xPixel(frame, at.x) : NaN;
      const isInside = velocity.isVisible && x >= frame.left - 1 && x <= frame.left + frame.width + 1;
      dot.setAttribute('visibility', at && isInside ? 'visible' : 'hidden');
      if (!at || !isInside) return;
      dot.setAttribute('cx', String(x));
      dot.setAttribute('cy', String(yPixel(velocity, Math.min(at.speed, velocity.range.high))));
    },
    /** @param {import('../../types.js').Staleness} staleness */
    showStale(staleness) {
      note.hidden = staleness === null;
      reason.textContent = staleness === 'unanswered' ? 'Earlier values' : 'Last valid values';
      remedy.textContent = staleness === 'unanswered' ? ': the server does not answer' : ': correct what is marked';
    },
  };
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

/** @param {Reading} at @param {MethodReading[]} methods */
function readingTable(at, methods) {
  const cell = (/** @type {string} */ text) => element('td', { textContent: text });
  const rows = methods.map((one) => {
    const about = one.isExact ? '' : '≈ ';
    return element(
      'tr',
      {},
      element('td', {}, methodSwatch(one.method), methodOf(one.method).label),
      cell(about + formatFixed(one.ticks)),
      cell(formatFixed(one.delay_us, 1)),
      cell(formatFixed(one.speed, 1)),
      cell(Number.isFinite(one.percent) ? `${formatFixed(one.percent, 2)} %` : ''),
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
    element('tr', { className: 'head' }, cell(''), cell('ticks'), cell('µs'), cell('steps/s'), cell('error')),
    ...rows,
  );
}
