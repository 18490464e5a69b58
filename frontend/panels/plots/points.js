// @ts-check
// The rows of the lookup table as points over the delay plot: dragged, nudged, added and removed where they are drawn.
// An svg over the figure and beside it, never in it: Plotly may redraw whenever it likes.

import { axisScale, interpolate } from '../../plotting/curves.js';
import { createDoublePress, createDragging } from '../../ui/dragging.js';
import { svgElement } from '../../ui/dom.js';
import { xPixel, xValue, yPixel, yValue } from '../../plotting/frame.js';
import { formatEntry } from '../../model/numbers.js';
import {
  delayFromUs,
  delayInUs,
  indexAtX,
  isSound,
  LONGEST_DELAY,
  movedRow,
  nudgedRow,
  rowX,
  withRowAt,
} from '../../plotting/table_rows.js';

/** @typedef {import('../../model/types.js').Answer} Answer */
/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../plotting/curves.js').PlotAxis} PlotAxis */
/** @typedef {import('../../model/design.js').Rows} Rows */
/** @typedef {import('../../plotting/frame.js').Frame} Frame */
/** @typedef {import('../../plotting/frame.js').PlotFrame} PlotFrame */
/** @typedef {Partial<Record<import('../../model/types.js').MethodName, import('../../plotting/curves.js').Curve>>} Curves */
/** @typedef {{x: number, y: number}} Pixels  from the upper left corner of the figure */

/** @typedef {object} Drag
 * @property {number} row
 * @property {Pixels} from    where the point was
 * @property {Rows} before    the rows as they were */

// Beyond the plot's edges by a point's half, so that points on an edge are whole.
const BLEED = 12;
const LABEL_GAP = 10;

/**
 * @param {object} handlers
 * @param {(rows: Rows, gesture: string) => void} handlers.onRows  edits with the same gesture are one
 * @param {(row: number) => void} handlers.onSelect
 * @param {(isDragging: boolean) => void} [handlers.onDrag]  while it is true, no axis may change its range
 * @param {() => boolean} [handlers.isOn]  whether the table is among what is plotted
 */
