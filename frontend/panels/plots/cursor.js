// @ts-check
// The cursor of the plots: what it reads under the pointer, or where keys have left it.

import { axesReadingAt, measuredReadingAt, readingAt } from '../../plotting/curves.js';
import { xPixel, xValue } from '../../plotting/frame.js';

/** @typedef {import('../../plotting/curves.js').Reading} Reading */

/** What is drawn; isHeld: a point is dragged, no tooltip hides it.
 * @typedef {object} Drawn
 * @property {import('../../plotting/frame.js').Frame} frame
 * @property {import('../../model/types.js').Answer} answer
 * @property {import('./layers.js').Curves} curves
 * @property {import('./layers.js').Extras} extras
 * @property {ReadonlySet<import('../../model/types.js').MethodName>} shown
 * @property {import('../../plotting/frame.js').Third} third
 * @property {boolean} isHeld */

/** @param {ReturnType<typeof import('./overlay.js').createOverlay>} overlay @param {() => Drawn | null} look
 * @param {(reading: Reading | null) => void} onRead */
export function createCursor(overlay, look, onRead) {
  /** @type {Reading | null} */
  let reading = null;
  /** Where the pointer is, in pixels of the figure; null: not over it.
   * @type {number | null} */
  let pointer = null;

  /** @param {Reading | null} at */
  function read(at) {
    const isKnown = at !== null || reading !== null;
    const drawn = look();
    if (at === null) overlay.clear();
    else if (drawn) overlay.read(drawn.frame, at, drawn.answer.design.method.name, drawn.shown, drawn.third, measuredRows(drawn, at.x));
    if (!isKnown) return;
    reading = at;
    onRead(at);
  }

  /** What was measured at a place on the axis.
   * @param {Drawn} drawn @param {number} x */
  function measuredRows({ extras }, x) {
    return [
      { label: 'Trace', colour: '--measured', measured: extras.measured },
      { label: 'Capture', colour: '--capture', measured: extras.captured },
    ].flatMap(({ label, colour, measured }) => {
      const found = measured ? measuredReadingAt(measured, x) : null;
      return found ? [{ label, colour, reading: found }] : [];
    });
  }

  /** Read what is under the pointer, or else where the keys left the cursor. */
  function readAgain() {
    const drawn = look();
    if (!drawn) return;
    const { frame, answer, curves, extras, isHeld } = drawn;
    const x = pointer === null ? reading?.x : xValue(frame, pointer);
    const isInside = !isHeld && x !== undefined && x >= frame.x.low && x <= frame.x.high;
    if (extras.axes && isInside) overlay.readAxes(frame, axesReadingAt(extras.axes, x));
    else read(isInside && !extras.axes ? readingAt(curves, answer.design.method.name, x) : null);
  }

  function leave() {
    pointer = null;
    read(null);
  }

  return {
    readAgain,
    leave,
    /** @param {number | null} pixel null: the pointer has gone */
    point(pixel) {
      if (pixel === null) return leave();
      pointer = pixel;
      readAgain();
    },
    /** Move along the computed steps.
     * @param {number} by */
    walk(by) {
      const drawn = look();
      const name = drawn?.answer.design.method.name;
      const steps = name && drawn?.curves[name];
      if (!drawn || !name || !steps || drawn.extras.axes) return;
      pointer = null;
      const low = drawn.frame.x.low;
      const index = reading ? steps.step.indexOf(reading.step) + by : steps.x.findIndex((x) => x >= low);
      const at = Math.min(steps.x.length - 1, Math.max(0, index));
      read(readingAt(drawn.curves, name, steps.x[at]));
    },
    /** Where it is, in pixels; the middle where it is nowhere.
     * @param {import('../../plotting/frame.js').Frame} frame */
    pixel: (frame) => (reading ? xPixel(frame, reading.x) : frame.left + frame.width / 2),
  };
}
