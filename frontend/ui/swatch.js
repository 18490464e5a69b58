// @ts-check
// The piece of line that stands for a method wherever it is named.

import { svgElement } from './dom.js';
import { methodOf, REFERENCE } from '../model/methods.js';

/** Of a line that is no method's.
 * @param {string} colour token of it @param {string} [dash] of a line that isn't solid */
export function lineSwatch(colour, dash = 'none') {
  const drawing = svgElement('svg', { class: 'swatch', viewBox: '0 0 26 8', 'aria-hidden': 'true' });
  const style = `stroke: var(${colour}); stroke-dasharray: ${dash}`;
  drawing.append(svgElement('line', { x1: 0, y1: 4, x2: 26, y2: 4, 'stroke-width': 2.5, style }));
  return drawing;
}

/** @param {import('../model/types.js').MethodName} name */
export function methodSwatch(name) {
  const drawing = svgElement('svg', { class: 'swatch', viewBox: '0 0 26 8', 'aria-hidden': 'true' });
  const stroke = `stroke: var(--method-${name})`;
  drawing.append(
    svgElement('line', {
      x1: 0,
      y1: 4,
      x2: 26,
      y2: 4,
      style: `${stroke}; stroke-dasharray: var(--dash-${name}, none)`,
      'stroke-width': name === REFERENCE ? 3 : 2.5,
    }),
  );
  if (methodOf(name).plays_table)
    drawing.append(
      svgElement('circle', { cx: 13, cy: 4, r: 3, 'stroke-width': 2, style: `${stroke}; fill: var(--plot)` }),
    );
  return drawing;
}
