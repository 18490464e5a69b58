// @ts-check
// The links that skip to a panel, the first things that the keyboard reaches. A panel that another tab hides is shown.

/** @param {HTMLElement} root @param {(panel: string) => void} show */
export function watchSkips(root, show) {
  root.addEventListener('click', (event) => {
    const link = event.target instanceof Element ? event.target.closest('a') : null;
    if (link === null) return;
    // The address is that of a design: it stays as it is.
    event.preventDefault();
    const panel = link.hash.slice(1);
    show(panel);
    document.getElementById(panel)?.focus();
  });
}
