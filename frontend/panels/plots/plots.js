// @ts-check
// The three plots in one figure, with zoom, views and cursor.

import { activeProfile, curveOf, interpolate, plottedStep, readingAt } from '../../curves.js';
import { element } from '../../dom.js';
import { figureOf } from '../../figure.js';
import { xPixel, xValue, zoomedAbout } from '../../frame.js';
import { METHODS, REFERENCE } from '../../methods.js';
import { token } from '../../theme.js';
import { createLegend } from './legend.js';
import { createOverlay } from './overlay.js';
import { createViewBar } from './view_bar.js';

/** @typedef {import('../../types.js').Answer} Answer */
/** @typedef {import('../../types.js').MethodName} MethodName */
/** @typedef {import('../../curves.js').Reading} Reading */

// Scroll to zoom and double click are ours: Plotly's would not know the limits of the view.
const PLOTLY_OPTIONS = { displayModeBar: false, responsive: false, doubleClick: false, scrollZoom: false };
const ZOOM_PER_PIXEL = 0.0015;
const COMPACT = matchMedia('(max-width: 700px)');

/**
 * @param {HTMLElement} root
 * @param {ReadonlySet<MethodName>} shown the methods to draw, as they are at each drawing
 * @param {{onSwitch: (name: MethodName) => void, onReading: (reading: Reading | null) => void}} handlers
 */
