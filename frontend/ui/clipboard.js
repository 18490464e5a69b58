// @ts-check
// Putting text on the clipboard.

/** Whether the text is on the clipboard now. A page that is not served securely has no clipboard of its own: there the
 * text is selected and copied as by hand. Throws what a promised text is rejected with.
 * @param {string | Promise<string>} text  promised: WebKit takes nothing from a page that asks once a press is over */
export async function copyText(text) {
  try {
    await navigator.clipboard.write([new ClipboardItem({ 'text/plain': plain(text) })]);
    return true;
  } catch {
    return copySelected(await text);
  }
}

/** @param {string | Promise<string>} text */
async function plain(text) {
  return new Blob([await text], { type: 'text/plain' });
}

/** @param {string} text */
function copySelected(text) {
  const focused = /** @type {HTMLElement | null} */ (document.activeElement);
  const field = document.createElement('textarea');
  field.value = text;
  field.className = 'unseen';
  document.body.append(field);
  field.select();
  const isCopied = document.execCommand('copy');
  field.remove();
  focused?.focus();
  return isCopied;
}
