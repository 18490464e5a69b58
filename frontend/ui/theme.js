// @ts-check
// Light and dark: as the system has it until a person chooses.

import { METHODS } from '../model/methods.js';

/** @typedef {'light' | 'dark'} Theme */

const systemIsLight = matchMedia('(prefers-color-scheme: light)');
// Where a person forces colours on all pages, the plots have to suit their ground.
const areForced = matchMedia('(forced-colors: active)');

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
export const systemTheme = () => (systemIsLight.matches ? 'light' : 'dark');

/** Whether the system's theme is the page's, whatever a person chose here. */
export const isThemeForced = () => areForced.matches;

/** @param {() => void} onChange */
export function watchSystemTheme(onChange) {
  for (const setting of [systemIsLight, areForced]) setting.addEventListener('change', onChange);
}

/** Put a theme on the page.
 * @param {Theme} theme */
export function applyTheme(theme) {
  document.documentElement.dataset.theme = theme;
}

/** A colour or font token as it stands in the present theme.
 * @param {string} name such as "--grid" */
export function token(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
