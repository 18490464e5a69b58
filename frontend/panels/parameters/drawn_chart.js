// @ts-check
// A drawn acceleration over the speed: its curve, and its points to be dragged, nudged, added and removed.

import { drawablePoints, movedPoint, nudgedPoint, tidied, withoutPoint, withPointAt } from '../../model/drawn_points.js';
import { monotoneCubic } from '../../model/monotone_cubic.js';
import { formatFigures, formatFixed } from '../../model/numbers.js';
import { MOST_POINTS } from '../../model/shapes.js';
import { shownValue, unitWord } from '../../model/units.js';
import { chartText, gridLine } from '../../ui/chart.js';
import { createDoublePress, createDragging } from '../../ui/dragging.js';
import { svgElement } from '../../ui/dom.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/units.js').Units} Units */
/** @typedef {import('../../model/drawn_points.js').Point} Point */
/** @typedef {import('../../ui/dragging.js').Place} Place */

const WIDTH = 264;
const HEIGHT = 138;
const LEFT = 44;
const RIGHT = 12;
const TOP = 14;
const BOTTOM = 24;
const TICKS = [0, 0.25, 0.5, 0.75, 1];
// A point at the highest speed has room to be taken to a higher one.
const ROOM = 1.08;
const CURVE_POINTS = 120;

/**
 * @param {object} handlers
 * @param {(points: Point[], gesture: string) => void} handlers.onPoints  edits with the same gesture are one
 * @param {() => void} handlers.onEnd  a point was let go
 */
