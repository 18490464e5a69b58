// @ts-check
// Every line of the figure, in the order of drawing: the pinned design beneath, then the reference, the other methods, the
// chosen one, and on top what was measured. Nothing of the page, no Plotly.

import { MARKS } from './captured.js';
import { activeCurve, stepsIn, xPixel } from './frame.js';
import { isOfMotion, PLOTS, plotsShowing } from './plots.js';
import { METHODS, methodOf, REFERENCE } from '../model/methods.js';

/** @typedef {import('../model/types.js').MethodName} MethodName */
/** @typedef {import('./curves.js').Curve} Curve */
/** @typedef {import('./curves.js').ErrorPart} ErrorPart */
/** @typedef {import('./frame.js').Frame} Frame */
/** @typedef {import('./frame.js').PlotName} PlotName */
/** @typedef {import('./frame.js').Scene} Scene */
/** @typedef {import('./thinning.js').Shape} Shape */

/** @typedef {object} Line
 * @property {string} uid     such as "first_order-delay"
 * @property {string} name
 * @property {PlotName} plot   or "acceleration", over the velocity
 * @property {number[]} x
 * @property {number[]} y
 * @property {Shape} shape
 * @property {string} colour
 * @property {string} dash
 * @property {number} width   [px]
 * @property {boolean} [isDots]  points that no line joins
 * @property {string} [symbol]  of the points, as Plotly calls it
 * @property {boolean} isVisible */

/** @typedef {Pick<Line, 'colour' | 'dash' | 'width' | 'isDots' | 'symbol'>} Look */

// So far apart, steps are seen as steps and not as a curve [px].
const STEP_SEEN_PX = 5;
const PINNED_DASH = '4px, 3px';
/** Of revisions that are laid beside the design in hand, in their order: each told from the others, and from what is pinned. */
export const BESIDE_DASHES = ['2px, 2px', '9px, 3px', '9px, 3px, 2px, 3px', '2px, 5px'];
const OWN_LOOK = { dash: '6px, 2px', width: 1.6 };
const STALE_DASH = '2px, 3px';
// Lines that join fewer samples would show corners of a ramp where there are none.
export const FEWEST_JOINED = 10;

/** @type {[ErrorPart, string][]} */
export const PARTS = [
  ['method', 'solid'],
  ['arithmetic', '7px, 3px'],
  ['rounding', '2px, 2px'],
  ['compression', '5px, 2px, 1px, 2px'],
];

/** The order of drawing: the reference at the bottom, the chosen method on top.
 * @param {MethodName} active @returns {MethodName[]} */
export function drawingOrder(active) {
  const others = METHODS.map((method) => method.name).filter((name) => name !== REFERENCE && name !== active);
  return active === REFERENCE ? [...others, REFERENCE] : [REFERENCE, ...others, active];
}

/** @param {Scene} scene @param {Frame} frame @returns {Line[]} */
export function linesOf(scene, frame) {
  const lines = scene.axes ? axesLines(scene) : methodLines(scene, frame);
  const visible = frame.plots.filter((plot) => plot.isVisible).map((plot) => plot.name);
  return lines.map((line) => {
    const plot = line.plot === 'acceleration' ? 'velocity' : line.plot;
    return { ...line, isVisible: line.isVisible && line.x.length > 0 && visible.includes(plot) };
  });
}

/** Whether the steps in view are so few that each is drawn as a step of its own.
 * @param {Scene} scene @param {Frame} frame */
function areStepsSeen(scene, frame) {
  const curve = activeCurve(scene);
  const [first, last] = stepsIn(curve, frame.x);
  const fromStep = scene.against === 'step' ? xPixel(frame, last) - xPixel(frame, last - 1) : frame.width / (last - first);
  return fromStep >= STEP_SEEN_PX;
}

