// @ts-check
// Where everything of the figure lies: the ranges of its axes and its place in pixels. Nothing of the page, no Plotly.

import { activeProfile, interpolate } from './curves.js';

/** @typedef {import('./types.js').Answer} Answer */
/** @typedef {import('./types.js').MethodName} MethodName */
/** @typedef {import('./curves.js').AxisName} AxisName */
/** @typedef {import('./curves.js').Curve} Curve */
/** @typedef {'velocity' | 'delay' | 'error'} PlotName */
/** @typedef {'whole' | 'start' | 'up' | 'down'} ViewName */
/** @typedef {{[name: string]: string}} Colours  of methods by name, and "grid", "plot", "tick", "phase" */

/** @typedef {object} Scene
 * @property {Answer} answer
 * @property {Partial<Record<MethodName, Curve>>} curves  over `axis`; that of the chosen method is always there
 * @property {ReadonlySet<MethodName>} shown         the methods that are drawn
 * @property {AxisName} axis
 * @property {ViewName} view
 * @property {[number, number] | null} zoom  in axis units (not logarithms); null: as the view has it
 * @property {{width: number, height: number}} size
 * @property {boolean} compact               one plot at a time, for narrow windows
 * @property {PlotName} only                 the one plot
 * @property {Colours} colours
 * @property {Record<string, string>} dashes  of lines by method, as Plotly wants them
 * @property {string} font
 * @property {boolean} moving                while a slider moves: fewer points a line, quicker */

/** @typedef {{low: number, high: number, isLog: boolean}} Range */
/** @typedef {{name: PlotName, top: number, height: number, range: Range, isVisible: boolean}} PlotFrame */
/** @typedef {object} Frame
 * @property {number} left
 * @property {number} width
 * @property {number} top
 * @property {number} bottom
 * @property {Range} x
 * @property {Range} full   the range of the view, without zoom
 * @property {PlotFrame[]} plots
 * @property {{name: string, steps: number, from: number, to: number}[]} phases */

export const PLOTS = [
  { name: 'velocity', title: 'Velocity', unit: 'steps/s', axis: 'y' },
  { name: 'delay', title: 'Delay per step', unit: 'µs, logarithmic', axis: 'y2' },
  { name: 'error', title: 'Error against exact', unit: '% of the interval', axis: 'y3' },
];

const TITLE_HEIGHT = 26;

/** @param {Range} range @param {number} value share of the range, 0 at its low end */
function shareOf({ low, high, isLog }, value) {
  return isLog ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
}

/** @param {Frame} frame @param {number} x */
export function xPixel(frame, x) {
  return frame.left + shareOf(frame.x, x) * frame.width;
}

/** @param {Frame} frame @param {number} pixel */
export function xValue(frame, pixel) {
  const share = (pixel - frame.left) / frame.width;
  const { low, high, isLog } = frame.x;
  return isLog ? low * (high / low) ** share : low + share * (high - low);
}

/** @param {PlotFrame} plot @param {number} value */
export function yPixel(plot, value) {
  return plot.top + (1 - shareOf(plot.range, value)) * plot.height;
}

/** The range after zooming by a factor about a pixel, kept within the view; null when that is the whole view.
 * @param {Frame} frame @param {number} pixel @param {number} factor under 1 zooms in
 * @returns {[number, number] | null} */
export function zoomedAbout(frame, pixel, factor) {
  const share = (pixel - frame.left) / frame.width;
  const at = (/** @type {number} */ part) => xValue(frame, frame.left + part * frame.width);
  const low = Math.max(frame.full.low, at(share - share * factor));
  const high = Math.min(frame.full.high, at(share + (1 - share) * factor));
  if (low <= frame.full.low && high >= frame.full.high) return null;
  return high - low > 1e-9 * Math.abs(high) ? [low, high] : [frame.x.low, frame.x.high];
}

