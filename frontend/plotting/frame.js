// @ts-check
// Where everything of the figure lies: the ranges of its axes and its place in pixels. Nothing of the page, no Plotly.

import { activeProfile, entriesOf, interpolate } from './curves.js';
import { isOfMotion, onePlot, PLOTS, plotsShowing, plotsThere } from './plots.js';

/** @typedef {import('../model/types.js').Answer} Answer */
/** @typedef {import('../model/types.js').MethodName} MethodName */
/** @typedef {import('./curves.js').PlotAxis} PlotAxis */
/** @typedef {import('./curves.js').Curve} Curve */
/** @typedef {string} PlotName  of one of PLOTS */
/** @typedef {'whole' | 'start' | 'up' | 'down'} ViewName */
/** What the lowest plot shows: the errors of all methods, the parts of the chosen one's, or how far a measured move lies
 * from its plan, or what is planned of acceleration and jerk.
 * @typedef {import('../model/types.js').View['third']} Third */
/** @typedef {{[name: string]: string}} Colours  of methods by name, "pinned", "measured", "axis-0" …, "part-method" …, and
 *   "grid", "plot", "tick", "phase" */
/** @typedef {{x: number[], velocity: number[], delay: number[], deviation: number[]}} Measured  over the axis */
/** What a controller plays itself, its error against the plan [%].
 * @typedef {{x: number[], velocity: number[], delay: number[], error: number[]}} OwnCurve */
/** @typedef {{label: string, colour: number, x: number[], velocity: number[], delay: number[]}} AxisCurve */

/** @typedef {object} Scene
 * @property {Answer} answer
 * @property {Partial<Record<MethodName, Curve>>} curves  over `against`; that of the chosen method is always there
 * @property {ReadonlySet<MethodName>} shown         the methods that are drawn
 * @property {PlotAxis} against
 * @property {ViewName} view
 * @property {Third} [third]
 * @property {boolean} [acceleration]        whether the velocity plot shows the implied acceleration too
 * @property {Curve | null} [pinned]           of the pinned design
 * @property {(Curve | null)[]} [beside]      revisions of the library that are laid beside it
 * @property {OwnCurve | null} [own]         what the controller in view plays itself
 * @property {Measured | null} [measured]
 * @property {import('./captured.js').CapturedCurve | null} [captured]
 * @property {{x: number[], velocity: number[]} | null} [live]  what was told of a move that rests
 * @property {{x: number, velocity: number} | null} [reach]  how far one of another ramp goes that runs, and how fast it gets
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

const TITLE_HEIGHT = 26;
// While a slider moves, a range stays as long as its plot is filled so far; a new one has this much room.
const LEAST_FILLED = 0.4;
const ROOM_TO_GROW = 0.5;
// A logarithmic axis of less than this has hardly a number to write at it.
const LEAST_LOG_RATIO = 4;
// Of motion, what goes beyond the chosen method's by so much is cut off.
const MOST_BESIDE = 1.5;
// Of errors, what a table or a pinned design goes beyond those of the other methods by so much is cut off, but nothing below this.
const MOST_FAR_OFF = 3;
const NOT_FAR_OFF_PERCENT = 100;

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

/** The range after zooming by a factor about a pixel, within the view; null when that is the whole view.
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
  const full = heldRange(held?.full, fullRange(scene, phases), hold);
  const x = scene.zoom ? { ...full, low: scene.zoom[0], high: scene.zoom[1] } : full;
  const { ranges, acceleration: accelerationWanted } = yRanges(scene, x);
  const accelerationBefore = held?.acceleration ?? undefined;
  const acceleration = accelerationWanted && heldRange(accelerationBefore, accelerationWanted, hold);
  const right = acceleration ? 50 : compact ? 12 : 14;
  const inner = Math.max(1, size.height - top - bottom);
  const names = visiblePlots(scene);
  const each = (inner - (names.length - 1) * TITLE_HEIGHT) / names.length;
  const plots = PLOTS.map(({ name }) => {
    const place = Math.max(0, names.indexOf(name));
    const before = held?.plots.find((plot) => plot.name === name)?.range;
    const range = heldRange(before, ranges[name], hold);
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
  return compact ? [onePlot(only, !!axes)] : plotsThere(!!axes).map(({ name }) => name);
}

/** @param {PlotName} name @param {Third} [third] */
function plotOf(name, third) {
  return plotsShowing(third).find((plot) => plot.name === name) ?? PLOTS[0];
}

/** @param {Scene} scene @param {PlotName} name @param {Range} range */
function headingOf({ answer, third }, name, range) {
  if (name === 'error' && third === 'deviation') return { title: 'Deviation from the plan', unit: 'µs' };
  if (name === 'error' && third === 'parts') return { title: 'Parts of the error', unit: '%' };
  const { title, unit } = plotOf(name, third);
  return { title, unit: `${unit(answer)}${range.isLog ? ', logarithmic' : ''}` };
}

/** The range that holds: the one before, as long as it may stay.
 * @param {Range | undefined} before @param {Range} wanted @param {Scene['hold']} hold @returns {Range} */
