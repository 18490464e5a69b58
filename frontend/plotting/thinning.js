// @ts-check
// Lines as svg paths, no denser than a screen can show: of each column of pixels the first, the highest, the lowest and
// the last place. Nothing of the page.

/** @typedef {'linear' | 'hv' | 'vh' | 'hvh'} Shape  how a line goes from one point to the next */

/** From values to pixels: `at + per * value`, or of the value's logarithm.
 * @typedef {{at: number, per: number, isLog: boolean}} Scale */

// Paths go on a little beyond the plot, whose edge cuts them.
const BEYOND_PX = 4;

/** @param {Scale} scale @param {number} value */
const pixel = ({ at, per, isLog }, value) => at + per * (isLog ? Math.log(value) : value);

/** Tenths of a pixel.
 * @param {number} value */
const short = (value) => Math.round(value * 10) / 10;

/**
 * The path of a line through points, in pixels.
 * @param {{x: readonly number[], y: readonly number[], shape: Shape}} line x rising or falling all along
 * @param {Scale} across @param {Scale} up
 * @param {number} width of the plot: what lies outside is left out
 */
export function pathOf({ x, y, shape }, across, up, width) {
  const [from, to] = visiblePart(x, across, width);
  let path = '';
  let before = NaN;
  const go = (/** @type {number} */ right, /** @type {number} */ down) => {
    if (!Number.isFinite(right) || !Number.isFinite(down)) {
      before = NaN;
      return;
    }
    path += Number.isNaN(before) ? `M${short(right)},${short(down)}` : corner(shape, before, right, down);
    before = right;
  };
  if (shape !== 'linear') {
    for (let i = from; i < to; i += 1) go(pixel(across, x[i]), pixel(up, y[i]));
    return path;
  }
  let column = { at: NaN, right: NaN, first: NaN, high: NaN, low: NaN, last: NaN, isHighFirst: true };
  const flush = () => {
    if (Number.isNaN(column.at)) return;
    const { right, first, high, low, last, isHighFirst } = column;
    const [one, other] = isHighFirst ? [high, low] : [low, high];
    go(right, first);
    if (one !== first && one !== last) go(right, one);
    if (other !== first && other !== last && other !== one) go(right, other);
    if (last !== first) go(right, last);
  };
  for (let i = from; i < to; i += 1) {
    const right = pixel(across, x[i]);
    const down = pixel(up, y[i]);
    const at = Math.round(right);
    if (at !== column.at) {
      flush();
      column = { at, right, first: down, high: down, low: down, last: down, isHighFirst: true };
      continue;
    }
    column.last = down;
    if (down < column.low) {
      column.low = down;
      column.isHighFirst = true;
    }
    if (down > column.high) {
      column.high = down;
      column.isHighFirst = false;
    }
  }
  flush();
  return path;
}

/** @param {Shape} shape @param {number} before @param {number} right @param {number} down */
function corner(shape, before, right, down) {
  switch (shape) {
    case 'hv':
      return `H${short(right)}V${short(down)}`;
    case 'vh':
      return `V${short(down)}H${short(right)}`;
    case 'hvh':
      return `H${short((before + right) / 2)}V${short(down)}H${short(right)}`;
    default:
      return `L${short(right)},${short(down)}`;
  }
}

/** The part of the points that lies in the plot, with one more at either side: from, and before which.
 * @param {readonly number[]} x @param {Scale} across @param {number} width @returns {[number, number]} */
function visiblePart(x, across, width) {
  const falls = x.length > 1 && pixel(across, x[x.length - 1]) < pixel(across, x[0]);
  const isBefore = (/** @type {number} */ i, /** @type {number} */ edge) => {
    const at = pixel(across, x[i]);
    return falls ? at > edge : !(at >= edge);
  };
  const first = (/** @type {number} */ edge) => {
    let [low, high] = [0, x.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (isBefore(middle, edge)) low = middle + 1;
      else high = middle;
    }
    return low;
  };
  const edges = [-BEYOND_PX, width + BEYOND_PX];
  if (falls) edges.reverse();
  return [Math.max(0, first(edges[0]) - 1), Math.min(x.length, first(edges[1]) + 1)];
}
