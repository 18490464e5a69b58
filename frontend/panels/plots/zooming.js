// @ts-check
// Looking closer at a part of the move, and at what lies beside it.

import { xValue, zoomedAbout } from '../../plotting/frame.js';

/** @typedef {import('../../plotting/frame.js').Frame} Frame */
/** @typedef {[number, number]} Ends   of the part that is looked at, on the axis */

/** @param {() => {frame: Frame, isZoomed: boolean} | null} look what is drawn
 * @param {(ends: Ends | null) => void} onZoom  null: all is looked at */
export function createZooming(look, onZoom) {
  return {
    /** What was drawn a box around, as Plotly tells it: on a logarithmic axis by its powers of ten.
     * @param {number} low @param {number} high */
    select(low, high) {
      const drawn = look();
      if (!drawn) return;
      const { x, full } = drawn.frame;
      const ends = x.isLog ? [10 ** low, 10 ** high] : [low, high];
      const [from, to] = [Math.max(full.low, Math.min(...ends)), Math.min(full.high, Math.max(...ends))];
      if (to > from) onZoom([from, to]);
    },
    /** @param {number} factor under 1: closer @param {number} pixel that stays where it is */
    about(factor, pixel) {
      const drawn = look();
      if (!drawn) return;
      const { left, width } = drawn.frame;
      onZoom(zoomedAbout(drawn.frame, Math.min(left + width, Math.max(left, pixel)), factor));
    },
    /** @param {number} pixels to the right */
    pan(pixels) {
      const drawn = look();
      if (!drawn?.isZoomed) return;
      const { frame } = drawn;
      const [low, high] = [frame.left, frame.left + frame.width].map((edge) => xValue(frame, edge - pixels));
      if (low >= frame.full.low && high <= frame.full.high) onZoom([low, high]);
    },
    all: () => onZoom(null),
  };
}
