// @ts-check
// Escape, wherever the focus is. A key held down is one press.

/** The list of a select that is open keeps the key's going down to itself and lets the page see only that it comes up,
 * or that it repeats: whichever is seen first is the press.
 * @param {() => void} press */
export function watchEscape(press) {
  let isDown = false;
  addEventListener(
    'keydown',
    (event) => {
      if (event.key !== 'Escape') return;
      if (!isDown || !event.repeat) press();
      isDown = true;
    },
    { capture: true },
  );
  addEventListener(
    'keyup',
    (event) => {
      if (event.key !== 'Escape') return;
      if (!isDown) press();
      isDown = false;
    },
    { capture: true },
  );
  // Let go of in another window, it is not seen to come up here.
  addEventListener('blur', () => {
    isDown = false;
  });
}
