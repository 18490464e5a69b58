// @ts-check
// What a hand does to a number: where it lies on its slider, and what a step of an arrow key or of the wheel is. Steps
// are round in the unit that is shown; `factor` says how many of that unit one of the design's units is.

import { tidy } from '../../model/numbers.js';

/** @typedef {import('../../model/fields.js').Field} Field */
/** @typedef {import('../../model/fields.js').Slider} Slider */
/** @typedef {'fine' | 'usual' | 'coarse'} Stride */

/** Positions of a slider: enough that neighbouring ones differ by less than anyone can set by hand. */
export const SLIDER_POSITIONS = 1000;
// A usual step of a logarithmic slider, as a fraction of the value; a coarse one is ten times, a fine one a tenth of it.
const USUAL = 0.01;
const LEAST_PART = 1e-6;
const STRIDES = { fine: 0.1, usual: 1, coarse: 10 };
const LINEAR = { fine: 0, usual: 1, coarse: 2 };
const POWERS_OF_TWO = { fine: 0, usual: 1, coarse: 2 };

/** Where a value lies on a slider; a value outside its reach lies at its end. The sign of a distance does not matter.
 * @param {Slider} slider @param {number} value */
export function sliderPosition({ from, to, scale }, value) {
  const magnitude = Math.min(to, Math.max(from, Math.abs(value)));
  const fraction =
    scale === 'log' ? Math.log(magnitude / from) / Math.log(to / from) : (magnitude - from) / (to - from);
  return fraction * SLIDER_POSITIONS;
}

/** The value at a position of a slider, rounded to what a hand can mean. The sign of the value before is kept.
 * @param {Field} field @param {number} position @param {number} before @param {number} [factor] */
export function sliderValue({ slider, isWhole }, position, before, factor = 1) {
  const { from, to } = slider;
  const fraction = position / SLIDER_POSITIONS;
  const value = slider.scale === 'log' ? from * (to / from) ** fraction : from + (to - from) * fraction;
  const rounded = tidy(roundedByHand(slider, value, factor) / factor);
  const settled = Math.min(to, Math.max(from, isWhole ? Math.round(rounded) : rounded));
  return before < 0 ? -settled : settled;
}

/** In the unit that is shown.
 * @param {Slider} slider @param {number} value @param {number} factor */
function roundedByHand(slider, value, factor) {
  const shown = value * factor;
  if (slider.scale === 'log') return slider.figures === 0 ? shown : Number(shown.toPrecision(slider.figures));
  const stride = strideAt(slider, value, 'fine', factor);
  return stride * Math.round(shown / stride);
}

/**
 * The value one step further: to the next round one, never past what the server takes.
 * @param {Field} field
 * @param {number} value
 * @param {1 | -1} direction
 * @param {Stride} stride
 * @param {number} [factor]
 */
export function stepped({ slider, isWhole, limits }, value, direction, stride, factor = 1) {
  const next =
    slider.scale === 'log' && slider.doubles && stride !== 'fine'
      ? doubled(value, direction * POWERS_OF_TWO[stride])
      : tidy(nextOnGrid(value * factor, direction, strideAt(slider, value, stride, factor)) / factor);
  const within = Math.min(limits[1], Math.max(limits[0], isWhole ? nextWhole(value, next, direction) : next));
  // No move is of no length: it is stepped over.
  return within === 0 && limits[0] < 0 ? direction : within;
}

/** The length of a step at a value, in the unit that is shown.
 * @param {Slider} slider @param {number} value
 * @param {Stride} stride @param {number} factor */
function strideAt(slider, value, stride, factor) {
  if (slider.scale === 'linear') {
    const length = slider.strides[LINEAR[stride]];
    return factor === 1 ? length : roundSize(length * factor);
  }
  // Of nothing, or next to nothing, no part is a step.
  const size = Math.abs(value) < LEAST_PART * slider.from ? slider.from : Math.abs(value);
  return roundSize(size * factor * USUAL) * STRIDES[stride];
}

/** The nearest of 1, 2, 5, 10, 20, 50 …
 * @param {number} size */
function roundSize(size) {
  const decade = 10 ** Math.floor(Math.log10(size));
  const lead = size / decade;
  return decade * (lead < Math.sqrt(2) ? 1 : lead < Math.sqrt(10) ? 2 : lead < Math.sqrt(50) ? 5 : 10);
}

/** The next multiple of a stride; a value that is one but for noise counts as one.
 * @param {number} value @param {1 | -1} direction @param {number} stride */
function nextOnGrid(value, direction, stride) {
  const place = tidy(value / stride);
  return stride * (direction > 0 ? Math.floor(place) + 1 : Math.ceil(place) - 1);
}

/** The power of two that lies so many powers further.
 * @param {number} value @param {number} powers */
function doubled(value, powers) {
  const power = Math.log2(Math.max(1, value));
  return 2 ** (powers > 0 ? Math.floor(power) + powers : Math.max(0, Math.ceil(power) + powers));
}

/** At least one further, however short the step.
 * @param {number} value @param {number} next @param {1 | -1} direction */
function nextWhole(value, next, direction) {
  const rounded = Math.round(next);
  return direction > 0 ? Math.max(rounded, Math.floor(value) + 1) : Math.min(rounded, Math.ceil(value) - 1);
}
