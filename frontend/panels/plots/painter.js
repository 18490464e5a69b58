// @ts-check
// How the figure gets to the screen: by Plotly, or, where only curves have changed, by rewriting the paths that it drew.
// A slider changes every curve many times a second, and Plotly alone takes most of a frame for it.

import { layoutOf, shadingPaths, tracesOf } from '../../plotting/figure.js';
import { pathOf } from '../../plotting/thinning.js';

/** @typedef {import('../../plotting/frame.js').Frame} Frame */
/** @typedef {import('../../plotting/frame.js').PlotFrame} PlotFrame */
/** @typedef {import('../../plotting/frame.js').Range} Range */
/** @typedef {import('../../plotting/frame.js').Scene} Scene */
/** @typedef {import('../../plotting/lines.js').Line} Line */
/** @typedef {import('../../plotting/thinning.js').Scale} Scale */

// Scroll to zoom and double click are ours: Plotly's would not know the limits of the view.
const PLOTLY_OPTIONS = { displayModeBar: false, responsive: false, doubleClick: false, scrollZoom: false };

/**
 * @param {any} figure the element that Plotly draws in
 * @param {object} handlers
 * @param {(low: number, high: number) => void} handlers.onSelect  a part of the x axis was chosen, as Plotly has it
 * @param {() => void} handlers.onDoubleClick
 */
export function createPainter(figure, { onSelect, onDoubleClick }) {
  /** @type {any} */
  let Plotly = null;
  /** What Plotly drew last: all that must not change for its paths to be rewritten, and those paths.
   * @type {{key: string, paths: Map<string, Element>, shadings: Element[]} | null} */
  let painted = null;

  function listen() {
    figure.on('plotly_relayout', (/** @type {Record<string, number>} */ change) => {
      const [low, high] = [change['xaxis.range[0]'], change['xaxis.range[1]']];
      if (low !== undefined) onSelect(low, high);
    });
    figure.on('plotly_doubleclick', onDoubleClick);
  }

  return {
    /** @returns {Promise<boolean>} whether there is a Plotly */
    async load() {
      Plotly = await plotly();
      return Plotly !== null;
    },
    isLoaded: () => Plotly !== null,

    /** @param {Scene} scene @param {Frame} frame @param {Line[]} lines */
    async paint(scene, frame, lines) {
      const isFirst = painted === null;
      painted = null;
      await Plotly.react(figure, tracesOf(lines), layoutOf(scene, frame), PLOTLY_OPTIONS);
      if (isFirst && !figure.dataset.listened) {
        figure.dataset.listened = 'true';
        listen();
      }
      const visible = lines.filter((line) => line.isVisible && !line.isDots);
      const paths = visible.map((line) => [line.uid, figure.querySelector(`.trace${line.uid} path.js-line`)]);
      painted = {
        key: keyOf(scene, frame, lines),
        paths: new Map(/** @type {[string, Element][]} */ (paths.filter(([, path]) => path))),
        shadings: [...figure.querySelectorAll('.shapelayer path[data-index]')].sort(
          (a, b) => Number(a.dataset.index) - Number(b.dataset.index),
        ),
      };
    },

    /** Rewrite the paths; false when something else has changed too, so that nothing was done.
     * @param {Scene} scene @param {Frame} frame @param {Line[]} lines */
    rewrite(scene, frame, lines) {
      const visible = lines.filter((line) => line.isVisible && !line.isDots);
      if (painted === null || painted.key !== keyOf(scene, frame, lines)) return false;
      const { paths } = painted;
      const shadings = shadingPaths(frame);
      if (visible.some((line) => !paths.has(line.uid)) || shadings.length !== painted.shadings.length) return false;
      const across = rising(frame.x, frame.width);
      for (const line of visible) {
        const plot = /** @type {PlotFrame} */ (
          frame.plots.find((one) => one.name === (line.plot === 'acceleration' ? 'velocity' : line.plot))
        );
        const range = line.plot === 'acceleration' ? /** @type {Range} */ (frame.acceleration) : plot.range;
        paths.get(line.uid)?.setAttribute('d', pathOf(line, across, falling(range, plot.height), frame.width));
      }
      painted.shadings.forEach((shading, index) => shading.setAttribute('d', shadings[index]));
      return true;
    },
  };
}

/** All that paths alone don't show: dots are none.
 * @param {Scene} scene @param {Frame} frame @param {Line[]} lines */
function keyOf({ size, against, third, axes, colours, answer }, frame, lines) {
  const drawn = lines
    .filter((line) => line.isVisible)
    .map(({ uid, shape, colour, dash, width, isDots, x, y }) => [uid, shape, colour, dash, width, isDots && [x, y]]);
  const plots = frame.plots.map(({ range, isVisible, unit }) => [range, isVisible, unit]);
  const { full, x, acceleration } = frame;
  const look = [size, against, third, axes !== null, colours.grid, answer.design.axis.travel_unit, answer.units];
  return JSON.stringify([look, full, x, acceleration, plots, drawn]);
}

/** @param {Range} range @param {number} length @returns {Scale} */
function rising({ low, high, isLog }, length) {
  const per = length / (isLog ? Math.log(high / low) : high - low);
  return { at: -per * (isLog ? Math.log(low) : low), per, isLog };
}

/** @param {Range} range @param {number} length @returns {Scale} */
function falling(range, length) {
  const { at, per, isLog } = rising(range, length);
  return { at: length - at, per: -per, isLog };
}

/** Plotly, when its script has run; null when it could not be loaded.
 * @returns {Promise<any>} */
function plotly() {
  const present = () => /** @type {any} */ (globalThis).Plotly ?? null;
  if (present() || document.readyState === 'complete') return Promise.resolve(present());
  return new Promise((resolve) => addEventListener('load', () => resolve(present()), { once: true }));
}
