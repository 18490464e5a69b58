// @ts-check
// How the lines look: what is drawn on a canvas has to be told the colours that a style sheet gives all else.

import { METHODS } from '../../model/methods.js';
import { token } from '../../ui/theme.js';

/** @typedef {import('../../plotting/frame.js').Scene} Scene */

/** Colours, dashes and font of the present theme.
 * @returns {Pick<Scene, 'colours' | 'dashes' | 'font'>} */
export function readLook() {
  const named = ['pinned', 'own', 'measured', 'capture', 'capture-missing', 'capture-extra', 'capture-short', 'axis-0', 'axis-1', 'axis-2', 'axis-3'];
  const parts = ['method', 'arithmetic', 'rounding', 'compression'].map((name) => `part-${name}`);
  const colours = Object.fromEntries([
    ...METHODS.map(({ name }) => [name, token(`--method-${name}`)]),
    ...[...named, ...parts].map((name) => [name, token(`--${name}`)]),
  ]);
  return {
    colours: {
      ...colours,
      grid: token('--grid'),
      plot: token('--plot'),
      tick: token('--text-3'),
      phase: token('--phase-ramp'),
    },
    dashes: Object.fromEntries(METHODS.map(({ name }) => [name, token(`--dash-${name}`) || 'solid'])),
    font: token('--font'),
  };
}
