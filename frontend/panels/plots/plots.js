// @ts-check
// The three plots in one figure, with zoom, views and cursor.

import { removeCapture, showCapture } from '../../app/commands/capture.js';
import { removeTrace } from '../../app/commands/device.js';
import { takeAway } from '../../app/commands/library.js';
import { look as lookOtherwise, read as tellReading, selectRow, switchMethod, switchOwn, wantPoints, zoomTo } from '../../app/commands/view.js';
import { pin, setTable, unpin } from '../../app/commands/work.js';
import { isGoingOn, isMoveOfPlotted, ownPlayerOf, runningMoveOf, samplesOf } from '../../app/devices.js';
import { besideOf } from '../../app/library.js';
import {
  areAxesShown,
  axisMovesOf,
  curvesOf,
  designOf,
  isMeasuredOfDesign,
  isSliding,
  measuredOf,
  shownOwnRampOf,
  motorOf,
  pinnedOf,
  plottedStalenessOf,
  shownCaptureOf,
  shownCurvesOf,
  viewOf,
} from '../../app/selectors.js';
import { FIRST_VIEW, remembering, whenChanged, whenever } from '../../app/state.js';
import { activeProfile, interpolate, liveOver, plottedStep, reachOver } from '../../plotting/curves.js';
import { motorMarksOf } from '../../plotting/motor_marks.js';
import { element } from '../../ui/dom.js';
import { figureOf } from '../../plotting/figure.js';
import { stepsIn } from '../../plotting/frame.js';
import { REFERENCE } from '../../model/methods.js';
import { ONE_PLOT } from '../../ui/layouts.js';
import { areEqual } from '../../model/equal.js';
import { shownValue } from '../../model/units.js';
import { createCursor } from './cursor.js';
import { watchGestures } from './gestures.js';
import { asMade, curvesOver, extrasOver, restingSamplesOf } from './layers.js';
import { createLegend } from './legend.js';
import { createMotorMarks } from './motor_marks.js';
import { readLook } from './look.js';
import { createOverlay } from './overlay.js';
import { createPainter } from './painter.js';
import { createPoints } from './points.js';
import { createSwitches } from './switches.js';
import { createViewBar } from './view_bar.js';
import { createZooming } from './zooming.js';

/** @typedef {import('../../model/types.js').Answer} Answer */
/** @typedef {import('../../model/types.js').MethodName} MethodName */
/** @typedef {import('../../plotting/frame.js').Frame} Frame */
/** @typedef {import('../../plotting/frame.js').Scene} Scene */
/** @typedef {import('../../app/state.js').State} State */

// So long after the last change the figure is drawn with all its care: ranges that fit, every point.
const SETTLED_AFTER_MS = 150;
// Finer points are asked for when fewer than one in so many of those that were asked for is in view.
const COARSEST_SHARE = 4;

// An A4 page across within the margins of print.css is 273 mm × 186 mm [px]; legend and figures have their room on it, too.
const PAPER = { width: 1031, height: 500 };

/** @type {(names: MethodName[]) => ReadonlySet<MethodName>} */
const setOf = remembering((names) => new Set(names));

