// @ts-check
// Strips that scroll sideways without a bar: where they go on, they fade, and no number is seen in part.

/** Mark where a strip goes on beyond what is seen of it.
 * @param {HTMLElement} strip */
export function watchStrip(strip) {
  function mark() {
    const { scrollLeft, scrollWidth, clientWidth } = strip;
    // Places between pixels are rounded.
    strip.toggleAttribute('data-more-before', scrollLeft > 1);
    strip.toggleAttribute('data-more-after', scrollLeft + clientWidth < scrollWidth - 1);
    const { left, right } = strip.getBoundingClientRect();
    for (const part of strip.children) {
      const place = part.getBoundingClientRect();
      const isCut = place.left < left - 1 || place.right > right + 1;
      part.toggleAttribute('data-cut', isCut && place.width <= clientWidth);
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
