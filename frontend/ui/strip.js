// @ts-check
// Strips that scroll sideways without a bar: where they go on, they fade, and no number is seen in part.

/** So far they fade, in controls.css. */
const FADE_PX = 32;

/** Mark where a strip goes on beyond what is seen of it.
 * @param {HTMLElement} strip */
export function watchStrip(strip) {
  function mark() {
    const { scrollLeft, scrollWidth, clientWidth } = strip;
    // Places between pixels are rounded.
    const before = scrollLeft > 1;
    const after = scrollLeft + clientWidth < scrollWidth - 1;
    strip.toggleAttribute('data-more-before', before);
    strip.toggleAttribute('data-more-after', after);
    const { left, right } = strip.getBoundingClientRect();
    const [from, to] = [left + (before ? FADE_PX : -1), right - (after ? FADE_PX : -1)];
    for (const number of strip.querySelectorAll('dd, em')) {
      const place = number.getBoundingClientRect();
      const isCut = place.left < from || place.right > to;
      // What has no room between two such edges is seen as far as it goes.
      number.toggleAttribute('data-cut', isCut && place.width <= clientWidth - 2 * FADE_PX);
    }
  }
  strip.addEventListener('scroll', mark, { passive: true });
  const sizes = new ResizeObserver(mark);
  sizes.observe(strip);
  // What is in it may come, go or grow while it stays as wide.
  const watchParts = () => {
    for (const part of strip.children) sizes.observe(part);
    mark();
  };
  new MutationObserver(watchParts).observe(strip, { childList: true });
  watchParts();
}
