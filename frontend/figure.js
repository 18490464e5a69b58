// @ts-check
// The figure: curves in, Plotly's traces and layout out. Nothing of the page.

import { axisScale } from './curves.js';
import { frameOf, PLOTS } from './frame.js';
import { METHODS, REFERENCE } from './methods.js';

/** @typedef {import('./types.js').MethodName} MethodName */
/** @typedef {import('./frame.js').Frame} Frame */
/** @typedef {import('./frame.js').PlotFrame} PlotFrame */
/** @typedef {import('./frame.js').PlotName} PlotName */
/** @typedef {import('./frame.js').Range} Range */
/** @typedef {import('./frame.js').Scene} Scene */

// Room that a hidden plot keeps: Plotly takes anything smaller for the whole height.
const COLLAPSED = [0, 0.001];

/** @param {Scene} scene */
export function figureOf(scene) {
  const frame = frameOf(scene);
  return { traces: tracesOf(scene), layout: layoutOf(scene, frame), frame };
}

/** The order of drawing: the reference at the bottom, the chosen method on top.
 * @param {MethodName} active @returns {MethodName[]} */
export function drawingOrder(active) {
  const others = METHODS.map((method) => method.name).filter((name) => name !== REFERENCE && name !== active);
  return active === REFERENCE ? [...others, REFERENCE] : [REFERENCE, ...others, active];
}

/** @param {Scene} scene */
function tracesOf({ answer, curves, shown, colours, dashes, compact, only, moving }) {
  const active = answer.design.method.name;
  return drawingOrder(active).flatMap((name) => {
    const curve = curves[name];
    const line = {
      color: colours[name],
      dash: dashes[name],
      width: name === active ? 2.25 : name === REFERENCE ? 2 : 1.4,
      simplify: moving,
    };
    // A table holds its delay up to a row's last step and then jumps: its line is a staircase.
    const staircase = { ...line, shape: name === 'table' ? 'vh' : 'linear' };
    return PLOTS.map((plot) => {
      const [x, y] =
        plot.name === 'error'
          ? [curve?.error.x, curve?.error.percent]
          : [curve?.x, plot.name === 'velocity' ? curve?.speed : curve?.delay_us];
      const visible = curve !== undefined && shown.has(name) && (!compact || plot.name === only);
      return {
        type: 'scatter',
        mode: 'lines',
        name,
        meta: plot.name,
        uid: `${name}-${plot.name}`,
        x: x ?? [],
        y: y ?? [],
        xaxis: 'x',
        yaxis: plot.axis,
        visible,
        hoverinfo: 'skip',
        line: plot.name === 'error' ? line : staircase,
      };
    });
  });
}

/** @param {Range} range in the units that Plotly wants: the logarithm on a logarithmic axis */
function plotlyRange({ low, high, isLog }) {
  return isLog ? [Math.log10(low), Math.log10(high)] : [low, high];
}

/** Labels at 1, 2 and 5 of each decade, at 1 only where there are many decades. @param {Range} range */
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
function layoutOf(scene, frame) {
  const { size, compact, colours, font } = scene;
  const tickfont = { size: compact ? 11 : 10, color: colours.tick, family: font };
  const common = { tickfont, gridcolor: colours.grid, zeroline: false, ticks: '' };
  const xTicks = frame.x.isLog ? { tickvals: logTicks(frame.x) } : { nticks: compact ? 5 : 11 };
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
        text: frame.x.isLog ? 'step, logarithmic' : axisScale(scene.answer, scene.axis).title,
        font: { size: compact ? 12 : 11, color: colours.tick },
        standoff: 4,
      },
    },
    ...Object.fromEntries(frame.plots.map((plot) => [`${yAxisKey(plot.name)}`, yAxis(scene, frame, plot, common)])),
    shapes: frame.phases
      .filter((phase) => phase.name !== 'slew')
      .flatMap((phase) => shading(frame, phase, colours.phase)),
  };
}

/** @param {PlotName} name */
function yAxisKey(name) {
  return { velocity: 'yaxis', delay: 'yaxis2', error: 'yaxis3' }[name];
}

/** @param {Scene} scene @param {Frame} frame @param {PlotFrame} plot @param {object} common */
function yAxis({ size, compact }, frame, plot, common) {
  const inner = size.height - frame.top - frame.bottom;
  const bottom = 1 - (plot.top + plot.height - frame.top) / inner;
  const domain = plot.isVisible ? [Math.max(0, bottom), Math.min(1, bottom + plot.height / inner)] : COLLAPSED;
  const numbers =
    plot.name === 'error'
      ? { nticks: 8, ticksuffix: ' %', tickformat: '~g' }
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

/** @param {Frame} frame @param {Frame['phases'][0]} phase @param {string} colour */
function shading(frame, phase, colour) {
  // A shape from 0 has no place on a logarithmic axis: it begins at the left edge instead.
  const start = frame.x.isLog ? Math.max(phase.from, frame.x.low) : phase.from;
  const x0 = frame.x.isLog && phase.from <= 1 ? frame.x.low : start;
  return frame.plots
    .filter((plot) => plot.isVisible)
    .map((plot) => ({
      type: 'rect',
      xref: 'x',
      yref: `${PLOTS.find((one) => one.name === plot.name)?.axis} domain`,
      x0,
      x1: phase.to,
      y0: 0,
      y1: 1,
      fillcolor: colour,
      line: { width: 0 },
      layer: 'below',
    }));
}
