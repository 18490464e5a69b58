// @ts-check
// The largest error against the number of rows, from which a size is chosen: by pointer, or by keys as on a slider.

import { svgElement } from '../../ui/dom.js';
import { counted, formatFigures } from '../../model/numbers.js';
import { chartText, gridLine } from '../../ui/chart.js';

/** @typedef {import('../../model/types.js').FitCurve} FitCurve */

/** While it isn't known how wide it is shown. */
const USUAL_WIDTH = 420;
const HEIGHT = 132;
const LEFT = 40;
const RIGHT = 12;
const TOP = 10;
const BOTTOM = 26;
const KEYS = /** @type {Record<string, number>} */ ({
  ArrowRight: 1,
  ArrowUp: 1,
  ArrowLeft: -1,
  ArrowDown: -1,
  PageUp: 5,
  PageDown: -5,
  Home: -Infinity,
  End: Infinity,
});

/** @param {(rows: number) => void} onChoose */
export function createFitChart(onChoose) {
  /** @type {FitCurve | null} */
  let curve = null;
  /** Index of the size that is chosen, in the curve; -1: none of them. */
  let chosen = -1;
  let width = USUAL_WIDTH;
  const drawing = svgElement('svg', {
    class: 'small-chart',
    tabindex: 0,
    role: 'slider',
    'aria-label': 'Largest error against rows',
  });
  // As wide as it is shown, so that its texts are as large as any.
  if (typeof ResizeObserver !== 'undefined') new ResizeObserver(() => drawing.clientWidth !== width && draw()).observe(drawing);
  drawing.addEventListener('pointerdown', (event) => {
    drawing.setPointerCapture(event.pointerId);
    pointed(event);
  });
  drawing.addEventListener('pointermove', (event) => {
    if (drawing.hasPointerCapture(event.pointerId)) pointed(event);
  });
  drawing.addEventListener('keydown', (event) => {
    if (curve === null || !(event.key in KEYS)) return;
    event.preventDefault();
    choose(chosen + KEYS[event.key]);
  });

  /** @param {PointerEvent} event */
  function pointed(event) {
    if (curve === null) return;
    const box = drawing.getBoundingClientRect();
    const at = ((event.clientX - box.left) / box.width) * width;
    const distances = curve.rows.map((_, index) => Math.abs(xOf(index) - at));
    choose(distances.indexOf(Math.min(...distances)));
  }

  /** @param {number} index */
  function choose(index) {
    const { rows } = /** @type {FitCurve} */ (curve);
    const place = Math.min(rows.length - 1, Math.max(0, index));
    if (place !== chosen) onChoose(rows[place]);
  }

  /** @param {number} index */
  function xOf(index) {
    const count = curve?.rows.length ?? 1;
    return LEFT + (count === 1 ? 0.5 : index / (count - 1)) * (width - LEFT - RIGHT);
  }

  /** @param {number} error a fraction; errors are shown by powers, as each more row takes off a share */
  function yOf(error) {
    const { low, high } = range();
    return TOP + (Math.log(high / Math.max(error, low)) / Math.log(high / low)) * (HEIGHT - TOP - BOTTOM);
  }

  function range() {
    const errors = curve?.largest_relative_error ?? [];
    const high = Math.max(...errors, 1e-6);
    return { low: Math.min(high / 10, Math.max(high * 1e-4, Math.min(...errors))), high };
  }

  function draw() {
    drawing.replaceChildren();
    width = drawing.clientWidth || USUAL_WIDTH;
    drawing.setAttribute('viewBox', `0 0 ${width} ${HEIGHT}`);
    if (curve === null) return;
    const { low, high } = range();
    const parts = high / low > 100 ? [1] : [1, 2, 5];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
      for (const error of parts.map((part) => Number(`${part}e${power}`))) {
        const text = `${formatFigures(error * 100, 1)} %`;
        if (error >= low && error <= high) drawing.append(...gridLine(text, LEFT, width - RIGHT, yOf(error)));
      }
    }
    const floor = curve.floor.relative_error;
    if (floor >= low) {
      const y = yOf(floor);
      drawing.append(svgElement('line', { class: 'floor', x1: LEFT, x2: width - RIGHT, y1: y, y2: y }));
    }
    const points = curve.largest_relative_error.map((error, index) => `${xOf(index)},${yOf(error)}`);
    drawing.append(svgElement('polyline', { class: 'line', points: points.join(' ') }));
    curve.rows.forEach(drawPoint);
  }

  /** @param {number} rows @param {number} index */
  function drawPoint(rows, index) {
    const { rows: all, largest_relative_error } = /** @type {FitCurve} */ (curve);
    const isChosen = index === chosen;
    const at = { cx: xOf(index), cy: yOf(largest_relative_error[index]), r: isChosen ? 5 : 2.5 };
    drawing.append(svgElement('circle', { class: isChosen ? 'dot chosen' : 'dot', ...at }));
    const isLabelled = rows === 1 || rows % 8 === 0 || index === all.length - 1;
    const isCrowded = index === all.length - 1 && rows % 8 < 3 && rows % 8 > 0 && rows > 8;
    if (isLabelled && !isCrowded) drawing.append(chartText(String(rows), xOf(index), HEIGHT - 8, 'middle'));
  }

  return {
    element: drawing,
    /** @param {FitCurve | null} shown @param {number} rows of the present fit; 0: there is none */
    show(shown, rows) {
      curve = shown;
      chosen = curve === null ? -1 : curve.rows.indexOf(rows);
      drawing.setAttribute('aria-valuemin', String(curve?.rows[0] ?? 1));
      drawing.setAttribute('aria-valuemax', String(curve?.rows.at(-1) ?? 1));
      drawing.setAttribute('aria-valuenow', String(rows));
      const error = chosen < 0 ? '' : `, ${formatFigures((curve?.largest_relative_error[chosen] ?? 0) * 100, 3)} %`;
      drawing.setAttribute('aria-valuetext', `${counted(rows, 'row')}${error}`);
      draw();
    },
  };
}
