// @ts-check
// Dialogs. None is modal: STOP stays in reach, and Escape stops as well as closes.

import { element, icon } from './dom.js';

/**
 * @param {object} named
 * @param {string} named.id
 * @param {string} named.title
 * @param {(event: SubmitEvent) => void} [named.onSubmit] the content is a form, and the dialog closes when it is sent
 * @param {...Node} content
 */
export function createDialog({ id, title, onSubmit }, ...content) {
  /** What had the focus before, and gets it back.
   * @type {HTMLElement | null} */
  let opener = null;
  const close = () => dialog.close();
  const closing = element(
    'button',
    { className: 'button quiet square small', type: 'button', 'aria-label': 'Close', onclick: close },
    icon('remove'),
  );
  const heading = element('h2', { id: `${id}-title`, textContent: title });
  const whole = [element('div', { className: 'dialog-head' }, heading, closing), ...content];
  const body = onSubmit
    ? element('form', { className: 'dialog-body', method: 'dialog', noValidate: true, onsubmit: onSubmit }, ...whole)
    : element('div', { className: 'dialog-body' }, ...whole);
  const dialog = element('dialog', { className: 'dialog', id, 'aria-labelledby': `${id}-title` }, body);
  // Wherever the focus is, such as on STOP, unless it is in another dialog.
  addEventListener('keydown', (event) => {
    const within = event.target instanceof Element ? event.target.closest('dialog') : null;
    if (event.key === 'Escape' && dialog.open && (within === null || within === dialog)) close();
  });
  dialog.addEventListener('close', () => opener?.focus());
  document.body.append(dialog);
  return {
    element: dialog,
    /** @param {HTMLElement | null} [first] what gets the focus */
    open(first = closing) {
      if (!dialog.open) {
        opener = /** @type {HTMLElement | null} */ (document.activeElement);
        // The last is drawn over those that are open already.
        document.body.append(dialog);
      }
      dialog.show();
      first?.focus();
      if (first instanceof HTMLInputElement && first.type === 'text') first.select();
    },
    close,
    /** @param {string} text */
    entitle(text) {
      heading.textContent = text;
    },
    isOpen: () => dialog.open,
  };
}

/** The last line of a dialog.
 * @param {(() => void) | null} onCancel null: there is nothing to take back
 * @param {...Node} buttons */
export function dialogFoot(onCancel, ...buttons) {
  const cancel =
    onCancel && element('button', { className: 'button', type: 'button', textContent: 'Cancel', onclick: onCancel });
  return element('div', { className: 'dialog-foot' }, cancel, ...buttons);
}
