// @ts-check
// Ctrl+Z, Ctrl+Shift+Z and Ctrl+Y. In a text field they are the page's too: every key typed there is a change of the
// design, which a browser's own undo would not know of.

/** @param {KeyboardEvent} event @returns {'undo' | 'redo' | null} */
export function historyKey(event) {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return null;
  const key = event.key.toLowerCase();
  if (key === 'y' && !event.shiftKey) return 'redo';
  if (key === 'z') return event.shiftKey ? 'redo' : 'undo';
  return null;
}
