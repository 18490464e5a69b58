// @ts-check
// How hands look around in the plots: pointer, wheel, fingers and keys, told apart here and acted upon elsewhere.

const ZOOM_PER_PIXEL = 0.0015;
const ZOOM_PER_KEY = 0.7;
const DOUBLE_TAP_MS = 350;
const TAP_PX = 24;

/**
 * @param {HTMLElement} scope what they look around in; places are pixels from its left edge
 * @param {object} handlers
 * @param {(pixel: number | null) => void} handlers.onPoint  where the pointer is; null: nowhere any more
 * @param {(factor: number, pixel: number) => void} handlers.onZoom  under 1 zooms in, about a place
 * @param {(factor: number) => void} handlers.onZoomAtCursor
 * @param {(pixels: number) => void} handlers.onPan  to the right
 * @param {() => void} handlers.onAll  show all again
 * @param {(by: number) => void} handlers.onWalk  the cursor along the steps
 * @param {() => boolean} handlers.isZoomed
 */
export function watchGestures(scope, { onPoint, onZoom, onZoomAtCursor, onPan, onAll, onWalk, isZoomed }) {
  /** Fingers on the plots, by pointer.
   * @type {Map<number, number>} */
  const fingers = new Map();
  let lastTap = { at: -Infinity, pixel: 0 };
  /** Where a finger alone on the plots was put down; NaN once it is no tap any more. */
  let tapped = NaN;

  /** @param {PointerEvent | WheelEvent} event */
  const pixelOf = (event) => event.clientX - scope.getBoundingClientRect().left;

  /** @param {PointerEvent} event */
  function pressed(event) {
    const pixel = pixelOf(event);
    if (event.pointerType !== 'touch') return onPoint(pixel);
    fingers.set(event.pointerId, pixel);
    tapped = fingers.size === 1 ? pixel : NaN;
    onPoint(fingers.size === 1 ? pixel : null);
  }

  /** @param {PointerEvent} event */
  function moved(event) {
    const pixel = pixelOf(event);
    const before = fingers.get(event.pointerId);
    if (event.pointerType !== 'touch' || before === undefined) return onPoint(pixel);
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    fingers.set(event.pointerId, pixel);
    if (Math.abs(pixel - tapped) > TAP_PX / 2) tapped = NaN;
    if (other !== undefined) pinched(before, pixel, other);
    else if (isZoomed()) onPan(pixel - before);
    else onPoint(pixel);
  }

  /** One finger moves, the other stays where it is: what is under both stays under both.
   * @param {number} before @param {number} now @param {number} other */
  function pinched(before, now, other) {
    const [apart, together] = [Math.abs(now - other), Math.abs(before - other)];
    if (Math.min(apart, together) > TAP_PX) onZoom(together / apart, other);
  }

  /** @param {PointerEvent} event */
  function released(event) {
    if (!fingers.delete(event.pointerId)) return;
    if (Number.isNaN(tapped)) return;
    const pixel = tapped;
    const isSecond = event.timeStamp - lastTap.at < DOUBLE_TAP_MS && Math.abs(pixel - lastTap.pixel) < TAP_PX;
    lastTap = { at: isSecond ? -Infinity : event.timeStamp, pixel };
    if (isSecond) onAll();
  }

  /** @param {KeyboardEvent} event */
  function walked(event) {
    if (event.target !== scope || event.ctrlKey || event.metaKey) return;
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (by !== undefined) onWalk(by * (event.shiftKey ? 10 : 1));
    else if (event.key === '+' || event.key === '=') onZoomAtCursor(ZOOM_PER_KEY);
    else if (event.key === '-') onZoomAtCursor(1 / ZOOM_PER_KEY);
    else if (event.key === '0' || event.key === 'Home') onAll();
    else return;
    event.preventDefault();
  }

  scope.addEventListener('pointerdown', pressed);
  scope.addEventListener('pointermove', moved);
  scope.addEventListener('pointerup', released);
  scope.addEventListener('pointercancel', released);
  scope.addEventListener('pointerleave', (event) => {
    released(event);
    if (event.pointerType !== 'touch') onPoint(null);
  });
  // A finger leaves nothing behind that says where it points; the keys' cursor is theirs.
  document.addEventListener('pointerdown', ({ target }) => {
    if (!(target instanceof Node && scope.contains(target))) onPoint(null);
  });
  scope.addEventListener('focusout', () => onPoint(null));
  scope.addEventListener('keydown', walked);
  scope.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      if (event.shiftKey) onPan(-(event.deltaX || event.deltaY));
      else onZoom(Math.exp(event.deltaY * ZOOM_PER_PIXEL), pixelOf(event));
    },
    { passive: false },
  );
  // Plotly would draw its zoom box under a finger that pans.
  scope.addEventListener('touchstart', (event) => event.stopPropagation(), { capture: true, passive: true });
}