/** @param {HTMLElement} root @param {import('../../app/state.js').Dispatch} dispatch */
export function createPlots(root, dispatch) {
  /** What is shown.
   * @type {State | null} */
  let state = null;
  let view = FIRST_VIEW;
  /** @type {ReadonlySet<MethodName>} */
  let shown = new Set();
  /** What the server answered, in the units that it is shown in.
   * @type {Answer | null} */
  let answer = null;
  /** @type {import('./layers.js').Curves} */
  let curves = {};
  /** @type {import('./layers.js').Extras} */
  let extras = {};
  /** @type {Frame | null} */
  let frame = null;
  /** How far a move of another ramp goes that runs, and how fast it gets; null: none does.
   * @type {ReturnType<typeof reachOver> | null} */
  let reach = null;
  let awaitedFrame = 0;
  /** The room for the plots [px]; none: they can't be seen. */
  let size = { width: 0, height: 0 };
  let isPrinting = false;
  let settling = 0;
  /** The frame whose ranges stay while a point is dragged.
   * @type {Frame | null} */
  let held = null;
  /** Colours, dashes and font as the theme has them; null: to be read.
   * @type {ReturnType<typeof readLook> | null} */
  let look = null;

  const bar = createViewBar({
    onPlotAxis: (against) => dispatch(lookOtherwise, { against }),
    onView: (part) => dispatch(lookOtherwise, { part }),
    onPlot: (only) => dispatch(lookOtherwise, { only }),
    onPin: () => dispatch(pin),
    onUnpin: () => dispatch(unpin),
    onCapture: () => dispatch(showCapture, true),
  });
  const switches = createSwitches({
    onAcceleration: (acceleration) => dispatch(lookOtherwise, { acceleration }),
    onThird: (third) => dispatch(lookOtherwise, { third }),
  });
  const legend = createLegend((name) => dispatch(switchMethod, name), () => dispatch(switchOwn), {
    onOpen: () => dispatch(showCapture, true),
    onRemove: () => dispatch(removeCapture),
  }, (key) => dispatch(takeAway, key), () => dispatch(removeTrace));
  const overlay = createOverlay(switches.elements);
  const cursor = createCursor(
    overlay,
    () => frame && answer && { frame, answer, curves, extras, shown, third: view.third, isHeld: held !== null },
    (reading) => dispatch(tellReading, reading),
  );
  const motorMarks = createMotorMarks();
  const points = createPoints({
    onRows: (rows, gesture) => dispatch(setTable, rows, undefined, gesture),
    onSelect: (row) => dispatch(selectRow, row),
    onDrag: dragged,
    isOn: () => shown.has('table') && !areAll(),
  });
  const zooming = createZooming(
    () => frame && { frame, isZoomed: view.zoom !== null },
    (ends) => dispatch(zoomTo, ends),
  );
  const figure = element('div', { className: 'figure' });
  const painter = createPainter(figure, {
    onSelect: zooming.select,
    onDoubleClick: zooming.all,
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
    motorMarks.element,
    ...overlay.elements,
    points.element,
  );
  root.replaceChildren(bar.element, legend.element, scope);
  watchGestures(scope, {
    onPoint: cursor.point,
    onZoom: zooming.about,
    onZoomAtCursor: (factor) => frame && zooming.about(factor, cursor.pixel(frame)),
    onPan: zooming.pan,
    onAll: zooming.all,
    onWalk: cursor.walk,
    isZoomed: () => view.zoom !== null,
  });

  // Asked of the page itself at each drawing, it would have to lay everything out anew for the answer.
  new ResizeObserver(([{ contentRect }]) => {
    size = { width: Math.round(contentRect.width), height: Math.round(contentRect.height) };
    redraw();
  }).observe(scope);
  ONE_PLOT.addEventListener('change', redraw);
  // Paper has another width than the window. It is laid out as soon as this is over: no frame comes before.
  for (const name of ['beforeprint', 'afterprint'])
    addEventListener(name, () => {
      isPrinting = name === 'beforeprint';
      draw();
    });
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

  const areAll = () => state !== null && axisMovesOf(state) !== null;

  function updateCurves() {
    [curves, extras] = [{}, {}];
    if (answer === null || state === null) return;
    curves = curvesOver(answer, shown, against());
    extras = extrasOver(state, answer, against());
  }

  /** All axes have only their time in common. */
  function against() {
    return areAll() ? 'time' : view.against;
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
    const { part, only, third, acceleration, zoom } = view;
    return {
      ...extras,
      view: part,
      only,
      third,
      acceleration,
      zoom,
      reach,
      against: against(),
      answer,
      curves,
      shown,
      size: isPrinting ? PAPER : size,
      compact: ONE_PLOT.matches && !isPrinting,
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
    points.place(frame, curves, answer, against());
    legend.show(answer, shown, answer.design.method.name);
    cursor.readAgain();
    showMove();
    showMotor();
  }

  /** What the motor can do of that, by the answer that came last. */
  function showMotor() {
    const known = state && motorOf(state);
    const scene = areAll() ? null : sceneOf();
    const found = known?.answer && frame && scene ? motorMarksOf(known.answer, frame, scene) : null;
    motorMarks.show(found);
  }

  /** Thinned points are replaced by finer ones when only a part of the move is in view. */
  function askForRange() {
    const curve = answer && curves[answer.design.method.name];
    if (!frame || !answer || !curve || areAll() || state === null || curvesOf(state) === null) return;
    const { range } = view;
    const steps = activeProfile(answer).summary.steps;
    const [first, last] = stepsIn(curve, frame.x);
    const isWhole = view.zoom === null && view.part === 'whole';
    const isKnown = range !== null && range[0] <= first && range[1] >= Math.min(last, steps);
    if (isWhole ? range === null : isKnown && range && range[1] - range[0] < COARSEST_SHARE * (last - first + 1))
      return;
    const half = Math.ceil((last - first) / 2);
    dispatch(wantPoints, isWhole ? null : [Math.max(1, first - half), Math.min(steps, last + half)]);
  }

  // ---- looking around ----

  /** While a point is dragged no tooltip hides it, and ranges don't change.
   * @param {boolean} isDragging */
  function dragged(isDragging) {
    held = isDragging ? frame : null;
    cursor.leave();
    if (!isDragging) redraw();
  }

  // ---- what runs ----

  function showMove() {
    if (!frame || !answer || !state) return;
    const curve = areAll() ? undefined : curves[answer.design.method.name];
    const [move, samples, isOfPlotted] = [runningMoveOf(state), samplesOf(state), isMoveOfPlotted(state)];
    widen(samples !== null && !isOfPlotted && curve && isGoingOn(state) ? reachOver(answer, against(), samples) : null);
    if (!move || !curve) {
      legend.showLonger(false);
      overlay.showMove(frame, null, null);
      return;
    }
    const live = samples && liveOver(answer, against(), asMade(state, samples));
    const step = Math.max(1, plottedStep(activeProfile(answer), move.done, move.remaining));
    const speed = shownValue(state.units, answer.design, 'speed', move.speed);
    const isPlaced = !Number.isNaN(step);
    legend.showLonger(!isPlaced && isOfPlotted);
    const planned = isPlaced ? interpolate(curve.step, curve.x, step) : null;
    const x = live !== null && !isOfPlotted ? (live.x.at(-1) ?? null) : planned;
    const place = x === null ? null : { x, speed, isOld: move.isOld };
    overlay.showMove(frame, place, live);
  }

  /** A move of another ramp has room to its end.
   * @param {ReturnType<typeof reachOver> | null} wanted */
  function widen(wanted) {
    if (areEqual(wanted, reach)) return;
    reach = wanted;
    redraw();
  }

  // ---- what is shown ----

  /** @param {State} now */
  function showChoices(now) {
    const isMeasured = measuredOf(now) !== null;
    const captured = shownCaptureOf(now);
    // What the lines are, the numbers of the axes' tabs tell by their colours.
    const [hasAnswer, areAllShown] = [shownCurvesOf(now) !== null, axisMovesOf(now) !== null];
    legend.element.hidden = areAllShown;
    bar.show({ against: view.against, view: view.part, only: view.only, areAxesShown: areAllShown });
    bar.showPinned(pinnedOf(now) !== null);
    switches.show(view, isMeasured || captured !== null, areAllShown);
    legend.showTrace({
      isTraced: isMeasured || samplesOf(now) !== null,
      isOfAnother: isMeasured ? !isMeasuredOfDesign(now) : !isMoveOfPlotted(now),
      isRunning: !isMeasured && isGoingOn(now),
      record: isMeasured ? now.devices.measured?.record : undefined,
    });
    legend.showCapture(captured);
    legend.showBeside(besideOf(now));
    legend.showOwn(areAllShown ? null : (now.answers.ownRamp?.ramp ?? null), ownPlayerOf(now)?.title ?? '', now.isOwnShown);
    if (!hasAnswer) legend.show(null, shown, designOf(now)?.method.name ?? REFERENCE);
  }

  /** Curves that are other ones, in the order of haste: what changes many times a second is drawn at once. */
  const shows = [
    whenever(
      (now) => [
        viewOf(now),
        measuredOf(now),
        isMeasuredOfDesign(now),
        shownCaptureOf(now),
        samplesOf(now) === null,
        isGoingOn(now),
        isMoveOfPlotted(now),
        axisMovesOf(now),
        pinnedOf(now),
        besideOf(now),
        now.answers.ownRamp,
        now.isOwnShown,
        shownCurvesOf(now) === null,
        now.shown,
      ],
      showChoices,
    ),
    whenever(
      (now) => [viewOf(now), now.shown, now.units, now.theme, measuredOf(now), shownCaptureOf(now), pinnedOf(now), besideOf(now), isSliding(now)],
      redrawAnew,
    ),
    whenever((now) => [shownCurvesOf(now), axisMovesOf(now), restingSamplesOf(now), isMoveOfPlotted(now), shownOwnRampOf(now)], drawAnew),
    whenChanged((now) => [designOf(now)], (design) => design && points.show(design)),
    whenChanged(({ row }) => [row], (row) => points.select(row)),
    whenever((now) => [runningMoveOf(now), isGoingOn(now)], showMove),
    whenever((now) => [motorOf(now)], showMotor),
    whenChanged((now) => [(motorOf(now)?.design ?? null) !== designOf(now)], motorMarks.showStale),
    // Why the curves belong to earlier values.
    whenChanged(
      (now) => [plottedStalenessOf(now), shownCurvesOf(now) === null, axisMovesOf(now) !== null],
      (staleness, isEmpty, areAllShown) => {
        root.classList.toggle('stale', staleness !== null);
        root.classList.toggle('awaited', staleness === 'awaited');
        root.classList.toggle('blank', isEmpty && !areAllShown);
        overlay.showStale(staleness, !isEmpty || areAllShown);
      },
    ),
  ];

  function redrawAnew() {
    updateCurves();
    redraw();
  }

  function drawAnew() {
    updateCurves();
    drawQuickly();
  }

  return {
    /** @param {State} now */
    show(now) {
      const before = state;
      state = now;
      view = viewOf(now);
      shown = setOf(now.shown);
      const newest = shownCurvesOf(now);
      if (before === null || newest !== shownCurvesOf(before) || now.units !== before.units) {
        answer = newest && { ...newest, units: now.units };
      }
      for (const show of shows) show(now);
    },
  };
}
