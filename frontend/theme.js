// @ts-check
// Light and dark: as the system has it until a person chooses.

import { memory } from './memory.js';
import { METHODS } from './methods.js';

/** @typedef {'light' | 'dark'} Theme */

const systemIsLight = matchMedia('(prefers-color-scheme: light)');

/** The tokens of the methods' lines, beside those of tokens.css. */
function methodTokens() {
  const colours = (/** @type {Theme} */ theme) =>
    METHODS.map(({ name, style }) => `--method-${name}: ${style[theme]};`).join(' ');
  const dashes = METHODS.flatMap(({ name, style }) =>
    style.dash ? [`--dash-${name}: ${style.dash.map((px) => `${px}px`).join(', ')};`] : [],
  );
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(`:root { ${colours('dark')} ${dashes.join(' ')} } :root[data-theme='light'] { ${colours('light')} }`);
  return sheet;
}

document.adoptedStyleSheets.push(methodTokens());

/** @returns {Theme} */
function wanted() {
  const chosen = memory.theme();
  if (chosen === 'light' || chosen === 'dark') return chosen;
  return systemIsLight.matches ? 'light' : 'dark';
}

/** Put the theme on the page and keep it in step with the system.
 * @param {() => void} onChange */
export function startTheme(onChange) {
  document.documentElement.dataset.theme = wanted();
  systemIsLight.addEventListener('change', () => {
    document.documentElement.dataset.theme = wanted();
    onChange();
  });
}

/** Change to the other theme and remember it. */
export function switchTheme() {
  const theme = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
  document.documentElement.dataset.theme = theme;
  memory.keepTheme(theme);
}

/** A colour or font token as it stands in the present theme.
 * @param {string} name such as "--grid" */
export function token(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
