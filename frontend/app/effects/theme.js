// @ts-check
// The theme, on the page and remembered: the system's until a person chooses.

import { memory } from '../../documents/memory.js';
import { applyTheme, isThemeForced, systemTheme, watchSystemTheme } from '../../ui/theme.js';
import { setTheme } from '../commands/view.js';
import { whenChanged } from '../state.js';

/** @returns {import('../state.js').Theme} */
function wantedTheme() {
  const chosen = isThemeForced() ? null : memory.theme();
  return chosen === 'light' || chosen === 'dark' ? chosen : systemTheme();
}

/** @param {import('../state.js').Store} store */
export function createTheme({ state, dispatch, subscribe }) {
  subscribe(whenChanged(({ theme }) => [theme], applyTheme));
  watchSystemTheme(() => dispatch(setTheme, wantedTheme()));
  dispatch(setTheme, wantedTheme());
  applyTheme(state().theme);
  return {
    switchTheme() {
      const theme = state().theme === 'dark' ? 'light' : 'dark';
      memory.keepTheme(theme);
      dispatch(setTheme, theme);
    },
  };
}
