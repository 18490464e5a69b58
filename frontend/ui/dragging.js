// @ts-check
// How a handle of a drawing follows the pointer: captured, once a frame the newest place, and back where it was by Escape.

/** @typedef {{x: number, y: number}} Place  from the upper left corner of the drawing, in its own units */
/** How a handle ends: it stays where it was dragged to, goes back, or is no more ours.
 * @typedef {'stays' | 'restored' | 'left'} DragEnd */

/**
 * @param {SVGElement} drawing
 * @param {object} handlers
 * @param {() => number} handlers.width  how many units the drawing is across
 * @param {(wanted: Place, isHeldToOne: boolean) => void} handlers.onMove  with Shift what was moved less stays as it was
 * @param {(how: DragEnd) => void} handlers.onEnd
 */
export function createDragging(drawing, { width, onMove, onEnd }) {
  /** `grip` is from the pointer to the handle: in units of the drawing, as values would drift on a logarithmic axis.
   * @type {{handle: Element, pointerId: number, grip: Place} | null} */
  let drag = null;
  /** The newest move not yet followed.
   * @type {PointerEvent | null} */
  let pending = null;
  let awaitedFrame = 0;

  /** Where a pointer is in the drawing, also when the page is scaled.
   * @param {PointerEvent} event @returns {Place} */
  function placeOf(event) {
    const box = drawing.getBoundingClientRect();
    const scale = width() / box.width || 1;
    return { x: (event.clientX - box.left) * scale, y: (event.clientY - box.top) * scale };
  }

  /** @param {PointerEvent} event */
  function moved(event) {
    event.stopPropagation();
    pending = event;
    // The newest wins, once a frame.
    if (awaitedFrame === 0) awaitedFrame = requestAnimationFrame(follow);
  }

  function follow() {
    awaitedFrame = 0;
    const event = pending;
    pending = null;
    if (!drag || !event) return;
    const at = placeOf(event);
    onMove({ x: at.x + drag.grip.x, y: at.y + drag.grip.y }, event.shiftKey);
  }

  /** @param {DragEnd} how */
  function finish(how) {
    if (!drag) return;
    cancelAnimationFrame(awaitedFrame);
    // The last move must not be lost.
    if (how === 'stays') follow();
    const { handle, pointerId } = drag;
    [drag, pending, awaitedFrame] = [null, null, 0];
    for (const [name, listener] of listeners) handle.removeEventListener(name, listener);
    removeEventListener('keydown', escaped);
    if (handle.hasPointerCapture(pointerId)) handle.releasePointerCapture(pointerId);
    onEnd(how);
  }

  /** Escape puts the handle back, and stops the motor like everywhere: it is not kept from the page.
   * @param {KeyboardEvent} event */
  function escaped(event) {
    if (event.key === 'Escape') finish('restored');
  }

  /** @type {[string, (event: any) => void][]} */
  const listeners = [
    ['pointermove', moved],
    ['pointerup', () => finish('stays')],
    ['pointercancel', () => finish('restored')],
    ['lostpointercapture', () => finish('stays')],
  ];

  return {
    placeOf,
    finish,
    /** @param {PointerEvent} event the press @param {SVGElement} handle @param {Place} from where the handle is */
    begin(event, handle, from) {
      const at = placeOf(event);
      handle.focus({ preventScroll: true });
      handle.setPointerCapture(event.pointerId);
      drag = { handle, pointerId: event.pointerId, grip: { x: from.x - at.x, y: from.y - at.y } };
      for (const [name, listener] of listeners) handle.addEventListener(name, listener);
      addEventListener('keydown', escaped);
    },
  };
}

const DOUBLE_CLICK_MS = 400;
const DOUBLE_CLICK_PX = { mouse: 6, pen: 12, touch: 24 };

/** Tells a second press close to the first. The browser's own double click never comes where something lays a cover over the
 * page at the first. */
export function createDoublePress() {
  let last = { at: -Infinity, x: 0, y: 0 };
  return (/** @type {PointerEvent} */ press) => {
    const reach = DOUBLE_CLICK_PX[/** @type {keyof typeof DOUBLE_CLICK_PX} */ (press.pointerType)] ?? 6;
    const isSecond =
      press.timeStamp - last.at < DOUBLE_CLICK_MS && Math.hypot(press.clientX - last.x, press.clientY - last.y) < reach;
    last = { at: isSecond ? -Infinity : press.timeStamp, x: press.clientX, y: press.clientY };
    return isSecond;
  };
}
