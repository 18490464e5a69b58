// @ts-check
// The figure: lines and frame in, Plotly's traces and layout out. Nothing of the page.

import { axisScale } from './curves.js';
import { frameOf, xPixel } from './frame.js';
import { linesOf } from './lines.js';
import { isOfMotion, PLOTS } from './plots.js';

/** @typedef {import('./frame.js').Frame} Frame */
/** @typedef {import('./frame.js').PlotFrame} PlotFrame */
/** @typedef {import('./frame.js').PlotName} PlotName */
/** @typedef {import('./frame.js').Range} Range */
/** @typedef {import('./frame.js').Scene} Scene */
/** @typedef {import('./lines.js').Line} Line */

// Room that a hidden plot keeps: Plotly takes anything smaller for the whole height.
const COLLAPSED = [0, 0.001];
const DOT_PX = 6;
const MARK_PX = 9;
/** Plotly's axes by plot; the second scale of the velocity has the one after the last.
 * @type {Record<string, string>} */
const Y_AXES = Object.fromEntries([...PLOTS.map(({ name, plotlyAxis }) => [name, plotlyAxis]), ['acceleration', `y${PLOTS.length + 1}`]]);
const layoutName = (/** @type {string} */ axis) => `yaxis${axis.slice(1)}`;

/** @param {Scene} scene */
export function figureOf(scene) {
  const frame = frameOf(scene);
  return { frame, lines: linesOf(scene, frame) };
}

/** @param {Line[]} lines */
export function tracesOf(lines) {
  return lines.map(({ uid, name, plot, x, y, shape, colour, dash, width, isVisible, isDots, symbol }) => ({
    type: 'scatter',
    mode: isDots ? 'markers' : 'lines',
    name,
    meta: plot,
    uid,
    x,
    y,
    xaxis: 'x',
    yaxis: Y_AXES[plot],
    visible: isVisible,
    hoverinfo: 'skip',
    // Plotly's own thinning would slope a long plateau; the server has thinned the points already.
    line: { color: colour, dash, width, shape, simplify: false },
    marker: symbol ? { color: colour, symbol, size: MARK_PX, line: { color: colour, width: 2 } } : { color: colour, size: DOT_PX },
  }));
}

/** @param {Range} range in the units that Plotly wants: the logarithm on a logarithmic axis */
function plotlyRange({ low, high, isLog }) {
  return isLog ? [Math.log10(low), Math.log10(high)] : [low, high];
}

/** Labels at 1, 2 and 5 of each decade, at 1 only where there are many decades.
 * @param {Range} range */
function logTicks({ low, high }) {
  const decades = Math.log10(high / low);
  const parts = decades > 4 ? [1] : [1, 2, 5];
  const ticks = [];
  for (let exponent = Math.floor(Math.log10(low)); exponent <= Math.log10(high); exponent += 1) {
    for (const part of parts) ticks.push(Number(`${part}e${exponent}`));
  }
  return ticks.filter((tick) => tick >= low && tick <= high);
}

/** @param {Scene} scene @param {Frame} frame */
export function layoutOf(scene, frame) {
  const { size, compact, colours, font } = scene;
  const tickfont = { size: compact ? 11 : 10, color: colours.tick, family: font };
  const common = { tickfont, gridcolor: colours.grid, zeroline: false, ticks: '' };
  const isFew = frame.x.isLog && frame.x.high < frame.x.low * 3;
  const xTicks = frame.x.isLog && !isFew ? { tickvals: logTicks(frame.x) } : { nticks: compact ? 5 : 11 };
  return {
    autosize: false,
    width: size.width,
    height: size.height,
    showlegend: false,
    hovermode: false,
    dragmode: 'zoom',
    margin: { l: frame.left, r: size.width - frame.left - frame.width, t: frame.top, b: frame.bottom, pad: 0 },
    paper_bgcolor: 'rgba(0,0,0,0)',
    plot_bgcolor: colours.plot,
    font: { family: font },
    xaxis: {
      ...common,
      ...xTicks,
      type: frame.x.isLog ? 'log' : 'linear',
      range: plotlyRange(frame.x),
      tickformat: ',~f',
      anchor: 'free',
      position: 0,
      side: 'bottom',
      ticklabelstandoff: 2,
      automargin: false,
      title: {
        text: titleOfX(scene, frame),
        font: { size: compact ? 12 : 11, color: colours.tick },
        standoff: 4,
      },
    },
    ...Object.fromEntries(PLOTS.map(({ name, plotlyAxis }) => [layoutName(plotlyAxis), yAxis(scene, frame, name, common)])),
    ...(frame.acceleration && { [layoutName(Y_AXES.acceleration)]: accelerationAxis(frame, frame.acceleration, common) }),
    shapes: shadingsOf(frame).map((rectangle) => ({
      type: 'rect',
      xref: 'x',
      yref: `${rectangle.axis} domain`,
      x0: rectangle.x0,
      x1: rectangle.x1,
      y0: 0,
      y1: 1,
      fillcolor: colours.phase,
      line: { width: 0 },
      layer: 'below',
    })),
  };
}