export function createPlots(root, shown, handlers) {
  const view = {
    axis: /** @type {import('../../curves.js').AxisName} */ ('step'),
    view: /** @type {import('../../frame.js').ViewName} */ ('whole'),
    only: /** @type {import('../../frame.js').PlotName} */ ('velocity'),
    zoom: /** @type {[number, number] | null} */ (null),
    moving: false,
  };
  /** @type {Answer | null} */
  let answer = null;
  /** @type {Partial<Record<MethodName, import('../../curves.js').Curve>>} */
  let curves = {};
  /** @type {import('../../frame.js').Frame | null} */
  let frame = null;
  /** @type {{done: number, remaining: number, speed: number} | null} */
  let move = null;
  /** @type {Reading | null} */
  let reading = null;
  /** Where the pointer is, in pixels of the figure; null: not over it. @type {number | null} */
  let pointer = null;
  let awaitedFrame = 0;
  /** @type {any} */
  let Plotly = null;

  const bar = createViewBar({
    onAxis: (axis) => look({ axis, zoom: null }),
    onView: (name) => look({ view: name, zoom: null }),
    onPlot: (only) => look({ only }),
  });
  const legend = createLegend(handlers.onSwitch);
  const overlay = createOverlay();
  const figure = /** @type {any} */ (element('div', { className: 'figure' }));
  const scope = element(
    'div',
    {
      className: 'scope',
      tabIndex: 0,
      role: 'group',
      'aria-label': 'Plots of velocity, delay and error. Arrow keys move the cursor, plus and minus zoom, 0 shows all.',
      onpointermove: pointed,
      onpointerdown: pointed,
      onpointerleave: left,
      onkeydown: walked,
    },
    figure,
    ...overlay.elements,
  );
  scope.addEventListener('wheel', scrolled, { passive: false });
  root.replaceChildren(bar.element, legend.element, scope);
  bar.show(view.axis, view.view, view.only);
  legend.show(null, shown, REFERENCE);

  new ResizeObserver(redraw).observe(scope);
  COMPACT.addEventListener('change', redraw);
  plotly().then((loaded) => {
    Plotly = loaded;
    if (Plotly) redraw();
    else
      scope.replaceChildren(
        element('p', {
          className: 'empty',
          textContent: 'The plots can’t be drawn: plotly.min.js did not load. Everything else works.',
        }),
      );
  });

  /** @param {Partial<typeof view>} change */
  function look(change) {
    Object.assign(view, change);
    bar.show(view.axis, view.view, view.only);
    updateCurves();
    redraw();
  }

  function updateCurves() {
    curves = {};
    if (answer === null) return;
    for (const { name } of METHODS) {
      const curve = curveOf(answer, name, view.axis);
      if (curve) curves[name] = curve;
    }
  }

  function redraw() {
    if (awaitedFrame === 0) awaitedFrame = requestAnimationFrame(draw);
  }

  async function draw() {
    awaitedFrame = 0;
    const size = { width: scope.clientWidth, height: scope.clientHeight };
    if (!answer || !Plotly || size.width === 0 || size.height === 0) return;
    const isFirst = frame === null;
    const made = figureOf({
      ...view,
      answer,
      curves,
      shown,
      size,
      compact: COMPACT.matches,
      colours: colours(),
      dashes: dashes(),
      font: token('--font'),
    });
    frame = made.frame;
    await Plotly.react(figure, made.traces, made.layout, PLOTLY_OPTIONS);
    if (isFirst) listen();
    overlay.place(frame);
    legend.show(answer, shown, answer.design.method.name);
    readAgain();
    showMove();
  }

  function listen() {
    figure.on('plotly_relayout', (/** @type {Record<string, number>} */ change) => {
      const [low, high] = [change['xaxis.range[0]'], change['xaxis.range[1]']];
      if (low === undefined || !frame) return;
      const values = frame.x.isLog ? [10 ** low, 10 ** high] : [low, high];
      look({ zoom: [Math.max(frame.full.low, Math.min(...values)), Math.min(frame.full.high, Math.max(...values))] });
    });
    figure.on('plotly_doubleclick', () => look({ zoom: null }));
  }

  /** @param {Reading | null} at */
  function read(at) {
    if (at === null && reading === null) return;
    reading = at;
    if (frame && answer) overlay.read(frame, at, answer.design.method.name, shown);
    handlers.onReading(at);
  }

  /** @param {PointerEvent} event */
  function pointed(event) {
    pointer = event.clientX - scope.getBoundingClientRect().left;
    readAgain();
  }

  function left() {
    pointer = null;
    read(null);
  }

  /** Read what is under the pointer, or else where the keys left the cursor. */
  function readAgain() {
    if (!frame || !answer) return;
    const x = pointer === null ? reading?.x : xValue(frame, pointer);
    const isInside = x !== undefined && x >= frame.x.low && x <= frame.x.high;
    read(isInside ? readingAt(curves, answer.design.method.name, x) : null);
  }

  /** @param {WheelEvent} event */
  function scrolled(event) {
    if (!frame) return;
    event.preventDefault();
    zoomBy(Math.exp(event.deltaY * ZOOM_PER_PIXEL), event.clientX - scope.getBoundingClientRect().left);
  }

  /** @param {number} factor @param {number} pixel */
  function zoomBy(factor, pixel) {
    if (frame)
      look({ zoom: zoomedAbout(frame, Math.min(frame.left + frame.width, Math.max(frame.left, pixel)), factor) });
  }

  /** @param {KeyboardEvent} event */
  function walked(event) {
    if (!frame || !answer) return;
    const middle = frame.left + frame.width / 2;
    const at = reading ? xPixel(frame, reading.x) : middle;
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (by !== undefined) walk(by * (event.shiftKey ? 10 : 1));
    else if (event.key === '+' || event.key === '=') zoomBy(0.7, at);
    else if (event.key === '-') zoomBy(1 / 0.7, at);
    else if (event.key === '0' || event.key === 'Home') look({ zoom: null });
    else return;
    event.preventDefault();
  }

  /** Move the cursor along the computed steps. @param {number} by */
  function walk(by) {
    pointer = null;
    const active = /** @type {Answer} */ (answer).design.method.name;
    const steps = curves[active];
    if (!steps || !frame) return;
    const index = reading
      ? steps.step.indexOf(reading.step) + by
      : steps.x.findIndex((x) => x >= /** @type {NonNullable<typeof frame>} */ (frame).x.low);
    read(readingAt(curves, active, steps.x[Math.min(steps.x.length - 1, Math.max(0, index))]));
  }

  function showMove() {
    if (!frame || !answer) return;
    const curve = curves[answer.design.method.name];
    if (!move || !curve) {
      overlay.showMove(frame, null);
      return;
    }
    const step = Math.max(1, plottedStep(activeProfile(answer), move.done, move.remaining));
    overlay.showMove(frame, { x: interpolate(curve.step, curve.x, step), speed: move.speed });
  }

  return {
    /** @param {Answer} newest */
    show(newest) {
      answer = newest;
      updateCurves();
      // Drawn at once and not with the next frame: while a slider moves, every millisecond is felt.
      cancelAnimationFrame(awaitedFrame);
      draw();
    },
    /** @param {import('../../types.js').Staleness} staleness why the curves belong to earlier values */
    showStale(staleness) {
      root.classList.toggle('stale', staleness !== null);
      overlay.showStale(answer === null ? null : staleness);
    },
    /** @param {boolean} isMoving while a slider moves, lines are drawn with fewer points */
    showSliding(isMoving) {
      if (view.moving === isMoving) return;
      view.moving = isMoving;
      if (!isMoving) redraw();
    },
    /** @param {typeof move} present the move that runs, in steps since its start and to its end */
    showMove(present) {
      move = present;
      showMove();
    },
    redraw,
  };
}

/** @returns {import('../../frame.js').Colours} */
function colours() {
  const methods = METHODS.map(({ name }) => [name, token(`--method-${name}`)]);
  return {
    ...Object.fromEntries(methods),
    grid: token('--grid'),
    plot: token('--plot'),
    tick: token('--text-3'),
    phase: token('--phase-ramp'),
  };
}

/** @returns {Record<string, string>} */
function dashes() {
  return Object.fromEntries(METHODS.map(({ name }) => [name, token(`--dash-${name}`) || 'solid']));
}

/** Plotly, when its script has run; null when it could not be loaded. @returns {Promise<any>} */
function plotly() {
  const present = () => /** @type {any} */ (globalThis).Plotly ?? null;
  if (present() || document.readyState === 'complete') return Promise.resolve(present());
  return new Promise((resolve) => addEventListener('load', () => resolve(present()), { once: true }));
}
