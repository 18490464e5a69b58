// @ts-check
// Ctrl+Z, Ctrl+Shift+Z and Ctrl+Y: the page's history, or that of the text in hand. In a field with text that was
// typed since it got the focus they are the text's; a design that follows the text follows it back.

/** @type {{field: EventTarget | null, before: string, after: string}} */
const NOTHING = { field: null, before: '', after: '' };
/** The field that was typed in last: how it was before, and how it was left. */
let typing = NOTHING;

/** What can be typed in has text; the others, such as a slider, have none.
 * @param {EventTarget | null} target @returns {HTMLInputElement | HTMLTextAreaElement | null} */
function textField(target) {
  const isText =
    target instanceof HTMLTextAreaElement ||
    (target instanceof HTMLInputElement && ['text', 'search', 'number', 'url'].includes(target.type));
  return isText ? target : null;
}

/** @param {{target: EventTarget | null}} event */
function begun({ target }) {
  const field = textField(target);
  if (field && (typing.field !== field || typing.after !== field.value)) {
    typing = { field, before: field.value, after: field.value };
  }
}

/** @param {{target: EventTarget | null}} event */
function typed({ target }) {
  const field = textField(target);
  if (field && typing.field === field) typing.after = field.value;
}

/** @param {HTMLInputElement | HTMLTextAreaElement} field @param {'undo' | 'redo'} step */
function isOfText(field, step) {
  // Set by the page since, it is no longer what was typed.
  if (typing.field !== field || typing.after !== field.value) return false;
  return step === 'redo' || field.value !== typing.before;
}

/** The step that a key asks of the page's history; null: it asks none. In a dialog it never does.
 * @param {KeyboardEvent} event @returns {'undo' | 'redo' | null} */
export function historyKey(event) {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return null;
  const key = event.key.toLowerCase();
  const isRedo = (key === 'y' && !event.shiftKey) || (key === 'z' && event.shiftKey);
  if (!isRedo && key !== 'z') return null;
  const step = isRedo ? 'redo' : 'undo';
  const field = textField(event.target);
  if (field === null) return step;
  if (isOfText(field, step)) return null;
  if (field.closest('dialog') === null) {
    typing = NOTHING;
    return step;
  }
  // With nothing left to undo here, browsers go on with what was typed in other fields.
  event.preventDefault();
  return null;
}

// From the beginning: what is typed before the first of these keys counts.
if (typeof document !== 'undefined') {
  document.addEventListener('beforeinput', begun, { capture: true });
  document.addEventListener('input', typed, { capture: true });
  // Left, or finished with Enter, it is done: what is taken back then is what was set, not what was typed on the way.
  for (const end of ['focusout', 'change']) document.addEventListener(end, () => (typing = NOTHING), { capture: true });
}
