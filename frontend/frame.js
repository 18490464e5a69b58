// @ts-check
// Where everything of the figure lies: the ranges of its axes and its place in pixels. Nothing of the page, no Plotly.

import { activeProfile, entriesOf, interpolate, unitsOf } from './curves.js';
import { unitWord } from './units.js';

/** @typedef {import('./types.js').Answer} Answer */
/** @typedef {import('./types.js').MethodName} MethodName */
/** @typedef {import('./curves.js').AxisName} AxisName */
/** @typedef {import('./curves.js').Curve} Curve */
/** @typedef {'velocity' | 'delay' | 'error'} PlotName */
/** @typedef {'whole' | 'start' | 'up' | 'down'} ViewName */
/** What the lowest plot shows: the errors of all methods, the parts of the chosen one's, or how far a measured move lies
 * from its plan.
 * @typedef {'error' | 'parts' | 'deviation'} Third */
/** @typedef {{[name: string]: string}} Colours  of methods by name, "kept", "measured", "axis-0" …, "part-method" …, and
 *   "grid", "plot", "tick", "phase" */
/** @typedef {{x: number[], velocity: number[], delay: number[], deviation: number[]}} Measured  over the axis */
/** @typedef {{label: string, colour: number, x: number[], velocity: number[], delay: number[]}} AxisCurve */

/** @typedef {object} Scene
 * @property {Answer} answer
 * @property {Partial<Record<MethodName, Curve>>} curves  over `axis`; that of the chosen method is always there
 * @property {ReadonlySet<MethodName>} shown         the methods that are drawn
 * @property {AxisName} axis
 * @property {ViewName} view
 * @property {Third} [third]
 * @property {boolean} [acceleration]        whether the velocity plot shows the implied acceleration too
 * @property {Curve | null} [kept]           of the design kept to compare with
 * @property {Measured | null} [measured]
 * @property {{x: number[], velocity: number[]} | null} [live]  a move that runs
 * @property {AxisCurve[] | null} [axes]     all axes over one time instead of one axis' methods
 * @property {[number, number] | null} zoom  in axis units (not logarithms); null: as the view has it
 * @property {{width: number, height: number}} size
 * @property {boolean} compact               one plot at a time, for narrow windows
 * @property {PlotName} only                 the one plot
 * @property {Colours} colours
 * @property {Record<string, string>} dashes  of lines by method, as Plotly wants them
 * @property {string} font
 * @property {Frame | null} [held]           whose ranges stay
 * @property {'firmly' | 'while it fits'} [hold]  how: while a point is dragged the ground must not move at all */

/** @typedef {{low: number, high: number, isLog: boolean}} Range */
/** @typedef {object} PlotFrame
 * @property {PlotName} name
 * @property {string} title
 * @property {string} unit
 * @property {number} top
 * @property {number} height
 * @property {Range} range
 * @property {boolean} isVisible */
/** @typedef {object} Frame
 * @property {number} left
 * @property {number} width
 * @property {number} top
 * @property {number} bottom
 * @property {Range} x
 * @property {Range} full   the range of the view, without zoom
 * @property {PlotFrame[]} plots
 * @property {Range | null} acceleration   the second scale of the velocity plot; null: it has none
 * @property {{name: string, steps: number, from: number, to: number}[]} phases */

/** @type {{name: PlotName, axis: string}[]} */
export const PLOTS = [
  { name: 'velocity', axis: 'y' },
  { name: 'delay', axis: 'y2' },
  { name: 'error', axis: 'y3' },
];

const TITLE_HEIGHT = 26;
// While a slider moves, a range stays as long as its plot is filled so far; a new one has this much room.
const LEAST_FILLED = 0.4;
const ROOM_TO_GROW = 0.5;
// A logarithmic axis of less than this has hardly a number to write at it.
const LEAST_LOG_RATIO = 4;

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

