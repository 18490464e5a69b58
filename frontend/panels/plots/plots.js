// @ts-check
// The three plots in one figure, with zoom, views and cursor.

import {
  activeProfile,
  axesReadingAt,
  curveOf,
  interpolate,
  liveOver,
  measuredOver,
  plottedStep,
  readingAt,
} from '../../curves.js';
import { element } from '../../dom.js';
import { figureOf } from '../../figure.js';
import { stepsIn, xPixel, xValue, zoomedAbout } from '../../frame.js';
import { METHODS, REFERENCE } from '../../methods.js';
import { token } from '../../theme.js';
import { shownValue, STEPS_AND_SECONDS } from '../../units.js';
import { watchGestures } from './gestures.js';
import { createLegend } from './legend.js';
import { createOverlay } from './overlay.js';
import { createPainter } from './painter.js';
import { createPoints } from './points.js';
import { createSwitches } from './switches.js';
import { createViewBar } from './view_bar.js';

/** @typedef {import('../../types.js').Answer} Answer */
/** @typedef {import('../../types.js').MethodName} MethodName */
/** @typedef {import('../../curves.js').AxisMove} AxisMove */
/** @typedef {import('../../curves.js').Curve} Curve */
/** @typedef {import('../../curves.js').MeasuredMove} MeasuredMove */
/** @typedef {import('../../curves.js').Reading} Reading */
/** @typedef {import('../../frame.js').Frame} Frame */
/** @typedef {import('../../frame.js').Scene} Scene */

const COMPACT = matchMedia('(max-width: 700px)');
// So long after the last change the figure is drawn with all its care: ranges that fit, every point.
const SETTLED_AFTER_MS = 150;
// Finer points are asked for when fewer than one in so many of those that were asked for is in view.
const COARSEST_SHARE = 4;

/**
 * @param {HTMLElement} root
 * @param {ReadonlySet<MethodName>} shown the methods to draw, as they are at each drawing
 * @param {object} handlers
 * @param {(name: MethodName) => void} handlers.onSwitch
 * @param {(reading: Reading | null) => void} handlers.onReading
 * @param {(range: [number, number] | null) => void} handlers.onRange  first and last step that finer points are wanted
 *   for; null: the whole move
 * @param {(wanted: {acceleration: boolean, parts: boolean}) => void} handlers.onDetails
 * @param {() => void} handlers.onKeep
 * @param {() => void} handlers.onForget
 * @param {(rows: import('../../design.js').Rows, gesture: string) => void} handlers.onRows
 * @param {(row: number) => void} handlers.onSelectRow
 */