/** @param {Scene} scene @param {Frame} frame */
function titleOfX(scene, frame) {
  if (scene.axes) return 'time since the start, s';
  return frame.x.isLog ? 'step, logarithmic' : axisScale(scene.answer, scene.against).title;
}

/** @param {Scene} scene @param {Frame} frame @param {PlotName} name @param {object} common */
function yAxis({ size, compact, third = 'error' }, frame, name, common) {
  const plot = /** @type {PlotFrame} */ (frame.plots.find((one) => one.name === name));
  const inner = size.height - frame.top - frame.bottom;
  const bottom = 1 - (plot.top + plot.height - frame.top) / inner;
  const domain = plot.isVisible ? [Math.max(0, bottom), Math.min(1, bottom + plot.height / inner)] : COLLAPSED;
  const numbers =
    name === 'error'
      ? isOfMotion(third)
        ? { nticks: 6, tickformat: '~s' }
        : { nticks: 8, ticksuffix: third === 'deviation' ? '' : ' %', tickformat: '~g' }
      : plot.range.isLog
        ? { tickvals: logTicks(plot.range), tickformat: compact ? '~s' : ',~f' }
        : { nticks: 6, tickformat: ',~f' };
  return {
    ...common,
    ...numbers,
    domain,
    type: plot.range.isLog ? 'log' : 'linear',
    range: plotlyRange(plot.range),
    fixedrange: true,
    visible: plot.isVisible,
    ticklabelstandoff: 4,
    automargin: false,
  };
}

/** @param {Frame} frame @param {Range} range @param {object} common */
function accelerationAxis({ plots }, range, common) {
  return {
    ...common,
    overlaying: 'y',
    side: 'right',
    range: plotlyRange(range),
    visible: plots[0].isVisible,
    showgrid: false,
    fixedrange: true,
    tickmode: 'auto',
    nticks: 6,
    tickformat: '~s',
    ticklabelstandoff: 4,
    automargin: false,
  };
}

/** The stretches of acceleration and deceleration, shaded in each plot that is seen.
 * @param {Frame} frame @returns {{axis: string, plot: PlotFrame, x0: number, x1: number}[]} */
function shadingsOf(frame) {
  return frame.phases
    .filter((phase) => phase.name !== 'slew')
    .flatMap((phase) => {
      // A shape from 0 has no place on a logarithmic axis: it begins at the left edge instead.
      const x0 = frame.x.isLog ? (phase.from <= 1 ? frame.x.low : Math.max(phase.from, frame.x.low)) : phase.from;
      return frame.plots
        .filter((plot) => plot.isVisible)
        .map((plot) => ({ axis: PLOTS.find((one) => one.name === plot.name)?.plotlyAxis ?? '', plot, x0, x1: phase.to }));
    });
}

/** The paths of the shadings, in pixels of the figure, in the order of the layout's shapes.
 * @param {Frame} frame */
export function shadingPaths(frame) {
  return shadingsOf(frame).map(({ plot, x0, x1 }) => {
    const [left, right] = [xPixel(frame, x0), xPixel(frame, x1)];
    return `M${left},${plot.top}H${right}V${plot.top + plot.height}H${left}Z`;
  });
}