/** @param {Scene} scene @returns {Frame} */
export function frameOf(scene) {
  const { size, compact, only } = scene;
  const margin = compact ? { left: 50, right: 12, top: 38, bottom: 34 } : { left: 54, right: 14, top: 40, bottom: 36 };
  const width = Math.max(1, size.width - margin.left - margin.right);
  const inner = Math.max(1, size.height - margin.top - margin.bottom);
  const each = compact ? inner : (inner - (PLOTS.length - 1) * TITLE_HEIGHT) / PLOTS.length;
  const ranges = yRanges(scene);
  const plots = PLOTS.map((plot, index) => ({
    name: /** @type {PlotName} */ (plot.name),
    range: ranges[/** @type {PlotName} */ (plot.name)],
    height: each,
    top: margin.top + (compact ? 0 : index * (each + TITLE_HEIGHT)),
    isVisible: !compact || plot.name === only,
  }));
  const phases = phasesOf(scene);
  const full = fullRange(scene, phases);
  const x = scene.zoom ? { ...full, low: scene.zoom[0], high: scene.zoom[1] } : full;
  return { left: margin.left, width, top: margin.top, bottom: margin.bottom, x, full, plots, phases };
}

/** @param {Scene} scene */
function phasesOf({ answer, curves }) {
  const { phases } = activeProfile(answer);
  const curve = /** @type {Curve} */ (curves[answer.design.method.name]);
  const place = (/** @type {number} */ step) => interpolate(curve.step, curve.x, step);
  return phases.map((phase, index) => ({
    name: phase.name,
    steps: phase.last_step - phase.first_step + 1,
    from: place(phase.first_step),
    to: place(index + 1 < phases.length ? phases[index + 1].first_step : phase.last_step),
  }));
}

/** The range that a view shows. @param {Scene} scene @param {Frame['phases']} phases @returns {Range} */
function fullRange({ curves, axis, view }, phases) {
  const ends = Object.values(curves).flatMap((curve) => [curve.x[0], curve.x[curve.x.length - 1]]);
  const [first, last] = [Math.min(...ends, 0), Math.max(...ends, 0)];
  const all = last - first || 1;
  const up = phases.find((phase) => phase.name === 'accelerate') ?? {
    from: phases[0].from,
    to: phases[0].from + (phases[phases.length - 1].to - phases[0].from) / 10,
  };
  const down = phases.find((phase) => phase.name === 'decelerate') ?? {
    from: phases[phases.length - 1].to - (phases[phases.length - 1].to - phases[0].from) / 10,
    to: phases[phases.length - 1].to,
  };
  const between = (/** @type {number} */ a, /** @type {number} */ b) => ({
    low: Math.min(a, b),
    high: Math.max(a, b),
    isLog: false,
  });
  if (view === 'start' && axis === 'step') return { low: 0.87, high: Math.max(10, up.to * 1.35), isLog: true };
  if (view === 'start') return between(up.from, up.from + (up.to - up.from) / 8);
  if (view === 'up') return between(up.from - (up.to - up.from) * 0.01, up.to + (up.to - up.from) * 0.15);
  if (view === 'down') return between(down.from - (down.to - down.from) * 0.15, down.to + (down.to - down.from) * 0.01);
  return { low: first - all * 0.004, high: last + all * 0.004, isLog: false };
}

/** @param {Scene} scene @returns {Record<PlotName, Range>} */
function yRanges({ answer, curves, shown: names }) {
  const drawn = Object.entries(curves)
    .filter(([name]) => names.has(/** @type {MethodName} */ (name)))
    .map(([, curve]) => curve);
  const shown = drawn.length > 0 ? drawn : [/** @type {Curve} */ (curves[answer.design.method.name])];
  const [, fastest] = extremes(shown.map((curve) => curve.speed));
  const [shortest, longest] = extremes(shown.map((curve) => curve.delay_us));
  const [least, most] = extremes(shown.map((curve) => curve.error.percent));
  const pad = Math.max((most - least) * 0.09, 0.01);
  return {
    velocity: { low: 0, high: fastest * 1.12, isLog: false },
    delay: { low: shortest * 0.75, high: longest * 1.35, isLog: true },
    error: { low: Math.min(least, 0) - pad, high: Math.max(most, 0) + pad, isLog: false },
  };
}

/** Least and greatest of several lists. @param {number[][]} lists @returns {[number, number]} */
function extremes(lists) {
  let [low, high] = [Infinity, -Infinity];
  for (const list of lists) {
    for (const value of list) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return [low, high];
}