/** @param {PlotFrame} plot @param {number} pixel */
export function yValue(plot, pixel) {
  const share = 1 - (pixel - plot.top) / plot.height;
  const { low, high, isLog } = plot.range;
  return isLog ? low * (high / low) ** share : low + share * (high - low);
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
  const { size, compact, held, hold } = scene;
  const [left, top, bottom] = compact ? [50, 38, 34] : [54, 40, 36];
  const phases = scene.axes ? [] : phasesOf(scene);
  const full = keptRange(held?.full, fullRange(scene, phases), hold);
  const x = scene.zoom ? { ...full, low: scene.zoom[0], high: scene.zoom[1] } : full;
  const ranges = yRanges(scene, x);
  const accelerationBefore = held?.acceleration ?? undefined;
  const acceleration = ranges.acceleration && keptRange(accelerationBefore, ranges.acceleration, hold);
  const right = acceleration ? 50 : compact ? 12 : 14;
  const inner = Math.max(1, size.height - top - bottom);
  const names = visiblePlots(scene);
  const each = (inner - (names.length - 1) * TITLE_HEIGHT) / names.length;
  const plots = PLOTS.map(({ name }) => {
    const place = Math.max(0, names.indexOf(name));
    const before = held?.plots.find((plot) => plot.name === name)?.range;
    const range = keptRange(before, ranges[name], hold);
    return {
      name,
      ...headingOf(scene, name, range),
      range,
      height: each,
      top: top + place * (each + TITLE_HEIGHT),
      isVisible: names.includes(name),
    };
  });
  const width = Math.max(1, size.width - left - right);
  return { left, width, top, bottom, x, full, plots, phases, acceleration };
}

/** @param {Scene} scene @returns {PlotName[]} */
function visiblePlots({ compact, only, axes }) {
  if (!compact) return axes ? ['velocity', 'delay'] : ['velocity', 'delay', 'error'];
  return [axes && only === 'error' ? 'velocity' : only];
}

/** @param {Scene} scene @param {PlotName} name @param {Range} range */
function headingOf({ answer, third }, name, range) {
  const scale = range.isLog ? ', logarithmic' : '';
  if (name === 'velocity') return { title: 'Velocity', unit: unitWord(unitsOf(answer), answer.design, 'speed') };
  if (name === 'delay') return { title: 'Delay per step', unit: `µs${scale}` };
  if (third === 'deviation') return { title: 'Deviation from the plan', unit: 'µs' };
  if (third === 'parts') return { title: 'Parts of the error', unit: '%' };
  return { title: 'Error against exact', unit: '% of the interval' };
}

/** The range that holds: the one before, as long as it may stay.
 * @param {Range | undefined} before @param {Range} wanted @param {Scene['hold']} hold @returns {Range} */