/** @param {Scene} scene @param {Frame} frame @returns {Line[]} */
function methodLines(scene, frame) {
  const { answer, curves, shown, colours, dashes, third = 'error', pinned, beside = [], measured, live, own } = scene;
  const active = answer.design.method.name;
  // An interval follows its pulse in time; over steps it lies about its step.
  const step = areStepsSeen(scene, frame) ? (scene.against === 'time' ? 'hv' : 'hvh') : 'linear';
  /** @type {Line[]} */
  const lines = [];
  if (pinned)
    lines.push(...inAllPlots('pinned', pinned, { colour: colours.pinned, dash: PINNED_DASH, width: 1.5 }, step, true, third));
  beside.forEach((curve, index) => {
    const look = { colour: colours.pinned, dash: BESIDE_DASHES[index], width: 1.5 };
    lines.push(...inAllPlots(`beside-${index}`, curve ?? undefined, look, step, true, third));
  });
  if (own) lines.push(...ownLines(own, third, colours, step));
  for (const name of drawingOrder(active)) {
    const look = {
      colour: colours[name],
      dash: dashes[name],
      width: name === active ? 2.25 : name === REFERENCE ? 2 : 1.4,
    };
    // A table holds its delay up to a row's last step and then jumps: its line is a staircase.
    const shape = step === 'linear' && methodOf(name).plays_table ? 'vh' : step;
    // The parts are those of the chosen method's error, which stays with them.
    const lowest = third === 'parts' && name === active ? 'error' : third;
    lines.push(...inAllPlots(name, curves[name], look, shape, shown.has(name), lowest));
  }
  const { x, acceleration, parts } = activeCurve(scene);
  const add = (
    /** @type {string} */ uid,
    /** @type {Line['plot']} */ plot,
    /** @type {number[]} */ across,
    /** @type {number[]} */ y,
    /** @type {Look} */ look,
    /** @type {Shape} */ shape = 'linear',
  ) => lines.push({ uid, name: uid, plot, x: across, y, shape, ...look, isVisible: true });
  if (scene.acceleration && acceleration)
    add(
      'implied-acceleration',
      'acceleration',
      x,
      acceleration,
      { colour: colours.tick, dash: '1px, 2px', width: 1.4 },
      step,
    );
  if (third === 'parts' && parts)
    for (const [part, dash] of PARTS)
      add(`part-${part}`, 'error', x, parts[part], { colour: colours[`part-${part}`], dash, width: 1.6 }, step);
  if (scene.captured) lines.push(...capturedLines(scene.captured, third, colours));
  const reality = { colour: colours.measured, dash: 'solid', width: 1.4 };
  if (measured) {
    for (const { name, measured: drawnOf } of PLOTS)
      if (drawnOf) add(`measured-${name}`, name, measured.x, drawnOf(measured), reality);
    if (third === 'deviation') add('measured-deviation', 'error', measured.x, measured.deviation, reality);
  }
  if (live) {
    const isDots = live.x.length < FEWEST_JOINED;
    add('live-velocity', 'velocity', live.x, live.velocity, { ...reality, width: 2, isDots });
  }
  return lines;
}

/** What a controller plays itself.
 * @param {import('./frame.js').OwnCurve} own @param {import('./frame.js').Third} third
 * @param {import('./frame.js').Colours} colours @param {Shape} step @returns {Line[]} */
function ownLines(own, third, colours, step) {
  const look = { ...OWN_LOOK, colour: colours.own, name: 'own', x: own.x };
  return PLOTS.map(({ name: plot, own: drawnOf }) => ({
    ...look,
    uid: `own-${plot}`,
    plot,
    y: drawnOf(own),
    shape: plot === 'error' ? 'linear' : step,
    isVisible: plot !== 'error' || third === 'error',
  }));
}

/** What an analyser saw, and what it marks; dashed while it is of an earlier design.
 * @param {import('./captured.js').CapturedCurve} captured @param {import('./frame.js').Third} third
 * @param {import('./frame.js').Colours} colours @returns {Line[]} */
function capturedLines(captured, third, colours) {
  const { x, deviation, marks, isStale } = captured;
  const look = { colour: colours.capture, dash: isStale ? STALE_DASH : 'solid', width: 1.4 };
  const common = { name: 'capture', shape: /** @type {Shape} */ ('linear'), isVisible: true };
  const drawn = PLOTS.flatMap(({ name: plot, measured }) =>
    measured ? [{ ...common, ...look, uid: `capture-${plot}`, plot, x, y: measured(captured) }] : [],
  );
  const apart = { ...common, ...look, uid: 'capture-deviation', plot: 'error', x, y: deviation };
  const marked = Object.entries(marks).flatMap(([mark, { x: at, ...values }]) =>
    Object.entries(values).map(([plot, y]) => {
      const { symbol } = MARKS[/** @type {keyof typeof MARKS} */ (mark)];
      return { ...common, ...look, uid: `capture-${mark}-${plot}`, plot, x: at, y, symbol, isDots: true, colour: colours[`capture-${mark}`] };
    }),
  );
  return [...drawn, ...(third === 'deviation' ? [apart] : []), ...marked];
}

/** One curve in all plots.
 * @param {string} name @param {Curve | undefined} curve @param {Look} look @param {Shape} shape @param {boolean} isShown
 * @param {import('./frame.js').Third} third @returns {Line[]} */
function inAllPlots(name, curve, look, shape, isShown, third) {
  return plotsShowing(third).map(({ name: plot, curve: drawnOf }) => {
    const drawn = curve && drawnOf(curve);
    const isPlanned = plot === 'error' && isOfMotion(third);
    return {
      uid: `${name}-${isPlanned ? third : plot}`,
      name,
      plot,
      x: drawn?.x ?? [],
      y: drawn?.y ?? [],
      shape: plot === 'error' && (shape === 'vh' || isPlanned) ? 'linear' : shape,
      ...look,
      isVisible: curve !== undefined && isShown && (plot !== 'error' || third === 'error' || isPlanned),
    };
  });
}

/** @param {Scene} scene @returns {Line[]} */
function axesLines({ axes, colours }) {
  return (axes ?? []).flatMap((axis, index) =>
    PLOTS.flatMap(({ name: plot, ofAxis }) => {
      if (ofAxis === null) return [];
      const look = { colour: colours[`axis-${axis.colour}`], dash: 'solid', width: 1.8, isVisible: true };
      const shape = /** @type {Shape} */ ('linear');
      return [{ uid: `axis-${index}-${plot}`, name: axis.label, plot, x: axis.x, y: ofAxis(axis), shape, ...look }];
    }),
  );
}