export function createPlots(root, shown, handlers) {
  const view = {
    axis: /** @type {import('../../curves.js').AxisName} */ ('step'),
    view: /** @type {import('../../frame.js').ViewName} */ ('whole'),
    only: /** @type {import('../../frame.js').PlotName} */ ('velocity'),
    third: /** @type {import('../../frame.js').Third} */ ('error'),
    acceleration: false,
    zoom: /** @type {[number, number] | null} */ (null),
  };
  /** What is laid beside or over the curves of the answer. */
  const beside = {
    kept: /** @type {Answer | null} */ (null),
    axes: /** @type {AxisMove[] | null} */ (null),
    measured: /** @type {MeasuredMove | null} */ (null),
    live: /** @type {import('../../types.js').Samples | null} */ (null),
  };
  /** @type {Answer | null} */
  let answer = null;
  let units = STEPS_AND_SECONDS;
  /** @type {Partial<Record<MethodName, Curve>>} */
  let curves = {};
  /** What is beside them, over the same axis.
   * @type {Pick<Scene, 'kept' | 'axes' | 'measured' | 'live'>} */
  let extras = {};
  /** @type {Frame | null} */
  let frame = null;
  /** @type {{done: number, remaining: number, speed: number} | null} */
  let move = null;
  /** @type {Reading | null} */
  let reading = null;
  /** Where the pointer is, in pixels of the figure; null: not over it.
   * @type {number | null} */
  let pointer = null;
  let awaitedFrame = 0;
  /** The room for the plots [px]; none: they can't be seen. */
  let size = { width: 0, height: 0 };
  let settling = 0;
  /** The frame whose ranges stay while a point is dragged.
   * @type {Frame | null} */
  let held = null;
  /** The part of the move that finer points were asked for.
   * @type {[number, number] | null} */
  let range = null;
  /** Colours, dashes and font as the theme has them; null: to be read.
   * @type {ReturnType<typeof readLook> | null} */
  let look = null;

  const bar = createViewBar({
    onAxis: (axis) => change({ axis, zoom: null }),
    onView: (name) => change({ view: name, zoom: null }),
    onPlot: (only) => change({ only }),
    onKeep: handlers.onKeep,
    onForget: handlers.onForget,
  });
  const switches = createSwitches({
    onAcceleration: (acceleration) => change({ acceleration }),
    onThird: (third) => change({ third }),
  });
  const legend = createLegend(handlers.onSwitch);
  const overlay = createOverlay(switches.elements);
  const points = createPoints({
    onRows: handlers.onRows,
    onSelect: handlers.onSelectRow,
    onDrag: dragged,
    isOn: () => shown.has('table') && beside.axes === null,
  });
  const figure = element('div', { className: 'figure' });
  const painter = createPainter(figure, {
    onSelect: (low, high) => {
      if (frame) zoomTo(frame.x.isLog ? [10 ** low, 10 ** high] : [low, high]);
    },
    onDoubleClick: () => change({ zoom: null }),
  });
  const scope = element(
    'div',
    {
      className: 'scope',
      tabIndex: 0,
      role: 'group',
      'aria-label': 'Plots of velocity, delay and error. Arrow keys move the cursor, plus and minus zoom, 0 shows all.',
    },
    figure,
    ...overlay.elements,
    points.element,
  );
  root.replaceChildren(bar.element, legend.element, scope);
  bar.show({ ...view, areAxesShown: false });
  switches.show(view, false, false);
  legend.show(null, shown, REFERENCE);
  watchGestures(scope, {
    onPoint: (pixel) => {
      pointer = pixel;
      if (pixel === null) read(null);
      else readAgain();
    },
    onZoom: zoomBy,
    onZoomAtCursor: (factor) => {
      if (frame) zoomBy(factor, reading ? xPixel(frame, reading.x) : frame.left + frame.width / 2);
    },
    onPan: panBy,
    onAll: () => change({ zoom: null }),
    onWalk: walk,
    isZoomed: () => view.zoom !== null,
  });

  // Asked of the page itself at each drawing, it would have to lay everything out anew for the answer.
  new ResizeObserver(([{ contentRect }]) => {
    size = { width: Math.round(contentRect.width), height: Math.round(contentRect.height) };
    redraw();
  }).observe(scope);
  COMPACT.addEventListener('change', redraw);
  painter.load().then((isThere) => {
    if (isThere) redraw();
    else
      scope.replaceChildren(
        element('p', {
          className: 'empty',
          textContent: 'The plots can’t be drawn: plotly.min.js did not load. Everything else works.',
        }),
      );
  });

  // ---- what is drawn ----

  /** @param {Partial<typeof view>} changed */
  function change(changed) {
    Object.assign(view, changed);
    bar.show({ ...view, areAxesShown: beside.axes !== null });
    switches.show(view, beside.measured !== null, beside.axes !== null);
    if ('acceleration' in changed || 'third' in changed)
      handlers.onDetails({ acceleration: view.acceleration, parts: view.third === 'parts' });
    updateCurves();
    redraw();
  }

  function updateCurves() {
    curves = {};
    extras = {};
    if (answer === null) return;
    for (const { name } of METHODS) {
      const curve = shown.has(name) || name === answer.design.method.name ? curveOf(answer, name, axis()) : null;
      if (curve) curves[name] = curve;
    }
    const { kept, axes, measured, live } = beside;
    extras = {
      kept: kept && curveOf({ ...kept, units }, kept.design.method.name, axis()),
      axes:
        axes &&
        axes.map(({ time_s, speed, delay_us, ...one }) => ({ ...one, x: time_s, velocity: speed, delay: delay_us })),
      measured: measured && measuredOver(answer, axis(), measured),
      live: live && liveOver(answer, axis(), live),
    };
  }

  /** All axes have only their time in common. */
  function axis() {
    return beside.axes ? 'time' : view.axis;
  }

  function redraw() {
    look = null;
    if (awaitedFrame === 0) awaitedFrame = requestAnimationFrame(() => draw());
  }

  /** @param {Pick<Scene, 'held' | 'hold'>} [holding] @returns {Scene | null} */
  function sceneOf(holding = {}) {
    if (!answer || !painter.isLoaded() || size.width === 0 || size.height === 0) return null;
    look ??= readLook();
    const firmly = held && { held, hold: /** @type {const} */ ('firmly') };
    const zoom = view.zoom;
    return {
      ...view,
      ...extras,
      zoom,
      axis: axis(),
      answer,
      curves,
      shown,
      size,
      compact: COMPACT.matches,
      ...look,
      ...holding,
      ...firmly,
    };
  }

  /** Draw with all care. */
  async function draw() {
    cancelAnimationFrame(awaitedFrame);
    clearTimeout(settling);
    awaitedFrame = 0;
    const scene = sceneOf();
    if (!scene) return;
    const made = figureOf(scene);
    frame = made.frame;
    await painter.paint(scene, made.frame, made.lines);
    drawOver();
    askForRange();
  }

  /** Draw what changes many times a second: at once, as every millisecond is felt, and with care once it is over. */
  async function drawQuickly() {
    cancelAnimationFrame(awaitedFrame);
    clearTimeout(settling);
    awaitedFrame = 0;
    const scene = sceneOf(frame ? { held: frame, hold: 'while it fits' } : {});
    if (!scene) return;
    const made = figureOf(scene);
    frame = made.frame;
    if (!painter.rewrite(scene, made.frame, made.lines)) await painter.paint(scene, made.frame, made.lines);
    drawOver();
    clearTimeout(settling);
    settling = window.setTimeout(draw, SETTLED_AFTER_MS);
  }

  /** What lies over the figure. */
  function drawOver() {
    if (!frame || !answer) return;
    overlay.place(frame, view.third);
    points.place(frame, curves, answer, axis());
    legend.show(answer, shown, answer.design.method.name);
    readAgain();
    showMove();
  }

  /** Thinned points are replaced by finer ones when only a part of the move is in view. */
  function askForRange() {
    const curve = answer && curves[answer.design.method.name];
    if (!frame || !answer || !curve || beside.axes) return;
    const steps = activeProfile(answer).summary.steps;
    const [first, last] = stepsIn(curve, frame.x);
    const isWhole = view.zoom === null && view.view === 'whole';
    const isKnown = range !== null && range[0] <= first && range[1] >= Math.min(last, steps);
    if (isWhole ? range === null : isKnown && range && range[1] - range[0] < COARSEST_SHARE * (last - first + 1))
      return;
    const half = Math.ceil((last - first) / 2);
    range = isWhole ? null : [Math.max(1, first - half), Math.min(steps, last + half)];
    handlers.onRange(range);
  }

  // ---- looking around ----

  /** @param {number[]} ends */
  function zoomTo(ends) {
    if (!frame) return;
    const [low, high] = [Math.max(frame.full.low, Math.min(...ends)), Math.min(frame.full.high, Math.max(...ends))];
    if (high > low) change({ zoom: [low, high] });
  }

  /** @param {number} factor @param {number} pixel */
  function zoomBy(factor, pixel) {
    if (!frame) return;
    const within = Math.min(frame.left + frame.width, Math.max(frame.left, pixel));
    change({ zoom: zoomedAbout(frame, within, factor) });
  }

  /** @param {number} pixels */
  function panBy(pixels) {
    if (!frame || !view.zoom) return;
    const place = (/** @type {number} */ edge) => xValue(/** @type {Frame} */ (frame), edge - pixels);
    const [low, high] = [place(frame.left), place(frame.left + frame.width)];
    if (low >= frame.full.low && high <= frame.full.high) change({ zoom: [low, high] });
  }

  /** Move the cursor along the computed steps.
   * @param {number} by */
  function walk(by) {
    const steps = answer && curves[answer.design.method.name];
    if (!steps || !frame || beside.axes) return;
    pointer = null;
    const low = frame.x.low;
    const index = reading ? steps.step.indexOf(reading.step) + by : steps.x.findIndex((x) => x >= low);
    const at = Math.min(steps.x.length - 1, Math.max(0, index));
    read(readingAt(curves, /** @type {Answer} */ (answer).design.method.name, steps.x[at]));
  }

  /** @param {Reading | null} at */
  function read(at) {
    if (at === null && reading === null) {
      overlay.clear();
      return;
    }
    reading = at;
    if (at === null) overlay.clear();
    else if (frame && answer) overlay.read(frame, at, answer.design.method.name, shown, view.third);
    handlers.onReading(at);
  }

  /** Read what is under the pointer, or else where the keys left the cursor. */
  function readAgain() {
    if (!frame || !answer) return;
    const x = pointer === null ? reading?.x : xValue(frame, pointer);
    const isInside = held === null && x !== undefined && x >= frame.x.low && x <= frame.x.high;
    if (extras.axes && isInside) overlay.readAxes(frame, axesReadingAt(extras.axes, x));
    else read(isInside && !extras.axes ? readingAt(curves, answer.design.method.name, x) : null);
  }

  /** While a point is dragged no tooltip hides it, and ranges don't change.
   * @param {boolean} isDragging */
  function dragged(isDragging) {
    held = isDragging ? frame : null;
    pointer = null;
    read(null);
    if (!isDragging) redraw();
  }

  // ---- what runs ----

  function showMove() {
    if (!frame || !answer) return;
    const curve = curves[answer.design.method.name];
    if (!move || !curve || beside.axes) {
      overlay.showMove(frame, null);
      return;
    }
    const step = Math.max(1, plottedStep(activeProfile(answer), move.done, move.remaining));
    const speed = shownValue(units, answer.design, 'speed', move.speed);
    overlay.showMove(frame, { x: interpolate(curve.step, curve.x, step), speed });
  }

  /** @param {Partial<typeof beside>} changed */
  function lay(changed) {
    Object.assign(beside, changed);
    // There is no deviation without a measured move.
    if (beside.measured === null && view.third === 'deviation') view.third = 'error';
    bar.show({ ...view, areAxesShown: beside.axes !== null });
    switches.show(view, beside.measured !== null, beside.axes !== null);
    updateCurves();
  }

  return {
    /** @param {Answer} newest */
    show(newest) {
      // A zoom into another move would show nothing of this one.
      if (answer && newest.design.name !== answer.design.name) view.zoom = null;
      answer = { ...newest, units };
      updateCurves();
      drawQuickly();
    },
    /** @param {Answer | null} kept of the design kept to compare with: a ghost beneath the curves */
    showKept(kept) {
      if (kept === beside.kept) return;
      bar.showKept(kept !== null);
      lay({ kept });
      redraw();
    },
    /** @param {AxisMove[] | null} axes all of them over one time; null: the methods of one axis again */
    showAxes(axes) {
      if (axes === null && beside.axes === null) return;
      if (axes === null || beside.axes === null) view.zoom = null;
      // What the lines are, the numbers of the axes' tabs tell by their colours.
      legend.element.hidden = axes !== null;
      lay({ axes });
      drawQuickly();
    },
    /** @param {MeasuredMove | null} measured laid over its plan; with it comes the choice of its deviation */
    showMeasured(measured) {
      if (measured === beside.measured) return;
      lay({ measured });
      redraw();
    },
    /** @param {import('../../types.js').Samples | null} live samples of a move since its start [s, steps, steps/s] */
    showLive(live) {
      if (live === beside.live) return;
      lay({ live });
      drawQuickly();
    },
    /** @param {import('../../units.js').Units} chosen */
    showUnits(chosen) {
      units = chosen;
      if (answer) answer = { ...answer, units };
      // Positions are in other units too.
      view.zoom = view.axis === 'position' ? null : view.zoom;
      updateCurves();
      redraw();
    },
    /** @param {import('../../types.js').Staleness} staleness why the curves belong to earlier values */
    showStale(staleness) {
      root.classList.toggle('stale', staleness !== null);
      overlay.showStale(answer === null ? null : staleness);
    },
    /** @param {boolean} isMoving a slider that is let go has its curves drawn with care at once */
    showSliding(isMoving) {
      if (!isMoving) redraw();
    },
    /** @param {{done: number, remaining: number, speed: number} | null} present the move that runs, in steps since its
     * start and to its end */
    showMove(present) {
      move = present;
      showMove();
    },
    /** @param {import('../../types.js').Design} design whose rows are the points */
    showDesign: (design) => points.show(design),
    /** Where one plot at a time has room: the one with the rows, in the view that shows them apart. */
    showRows() {
      if (COMPACT.matches) change({ only: 'delay', axis: 'step', view: 'start', zoom: null });
    },
    /** @param {number} row of the table; -1: none */
    selectRow: (row) => points.select(row),
    redraw,
  };
}

/** Colours, dashes and font of the present theme.
 * @returns {Pick<Scene, 'colours' | 'dashes' | 'font'>} */
function readLook() {
  const named = ['kept', 'measured', 'axis-0', 'axis-1', 'axis-2', 'axis-3'];
  const parts = ['method', 'arithmetic', 'rounding', 'compression'].map((name) => `part-${name}`);
  const colours = Object.fromEntries([
    ...METHODS.map(({ name }) => [name, token(`--method-${name}`)]),
    ...[...named, ...parts].map((name) => [name, token(`--${name}`)]),
  ]);
  return {
    colours: {
      ...colours,
      grid: token('--grid'),
      plot: token('--plot'),
      tick: token('--text-3'),
      phase: token('--phase-ramp'),
    },
    dashes: Object.fromEntries(METHODS.map(({ name }) => [name, token(`--dash-${name}`) || 'solid'])),
    font: token('--font'),
  };
}