function heldRange(before, wanted, hold) {
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
function fullRange({ curves, against, view, axes, pinned, beside: laid = [], captured, own, live, reach }, phases) {
  const beside = axes ? [] : [pinned, ...laid, captured, own, live].flatMap((one) => (one && one.x.length > 0 ? [one] : []));
  const all = [...(axes ?? entriesOf(curves).map(([, curve]) => curve)), ...beside];
  const ends = all.flatMap((curve) => [curve.x[0], curve.x[curve.x.length - 1]]);
  const [first, last] = [Math.min(...ends, reach?.x ?? 0, 0), Math.max(...ends, reach?.x ?? 0, 0)];
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
  if (view === 'start' && against === 'step') return { low: 0.87, high: Math.max(10, up.to * 1.35), isLog: true };
  if (view === 'start') return between(up.from, up.from + (up.to - up.from) / 8);
  if (view === 'up') return between(up.from - (up.to - up.from) * 0.01, up.to + (up.to - up.from) * 0.15);
  return between(down.from - (down.to - down.from) * 0.15, down.to + (down.to - down.from) * 0.01);
}

/** The ranges of the plots: of whole curves, or of what a zoom shows of them.
 * @param {Scene} scene @param {Range} x @returns {{ranges: Record<PlotName, Range>, acceleration: Range | null}} */
function yRanges(scene, x) {
  const span = scene.zoom ? x : null;
  const acceleration = scene.acceleration && !scene.axes ? activeCurve(scene).acceleration : null;
  const ranges = PLOTS.map(({ name, scale }) => {
    const ends = extremes(listsOf(scene, name), span);
    return [name, scaled(scale, name === 'error' ? readable(scene, ends, span) : ends, span === null)];
  });
  return {
    ranges: Object.fromEntries(ranges),
    acceleration: acceleration && linear(extremes([[activeCurve(scene).x, acceleration]], span), true),
  };
}

/** Ends of the lowest plot that nothing far off makes a line of.
 * @param {Scene} scene @param {[number, number]} ends of all that is drawn @param {Range | null} span
 * @returns {[number, number]} */
function readable(scene, ends, span) {
  if (isOfMotion(scene.third ?? 'error')) return aboutActive(scene, ends, span);
  return (scene.third ?? 'error') === 'error' && !scene.axes ? withoutFarOff(scene, ends, span) : ends;
}

/** Ends that show the errors of formulas well beside a table of another ramp, whose errors are a hundred times theirs.
 * @param {Scene} scene @param {[number, number]} ends of all that is drawn @param {Range | null} span
 * @returns {[number, number]} */
function withoutFarOff(scene, [low, high], span) {
  const near = new Set([...scene.shown].filter((method) => method !== 'table' || method === scene.answer.design.method.name));
  const others = extremes(listsOf({ ...scene, shown: near, pinned: null, beside: [] }, 'error'), span);
  const largest = Math.max(Math.abs(others[0]), Math.abs(others[1]));
  const most = Math.max(MOST_FAR_OFF * largest, NOT_FAR_OFF_PERCENT);
  return largest > 0 ? [Math.max(low, -most), Math.min(high, most)] : [low, high];
}

/** Ends that show the chosen method's motion well: a table leaps at each row, and would make a line of all that is smooth.
 * @param {Scene} scene @param {[number, number]} ends of all that is drawn @param {Range | null} span
 * @returns {[number, number]} */
function aboutActive(scene, [low, high], span) {
  const { x, y } = plotOf('error', scene.third).curve(activeCurve(scene));
  const own = extremes([[x, y]], span);
  const most = MOST_BESIDE * Math.max(Math.abs(own[0]), Math.abs(own[1]));
  return most > 0 ? [Math.max(low, Math.min(own[0], -most)), Math.min(high, Math.max(own[1], most))] : [low, high];
}

/** @param {import('./plots.js').Plot['scale']} scale @param {[number, number]} ends @param {boolean} isWhole @returns {Range} */
function scaled(scale, ends, isWhole) {
  if (scale === 'logarithmic') return logarithmic(ends);
  if (scale === 'from zero') return linear(ends, isWhole);
  return around(isWhole ? [Math.min(ends[0], 0), Math.max(ends[1], 0)] : ends);
}

/** @param {Scene} scene @returns {Curve} */
export function activeCurve({ answer, curves }) {
  return /** @type {Curve} */ (curves[answer.design.method.name]);
}

/** The lists of x and y that a plot draws.
 * @param {Scene} scene @param {PlotName} name @returns {[number[], number[]][]} */
function listsOf(scene, name) {
  const { curves, shown: names, axes, pinned, beside = [], third, own, live, reach } = scene;
  const { curve, measured: ofMeasured, own: ofOwn, ofAxis } = plotOf(name, third);
  if (axes) return ofAxis === null ? [] : axes.map((one) => [one.x, ofAxis(one)]);
  const drawn = entriesOf(curves).filter(([method]) => names.has(method));
  const all = [...(drawn.length > 0 ? drawn.map(([, curve]) => curve) : [activeCurve(scene)]), ...[pinned, ...beside].flatMap((one) => one ?? [])];
  const measured = [scene.measured, scene.captured].flatMap((one) => one ?? []);
  if (name === 'error' && third === 'deviation') return measured.map((one) => pair(one.x, one.deviation));
  const { x, parts, error } = activeCurve(scene);
  if (name === 'error' && third === 'parts')
    return [pair(error.x, error.percent), ...Object.values(parts ?? {}).map((part) => pair(x, part))];
  const isOwnThere = own && (name !== 'error' || (third ?? 'error') === 'error');
  const drawnLists = all.map((one) => pair(curve(one).x, curve(one).y));
  if (isOwnThere) drawnLists.push(pair(own.x, ofOwn(own)));
  if (name === 'velocity' && live) drawnLists.push(pair(live.x, live.velocity));
  if (name === 'velocity' && reach) drawnLists.push(pair([reach.x], [reach.velocity]));
  return ofMeasured ? [...drawnLists, ...measured.map((one) => pair(one.x, ofMeasured(one)))] : drawnLists;
}

/** @param {number[]} x @param {number[]} y @returns {[number[], number[]]} */
const pair = (x, y) => [x, y];

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