export function createPoints({ onRows, onSelect, onDrag = () => {}, isOn = () => true }) {
  /** @type {Design | null} */
  let design = null;
  /** @type {{frame: Frame, curves: Curves, answer: Answer, against: PlotAxis} | null} */
  let scene = null;
  let selected = -1;
  /** @type {Drag | null} */
  let drag = null;
  let gestures = 0;
  /** The rows that the drag has reported, to tell them from others. */
  let reported = '';
  /** The element that is listened to for double clicks: what the points were put over.
   * @type {Element | null} */
  let ground = null;

  /** @type {SVGElement[]} */
  const handles = [];
  const label = svgElement('text', { class: 'point-label', 'aria-hidden': 'true' });
  // An inner svg clips without an id.
  const clip = svgElement('svg', { overflow: 'hidden' });
  const drawing = svgElement('svg', { class: 'points', role: 'group', 'aria-label': 'Rows of the lookup table' });
  clip.append(label);
  drawing.append(clip);
  const isSecondPress = createDoublePress();
  const dragging = createDragging(drawing, { width: () => drawing.clientWidth, onMove: follow, onEnd: ended });

  /** @returns {Rows} */
  const rows = () => design?.table?.rows ?? [];
  const delayPlot = () => /** @type {PlotFrame} */ (scene?.frame.plots.find((plot) => plot.name === 'delay'));
  const isShown = () => scene !== null && design !== null && delayPlot().isVisible && isOn();

  function scale() {
    const { answer, against } = /** @type {NonNullable<typeof scene>} */ (scene);
    const { factor } = axisScale(answer, against);
    const isBackward = against === 'position' && Number(answer.design.move.steps) < 0;
    return { against, factor: isBackward ? -factor : factor };
  }

  /** @param {number} row @returns {Pixels} not numbers where the row has none, or where its axis has no such place */
  function placeOf(row) {
    const { frame } = /** @type {NonNullable<typeof scene>} */ (scene);
    const [shown, plot] = [/** @type {Design} */ (design), delayPlot()];
    if (!isSound(rows()[row])) return { x: NaN, y: NaN };
    const delay = delayInUs(shown, Number(rows()[row][1]));
    return { x: xPixel(frame, rowX(shown, rows(), row, scale())), y: yPixel(plot, delay) };
  }

  /** @param {Pixels} place */
  function withinPlot({ x, y }) {
    const { frame } = /** @type {NonNullable<typeof scene>} */ (scene);
    const { top, height } = delayPlot();
    const within = (/** @type {number} */ value, /** @type {number} */ low, /** @type {number} */ size) =>
      Math.min(low + size, Math.max(low, Number.isNaN(value) ? low : value));
    return { x: within(x, frame.left, frame.width), y: within(y, top, height) };
  }

  function draw() {
    const count = isShown() ? rows().length : 0;
    while (handles.length > count) handles.pop()?.remove();
    while (handles.length < count) handles.push(createHandle(handles.length));
    label.textContent = '';
    if (!isShown()) return;
    const { frame } = /** @type {NonNullable<typeof scene>} */ (scene);
    const { top, height } = delayPlot();
    setAll(clip, {
      x: frame.left - BLEED,
      y: top - BLEED,
      width: frame.width + 2 * BLEED,
      height: height + 2 * BLEED,
    });
    handles.forEach(drawHandle);
  }

  /** @param {SVGElement} handle @param {number} row */
  function drawHandle(handle, row) {
    const { frame } = /** @type {NonNullable<typeof scene>} */ (scene);
    const place = placeOf(row);
    const inside = withinPlot(place);
    // Not numbers are outside too.
    const isOutside = !(Math.abs(place.x - inside.x) < 1 && Math.abs(place.y - inside.y) < 1);
    const isFocused = document.activeElement === handle;
    // The one with the focus is kept at the edge, or the keyboard would lose its place.
    handle.style.display = isOutside && !isFocused && drag?.row !== row ? 'none' : '';
    handle.classList.toggle('outside', isOutside);
    handle.classList.toggle('dragged', drag?.row === row);
    const shown = isOutside ? inside : place;
    setAll(handle, {
      transform: `translate(${shown.x - frame.left + BLEED} ${shown.y - delayPlot().top + BLEED})`,
      'aria-current': String(selected === row),
      'aria-valuenow': Number(rows()[row][1]) || 1,
      'aria-valuetext': described(row),
    });
    if (drag?.row === row || (isFocused && drag === null && handle.matches(':focus-visible'))) drawLabel(row, shown);
  }

  /** @param {number} row @param {Pixels} place */
  function drawLabel(row, place) {
    const { frame } = /** @type {NonNullable<typeof scene>} */ (scene);
    const isRight = place.x > frame.left + frame.width / 2;
    const isHigh = place.y < delayPlot().top + 2 * LABEL_GAP;
    label.textContent = described(row);
    setAll(label, {
      x: place.x - frame.left + BLEED + (isRight ? -LABEL_GAP : LABEL_GAP),
      y: place.y - delayPlot().top + BLEED + (isHigh ? 2 * LABEL_GAP : -LABEL_GAP),
      'text-anchor': isRight ? 'end' : 'start',
    });
  }

  /** @param {number} row */
  function described(row) {
    const [index, delay] = rows()[row];
    const unit = design?.table?.interval_unit === 'ticks' ? 'ticks' : 'µs';
    const step = typeof index === 'number' ? ` (step ${formatEntry(index - 1)})` : '';
    return `last index ${formatEntry(index)}${step}, ${formatEntry(delay)} ${unit}`;
  }

  /** @param {number} row */
  function createHandle(row) {
    const handle = svgElement('g', {
      class: 'point',
      tabindex: 0,
      role: 'slider',
      'aria-label': `Row ${row + 1} of the table`,
      'aria-valuemin': 1,
      'aria-valuemax': LONGEST_DELAY,
      'data-row': row,
    });
    for (const name of ['hit', 'ring', 'dot']) handle.append(svgElement('circle', { class: name }));
    handle.addEventListener('pointerdown', pressed);
    handle.addEventListener('keydown', (event) => typed(event, row));
    handle.addEventListener('focus', () => {
      gestures += 1;
      choose(row);
    });
    handle.addEventListener('blur', draw);
    clip.insertBefore(handle, label);
    return handle;
  }

  /** @param {number} row */
  function choose(row) {
    selected = row;
    draw();
    onSelect(row);
  }

  /** The row whose point is nearest: where several lie close together, the uppermost need not be the one meant.
   * @param {Pixels} at */
  function nearestRow(at) {
    const distances = handles.map((handle, row) => {
      const place = withinPlot(placeOf(row));
      return handle.style.display === 'none' ? Infinity : Math.hypot(place.x - at.x, place.y - at.y);
    });
    return distances.indexOf(Math.min(...distances));
  }

  /** @param {PointerEvent} event */
  function pressed(event) {
    if (event.button !== 0 || drag || !scene) return;
    event.preventDefault();
    event.stopPropagation();
    const row = nearestRow(dragging.placeOf(event));
    const from = withinPlot(placeOf(row));
    gestures += 1;
    dragging.begin(event, handles[row], from);
    drag = { row, from, before: rows() };
    onDrag(true);
    choose(row);
  }

  /** @param {Pixels} place @param {boolean} isHeldToOne */
  function follow(place, isHeldToOne) {
    if (!drag || !scene) return;
    report(movedRow(rows(), drag.row, placeFrom(drag, withinPlot(place), isHeldToOne)));
  }

  /** What a place in the figure means for a row; with Shift what was moved less stays as it was.
   * @param {Drag} dragged @param {Pixels} wanted @param {boolean} isHeldToOne */
  function placeFrom({ row, from, before }, wanted, isHeldToOne) {
    const { frame } = /** @type {NonNullable<typeof scene>} */ (scene);
    const shown = /** @type {Design} */ (design);
    const [indexBefore, delayBefore] = before[row].map(Number);
    const isAcross = Math.abs(wanted.x - from.x) >= Math.abs(wanted.y - from.y);
    const delay =
      wanted.y === from.y || (isHeldToOne && isAcross)
        ? delayBefore
        : delayFromUs(shown, yValue(delayPlot(), wanted.y));
    const index =
      isHeldToOne && !isAcross ? indexBefore : indexAtX(shown, rows(), row, delay, scale(), xValue(frame, wanted.x));
    return { index, delay };
  }

  /** @param {Rows} changed */
  function report(changed) {
    if (JSON.stringify(changed) === JSON.stringify(rows())) return;
    reported = JSON.stringify(changed);
    onRows(changed, `point:${gestures}`);
  }

  /** @param {import('../../ui/dragging.js').DragEnd} how */
  function ended(how) {
    if (!drag) return;
    const { before } = drag;
    drag = null;
    if (how === 'restored') report(before);
    gestures += 1;
    onDrag(false);
    draw();
  }

  /** @param {KeyboardEvent} event @param {number} row */
  function typed(event, row) {
    if (event.ctrlKey || event.metaKey || drag) return;
    if (event.key === 'Delete' || event.key === 'Backspace') remove(row);
    else {
      const nudged = isSound(rows()[row]) ? nudgedRow(rows(), row, event.key, event) : null;
      if (nudged === null) return;
      report(nudged);
    }
    event.preventDefault();
    event.stopPropagation();
  }

  /** @param {number} row */
  function remove(row) {
    onRows(rows().toSpliced(row, 1), '');
    const next = handles[Math.min(row, handles.length - 1)];
    // What is not displayed can't take the focus.
    if (next) next.style.display = '';
    (next ?? /** @type {HTMLElement | null} */ (drawing.parentElement))?.focus();
  }

  /** A second press close to the first, on the plot and not on a point, adds a row. The browser's own double click
   * never comes: Plotly lays a cover over the page at the first.
   * @param {Event} event */
  function pressedOnGround(event) {
    const press = /** @type {PointerEvent} */ (event);
    const isSecond = isSecondPress(press);
    const isOnPoint = press.target instanceof Element && press.target.closest('.point') !== null;
    if (!isSecond || isOnPoint || press.button !== 0 || !isShown()) return;
    const at = dragging.placeOf(press);
    const inside = withinPlot(at);
    if (inside.x !== at.x || inside.y !== at.y) return;
    press.preventDefault();
    press.stopPropagation();
    add(at);
  }

  /** @param {Pixels} at */
  function add(at) {
    const { frame, curves, answer, against } = /** @type {NonNullable<typeof scene>} */ (scene);
    const shown = /** @type {Design} */ (design);
    const x = xValue(frame, at.x);
    const curve = curves.table ?? curves[answer.design.method.name];
    const step = against === 'time' && curve ? interpolate(curve.x, curve.step, x) : x / scale().factor;
    const added = withRowAt(rows(), { index: step + 1, delay: delayFromUs(shown, yValue(delayPlot(), at.y)) });
    if (added.rows !== rows()) onRows(added.rows, '');
    handles[added.row]?.focus({ preventScroll: true });
    choose(added.row);
  }

  return {
    element: drawing,
    /** The figure was drawn anew.
     * @param {Frame} frame @param {Curves} curves @param {Answer} answer
     * @param {PlotAxis} against */
    place(frame, curves, answer, against) {
      scene = { frame, curves, answer, against };
      if (ground === null && drawing.parentElement) {
        ground = drawing.parentElement;
        ground.addEventListener('pointerdown', pressedOnGround, { capture: true });
      }
      draw();
    },
    /** @param {number} row the one selected in the grid; -1: none */
    select(row) {
      if (selected === row) return;
      selected = row;
      draw();
    },
    /** @param {Design} shown */
    show(shown) {
      const before = JSON.stringify(rows());
      design = shown;
      const after = JSON.stringify(rows());
      // Rows that change otherwise in mid drag, as by undo, are not dragged on.
      if (drag && after !== before && after !== reported) dragging.finish('left');
      draw();
    },
  };
}

/** @param {SVGElement} target @param {Record<string, string | number>} attributes */
function setAll(target, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (target.getAttribute(name) !== String(value)) target.setAttribute(name, String(value));
  }
}
