// @ts-check
// The wheel over a control. A panel that scrolls keeps its wheel, unless the control under the pointer has the focus;
// where nothing scrolls, the pointer has to rest there.

const RESTED_MS = 200;
const NOTCH_PX = 50;
const LINE_PX = 33;

/**
 * @param {HTMLElement} control
 * @param {() => boolean} hasFocus
 * @param {(direction: 1 | -1, event: WheelEvent) => void} onTurn
 */
export function watchWheel(control, hasFocus, onTurn) {
  let arrived = 0;
  let turned = 0;
  control.addEventListener('pointermove', ({ timeStamp }) => (arrived = timeStamp));
  control.addEventListener('wheel', turn, { passive: false });

  /** @param {WheelEvent} event */
  function turn(event) {
    const isMeant = hasFocus() || (event.timeStamp - arrived > RESTED_MS && !isInScroller(control));
    if (!isMeant || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    // With Shift held the wheel turns sideways. A touchpad sends many small turns.
    const way = -(event.deltaY || event.deltaX) * (event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : LINE_PX);
    turned = Math.sign(way) === Math.sign(turned) ? turned + way : way;
    if (Math.abs(turned) < NOTCH_PX) return;
    onTurn(turned > 0 ? 1 : -1, event);
    turned = 0;
  }
}

/** @param {HTMLElement} control */
function isInScroller(control) {
  for (let box = control.parentElement; box !== null; box = box.parentElement) {
    if (box.scrollHeight > box.clientHeight && getComputedStyle(box).overflowY === 'auto') return true;
  }
  return false;
}