function keptRange(before, wanted, hold) {
  if (!before || !hold || hold === 'firmly') return before ?? wanted;
  const size = (/** @type {Range} */ { low, high, isLog }) => (isLog ? Math.log(high / low) : high - low);
  const fits = wanted.low >= before.low && wanted.high <= before.high && wanted.isLog === before.isLog;
  if (fits && size(wanted) > size(before) * LEAST_FILLED) return before;
  // With room to grow, or each change of a slider would need another range.
  const { low, high, isLog } = wanted;
  const more = size(wanted) * ROOM_TO_GROW;
  if (isLog) return { low: low < before.low ? low / Math.exp(more) : low, high: high * Math.exp(more), isLog };
  return { low: low < before.low ? low - more : low, high: high + more, isLog };
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

/** The range that a view shows.
 * @param {Scene} scene @param {Frame['phases']} phases @returns {Range} */
function fullRange({ curves, axis, view, axes, kept }, phases) {
  const all = [...(axes ?? entriesOf(curves).map(([, curve]) => curve)), ...(kept && !axes ? [kept] : [])];
  const ends = all.flatMap((curve) => [curve.x[0], curve.x[curve.x.length - 1]]);
  const [first, last] = [Math.min(...ends, 0), Math.max(...ends, 0)];
  const margin = (last - first || 1) * 0.004;
  if (view === 'whole' || axes) return { low: first - margin, high: last + margin, isLog: false };
  const [begin, end] = [phases[0].from, phases[phases.length - 1].to];
  const tenth = (end - begin) / 10;
  const up = phases.find((phase) => phase.name === 'accelerate') ?? { from: begin, to: begin + tenth };
  const down = phases.find((phase) => phase.name === 'decelerate') ?? { from: end - tenth, to: end };
  const between = (/** @type {number} */ a, /** @type {number} */ b) => ({
    low: Math.min(a, b),
    high: Math.max(a, b),
    isLog: false,
  });
  if (view === 'start' && axis === 'step') return { low: 0.87, high: Math.max(10, up.to * 1.35), isLog: true };
  if (view === 'start') return between(up.from, up.from + (up.to - up.from) / 8);
  if (view === 'up') return between(up.from - (up.to - up.from) * 0.01, up.to + (up.to - up.from) * 0.15);
  return between(down.from - (down.to - down.from) * 0.15, down.to + (down.to - down.from) * 0.01);
}

/** The ranges of the plots: of whole curves, or of what a zoom shows of them.
 * @param {Scene} scene @param {Range} x @returns {Record<PlotName, Range> & {acceleration: Range | null}} */
function yRanges(scene, x) {
  const span = scene.zoom ? x : null;
  const [velocity, delay, error] = PLOTS.map(({ name }) => extremes(listsOf(scene, name), span));
  const acceleration = scene.acceleration && !scene.axes ? activeCurve(scene).acceleration : null;
  return {
    velocity: linear(velocity, span === null),
    delay: logarithmic(delay),
    error: around(span === null ? [Math.min(error[0], 0), Math.max(error[1], 0)] : error),
    acceleration: acceleration && linear(extremes([[activeCurve(scene).x, acceleration]], span), true),
  };
}

/** @param {Scene} scene @returns {Curve} */
export function activeCurve({ answer, curves }) {
  return /** @type {Curve} */ (curves[answer.design.method.name]);
}

/** The lists of x and y that a plot draws.
 * @param {Scene} scene @param {PlotName} name @returns {[number[], number[]][]} */
function listsOf(scene, name) {
  const { curves, shown: names, axes, kept, measured, third } = scene;
  if (axes) return name === 'error' ? [] : axes.map((one) => [one.x, one[name]]);
  const drawn = entriesOf(curves).filter(([method]) => names.has(method));
  const all = [...(drawn.length > 0 ? drawn.map(([, curve]) => curve) : [activeCurve(scene)]), ...(kept ? [kept] : [])];
  if (name === 'velocity')
    return [...all.map(each('shownSpeed')), ...(measured ? [pair(measured.x, measured.velocity)] : [])];
  if (name === 'delay') return [...all.map(each('delay_us')), ...(measured ? [pair(measured.x, measured.delay)] : [])];
  if (third === 'deviation') return measured ? [[measured.x, measured.deviation]] : [];
  const { x, parts, error } = activeCurve(scene);
  if (third === 'parts')
    return [pair(error.x, error.percent), ...Object.values(parts ?? {}).map((part) => pair(x, part))];
  return all.map((curve) => [curve.error.x, curve.error.percent]);
}

/** @param {number[]} x @param {number[]} y @returns {[number[], number[]]} */
const pair = (x, y) => [x, y];
/** @param {'shownSpeed' | 'delay_us'} name @returns {(curve: Curve) => [number[], number[]]} */
const each = (name) => (curve) => [curve.x, curve[name]];

/** @param {[number, number]} ends @param {boolean} fromZero @returns {Range} */
function linear([low, high], fromZero) {
  if (!fromZero) return around([low, high]);
  const room = (Math.max(high, 0) - Math.min(low, 0) || 1) * 0.12;
  return { low: low < 0 ? low - room : 0, high: Math.max(high, 0) + room, isLog: false };
}

/** @param {[number, number]} ends @returns {Range} */
function logarithmic([low, high]) {
  if (high < low * LEAST_LOG_RATIO) return around([low, high]);
  return { low: low * 0.75, high: high * 1.35, isLog: true };
}

/** @param {[number, number]} ends @returns {Range} */
function around([low, high]) {
  if (!(low <= high)) return { low: -1, high: 1, isLog: false };
  const room = Math.max((high - low) * 0.09, 1e-6 * Math.abs(high), 0.01);
  return { low: low - room, high: high + room, isLog: false };
}

/** Least and greatest of several lists, or of what lies between two places.
 * @param {[number[], number[]][]} lists @param {Range | null} span @returns {[number, number]} */
function extremes(lists, span) {
  let [low, high] = [Infinity, -Infinity];
  for (const [x, y] of lists) {
    for (let i = 0; i < y.length; i += 1) {
      if (span !== null && (x[i] < span.low || x[i] > span.high)) continue;
      if (y[i] < low) low = y[i];
      if (y[i] > high) high = y[i];
    }
  }
  // Between two points, a stretch of equal delays may have none of its own.
  return low > high && span !== null ? extremes(lists, null) : [low, high];
}

/** The steps that a frame shows: first and last.
 * @param {Curve} curve @param {Range} x @returns {[number, number]} */
export function stepsIn(curve, x) {
  const places = curve.x[curve.x.length - 1] < curve.x[0] ? [x.high, x.low] : [x.low, x.high];
  const rising = places[0] > places[1] ? curve.x.map((value) => -value) : curve.x;
  const [first, last] = places.map((place) => interpolate(rising, curve.step, rising === curve.x ? place : -place));
  return [Math.max(1, Math.floor(first)), Math.ceil(last)];
}