export function createDrawnChart({ onPoints, onEnd }) {
  /** @type {{design: Design, units: Units, points: Point[], top: number} | null} */
  let shown = null;
  /** The points as they were when one of them was taken hold of.
   * @type {{index: number, from: Place, before: Point[]} | null} */
  let drag = null;
  let gestures = 0;
  /** @type {SVGElement[]} */
  const handles = [];
  const scale = svgElement('g', { 'aria-hidden': 'true' });
  const curve = svgElement('path', { class: 'line' });
  const points = svgElement('g');
  const drawing = svgElement(
    'svg',
    { class: 'drawn-chart', viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'group', 'aria-label': 'Acceleration over speed' },
  );
  drawing.append(scale, curve, points);
  const isSecondPress = createDoublePress();
  const dragging = createDragging(drawing, { width: () => WIDTH, onMove: follow, onEnd: ended });
  drawing.addEventListener('pointerdown', (event) => pressedOnGround(/** @type {PointerEvent} */ (event)));

  const xOf = (/** @type {number} */ speed) => LEFT + (speed / (shown?.top ?? 1)) * (WIDTH - LEFT - RIGHT);
  const yOf = (/** @type {number} */ part) => TOP + (1 - part) * (HEIGHT - TOP - BOTTOM);

  /** @param {Place} place @returns {Point} */
  const pointAt = ({ x, y }) => [
    tidied(Math.max(0, ((x - LEFT) / (WIDTH - LEFT - RIGHT)) * (shown?.top ?? 1))),
    1 - (y - TOP) / (HEIGHT - TOP - BOTTOM),
  ];

  /** @param {Point[]} changed @param {string} gesture */
  function report(changed, gesture) {
    if (shown === null || JSON.stringify(changed) === JSON.stringify(shown.points)) return;
    onPoints(changed, gesture);
  }

  /** @param {PointerEvent} event @param {number} index */
  function pressed(event, index) {
    if (event.button !== 0 || drag || shown === null) return;
    event.preventDefault();
    event.stopPropagation();
    gestures += 1;
    const [speed, part] = shown.points[index];
    const from = { x: xOf(speed), y: yOf(part) };
    dragging.begin(event, handles[index], from);
    drag = { index, from, before: shown.points };
    draw();
  }

  /** @param {Place} place @param {boolean} isHeldToOne */
  function follow(place, isHeldToOne) {
    if (!drag || shown === null) return;
    const { index, from, before } = drag;
    const isAcross = Math.abs(place.x - from.x) >= Math.abs(place.y - from.y);
    const [speed, part] = pointAt(place);
    const held = before[index];
    const wanted = /** @type {Point} */ (isHeldToOne ? (isAcross ? [speed, held[1]] : [held[0], part]) : [speed, part]);
    report(movedPoint(shown.points, index, wanted), `slide:ramp.shape.points:${gestures}`);
  }

  /** @param {import('../../ui/dragging.js').DragEnd} how */
  function ended(how) {
    if (!drag) return;
    const { before } = drag;
    drag = null;
    if (how === 'restored') report(before, `slide:ramp.shape.points:${gestures}`);
    onEnd();
    if (shown) show(shown.design, shown.units);
  }

  /** @param {KeyboardEvent} event @param {number} index */
  function typed(event, index) {
    if (event.ctrlKey || event.metaKey || drag || shown === null) return;
    const isRemoved = event.key === 'Delete' || event.key === 'Backspace';
    const changed = isRemoved ? withoutPoint(shown.points, index) : nudgedPoint(shown.points, index, event.key, event);
    if (changed === null && !isRemoved) return;
    event.preventDefault();
    event.stopPropagation();
    if (changed === null) return;
    report(changed, isRemoved ? '' : `step:ramp.shape.points:${index}`);
    if (isRemoved) handles[Math.min(index, handles.length - 1)]?.focus();
  }

  /** @param {PointerEvent} press */
  function pressedOnGround(press) {
    if (!isSecondPress(press) || press.button !== 0 || shown === null) return;
    press.preventDefault();
    const added = withPointAt(shown.points, pointAt(dragging.placeOf(press)), MOST_POINTS);
    report(added.points, '');
    handles[added.index]?.focus({ preventScroll: true });
  }

  /** @param {number} index */
  function createHandle(index) {
    const attributes = { class: 'point', tabindex: 0, role: 'slider', 'aria-valuemin': 0.001, 'aria-valuemax': 1 };
    const handle = svgElement('g', { ...attributes, 'aria-label': `Point ${index + 1} of the drawn acceleration` });
    for (const name of ['hit', 'ring', 'dot']) handle.append(svgElement('circle', { class: name }));
    handle.addEventListener('pointerdown', (event) => pressed(/** @type {PointerEvent} */ (event), index));
    handle.addEventListener('keydown', (event) => typed(/** @type {KeyboardEvent} */ (event), index));
    return handle;
  }

  function draw() {
    if (shown === null) return;
    const { design, units, points: drawn, top } = shown;
    while (handles.length > drawn.length) handles.pop()?.remove();
    while (handles.length < drawn.length) points.append((handles[handles.length] = createHandle(handles.length)));
    const told = (/** @type {'speed' | 'acceleration'} */ quantity, /** @type {number} */ value) =>
      figures(shownValue(units, design, quantity, value));
    const acceleration = Number(design.ramp.acceleration_steps_per_s2);
    scale.replaceChildren(
      ...TICKS.flatMap((part) => gridLine(part % 0.5 ? '' : told('acceleration', part * acceleration), LEFT, WIDTH - RIGHT, yOf(part))),
      chartText(unitWord(units, design, 'acceleration'), WIDTH - RIGHT, TOP - 5, 'end'),
      ...[0, 0.5, 1].map((part) => chartText(told('speed', (part * top) / ROOM), xOf((part * top) / ROOM), HEIGHT - 8, part === 1 ? 'end' : 'middle')),
    );
    const partOf = monotoneCubic(drawn);
    const speeds = Array.from({ length: CURVE_POINTS + 1 }, (_, i) => (top * i) / CURVE_POINTS);
    const places = [...speeds, ...drawn.map(([speed]) => speed)].sort((a, b) => a - b);
    curve.setAttribute('d', `M${places.map((speed) => `${xOf(speed).toFixed(2)},${yOf(partOf(speed)).toFixed(2)}`).join('L')}`);
    drawn.forEach(([speed, part], index) => {
      const handle = handles[index];
      handle.setAttribute('transform', `translate(${xOf(speed)} ${yOf(part)})`);
      handle.setAttribute('aria-valuenow', String(part));
      handle.setAttribute('aria-valuetext', `at ${told('speed', speed)} ${unitWord(units, design, 'speed')}, ${formatFixed(part * 100, 1)} % of the acceleration`);
      handle.classList.toggle('dragged', drag?.index === index);
    });
  }

  /** @param {Design} design @param {Units} units */
  function show(design, units) {
    const drawn = drawablePoints(design.ramp.shape?.points);
    drawing.toggleAttribute('hidden', drawn === null);
    if (drawn === null) {
      if (drag) dragging.finish('left');
      shown = null;
      return;
    }
    const slew = Number(design.ramp.slew_speed_steps_per_s);
    const top = ROOM * Math.max(drawn[drawn.length - 1][0], slew > 0 ? slew : 0) || 1;
    // While a point is dragged the ground must not move.
    shown = { design, units, points: drawn, top: drag && shown ? shown.top : top };
    if (drag && drawn.length !== drag.before.length) dragging.finish('left');
    draw();
  }

  return { element: drawing, show };
}

/** Nothing of what is no number: another field is being typed.
 * @param {number} value */
const figures = (value) => (Number.isNaN(value) ? '' : value === 0 || Math.abs(value) >= 100 ? formatFixed(value) : formatFigures(value, 2));
