// @ts-check
// Keys and hands, wherever on the page: Escape stops, Ctrl+Z takes back, and what is let go of is a change by itself.

import { watchEscape } from '../../ui/escape.js';
import { historyKey } from '../../ui/history_keys.js';
import { announce } from '../commands/told.js';
import { endGesture, redo, undo } from '../commands/work.js';

/** @param {import('../state.js').Store} store @param {() => void} stop */
export function watchKeys({ state, dispatch }, stop) {
  /** @param {'undo' | 'redo'} step */
  function stepHistory(step) {
    const before = state().history;
    dispatch(step === 'undo' ? undo : redo);
    if (state().history !== before) dispatch(announce, step === 'undo' ? 'Undone' : 'Redone');
  }

  watchEscape(stop);
  addEventListener(
    'keydown',
    (event) => {
      const step = historyKey(event);
      if (step === null) return;
      event.preventDefault();
      stepHistory(step);
    },
    { capture: true },
  );
  for (const end of ['focusout', 'change', 'pointerup', 'pointercancel']) addEventListener(end, () => dispatch(endGesture));
  return { undo: () => stepHistory('undo'), redo: () => stepHistory('redo') };
}
