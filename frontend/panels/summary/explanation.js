// @ts-check
// What a figure means, over the figure that is pointed at, touched or in focus.

import { element } from '../../ui/dom.js';

/** @param {HTMLElement} root what the figures stand in, which the explanation must not leave */
export function createExplanation(root) {
  const box = element('p', { className: 'figure-help', id: 'figure-help', role: 'tooltip', hidden: true });
  root.append(box);

  /** @param {HTMLElement} figure @param {string} text */
  function show(figure, text) {
    box.textContent = text;
    box.hidden = false;
    const room = root.clientWidth - box.offsetWidth;
    const from = figure.getBoundingClientRect().left - root.getBoundingClientRect().left;
    box.style.left = `${Math.max(0, Math.min(from, room))}px`;
  }

  const hide = () => {
    box.hidden = true;
  };
  addEventListener('keydown', ({ key }) => key === 'Escape' && hide());
  return {
    /** @param {HTMLElement} figure @param {string} text */
    explain(figure, text) {
      figure.tabIndex = 0;
      figure.setAttribute('aria-description', text);
      for (const name of ['pointerenter', 'focus']) figure.addEventListener(name, () => show(figure, text));
      for (const name of ['pointerleave', 'blur']) figure.addEventListener(name, hide);
    },
  };
}
