// @ts-check
// The curve through the points of a drawn acceleration, as the server computes it: the monotone cubic of Fritsch and Butland
// (1984), which never leaves the range of the two points beside it; level outside of all points.

/** @typedef {[number, number]} Point */

/** @param {Point[]} points two or more, x increasing @returns {(x: number) => number} */
export function monotoneCubic(points) {
  const widths = points.slice(1).map(([x], i) => x - points[i][0]);
  const rises = points.slice(1).map(([, y], i) => (y - points[i][1]) / widths[i]);
  const slopes = points.map((_, i) => slopeAt(widths, rises, i));
  const last = points.length - 1;
  return (x) => {
    if (x <= points[0][0]) return points[0][1];
    if (x >= points[last][0]) return points[last][1];
    const i = points.findIndex(([right]) => x < right) - 1;
    const part = (x - points[i][0]) / widths[i];
    const bend = (1 - part) * (slopes[i] - rises[i]) - part * (slopes[i + 1] - rises[i]);
    return points[i][1] + part * widths[i] * (rises[i] + (1 - part) * bend);
  };
}

/** What the curve gains at a point: the harmonic mean of the rises beside it, none where it turns.
 * @param {number[]} widths @param {number[]} rises @param {number} i */
function slopeAt(widths, rises, i) {
  const last = widths.length;
  if (last === 1) return rises[0];
  if (i === 0) return slopeAtEnd(widths[0], widths[1], rises[0], rises[1]);
  if (i === last) return slopeAtEnd(widths[last - 1], widths[last - 2], rises[last - 1], rises[last - 2]);
  const [before, after] = [rises[i - 1], rises[i]];
  if (!(before * after > 0)) return 0;
  const [first, second] = [2 * widths[i] + widths[i - 1], widths[i] + 2 * widths[i - 1]];
  return (first + second) / (first / before + second / after);
}

/** By three points, as far as the curve stays monotone.
 * @param {number} width @param {number} nextWidth @param {number} rise @param {number} nextRise */
function slopeAtEnd(width, nextWidth, rise, nextRise) {
  const slope = ((2 * width + nextWidth) * rise - width * nextRise) / (width + nextWidth);
  if (slope * rise <= 0) return 0;
  return rise * nextRise <= 0 && Math.abs(slope) > 3 * Math.abs(rise) ? 3 * rise : slope;
}
