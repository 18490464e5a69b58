// @ts-check
// Every line of the figure, in the order of drawing: the kept design beneath, then the reference, the other methods, the
// chosen one, and on top what was measured. Nothing of the page, no Plotly.

import { activeCurve, PLOTS, stepsIn, xPixel } from './frame.js';
import { METHODS, methodOf, REFERENCE } from './methods.js';

/** @typedef {import('./types.js').MethodName} MethodName */
/** @typedef {import('./curves.js').Curve} Curve */
/** @typedef {import('./curves.js').ErrorPart} ErrorPart */
/** @typedef {import('./frame.js').Frame} Frame */
/** @typedef {import('./frame.js').PlotName} PlotName */
/** @typedef {import('./frame.js').Scene} Scene */
/** @typedef {import('./thinning.js').Shape} Shape */

/** @typedef {object} Line
 * @property {string} uid     such as "first_order-delay"
 * @property {string} name
 * @property {PlotName | 'acceleration'} plot
 * @property {number[]} x
 * @property {number[]} y
 * @property {Shape} shape
 * @property {string} colour
 * @property {string} dash
 * @property {number} width   [px]
 * @property {boolean} [isDots]  points that no line joins
 * @property {boolean} isVisible */

/** @typedef {Pick<Line, 'colour' | 'dash' | 'width' | 'isDots'>} Look */

// So far apart, steps are seen as steps and not as a curve [px].
const STEP_SEEN_PX = 5;
const KEPT_DASH = '4px, 3px';
// Lines that join fewer samples would show corners of a ramp where there are none.
const FEWEST_JOINED = 10;

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
  const fromStep = scene.axis === 'step' ? xPixel(frame, last) - xPixel(frame, last - 1) : frame.width / (last - first);
  return fromStep >= STEP_SEEN_PX;
}

/** @param {Scene} scene @param {Frame} frame @returns {Line[]} */
function methodLines(scene, frame) {
  const { answer, curves, shown, colours, dashes, third = 'error', kept, measured, live } = scene;
  const active = answer.design.method.name;
  // An interval follows its pulse in time; over steps it lies about its step.
  const step = areStepsSeen(scene, frame) ? (scene.axis === 'time' ? 'hv' : 'hvh') : 'linear';
  /** @type {Line[]} */
  const lines = [];
  if (kept)
    lines.push(...threeOf('kept', kept, { colour: colours.kept, dash: KEPT_DASH, width: 1.5 }, step, true, third));
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
    lines.push(...threeOf(name, curves[name], look, shape, shown.has(name), lowest));
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
  const reality = { colour: colours.measured, dash: 'solid', width: 1.4 };
  if (measured) {
    add('measured-velocity', 'velocity', measured.x, measured.velocity, reality);
    add('measured-delay', 'delay', measured.x, measured.delay, reality);
    if (third === 'deviation') add('measured-deviation', 'error', measured.x, measured.deviation, reality);
  }
  if (live) {
    const isDots = live.x.length < FEWEST_JOINED;
    add('live-velocity', 'velocity', live.x, live.velocity, { ...reality, width: 2, isDots });
  }
  return lines;
}

/** One curve in the three plots.
 * @param {string} name @param {Curve | undefined} curve @param {Look} look @param {Shape} shape @param {boolean} isShown
 * @param {import('./frame.js').Third} third @returns {Line[]} */
function threeOf(name, curve, look, shape, isShown, third) {
  return PLOTS.map(({ name: plot }) => {
    const y = plot === 'error' ? curve?.error.percent : plot === 'velocity' ? curve?.shownSpeed : curve?.delay_us;
    return {
      uid: `${name}-${plot}`,
      name,
      plot,
      x: (plot === 'error' ? curve?.error.x : curve?.x) ?? [],
      y: y ?? [],
      shape: plot === 'error' && shape === 'vh' ? 'linear' : shape,
      ...look,
      isVisible: curve !== undefined && isShown && (plot !== 'error' || third === 'error'),
    };
  });
}

/** @param {Scene} scene @returns {Line[]} */
function axesLines({ axes, colours }) {
  /** @type {PlotName[]} */
  const plots = ['velocity', 'delay'];
  return (axes ?? []).flatMap((axis, index) =>
    plots.map((plot) => ({
      uid: `axis-${index}-${plot}`,
      name: axis.label,
      plot,
      x: axis.x,
      y: plot === 'velocity' ? axis.velocity : axis.delay,
      shape: /** @type {Shape} */ ('linear'),
      colour: colours[`axis-${axis.colour}`],
      dash: 'solid',
      width: 1.8,
      isVisible: true,
    })),
  );
}
