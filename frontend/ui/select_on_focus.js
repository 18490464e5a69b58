// @ts-check
// A number is replaced by what is typed into its field, as soon as the field has the focus. A press where the focus is
// already sets the caret, and a drag selects a part, as everywhere.

/** @param {HTMLInputElement} input */
export function selectOnFocus(input) {
  let isFirstPress = false;
  input.addEventListener('pointerdown', () => {
    isFirstPress = document.activeElement !== input;
  });
  input.addEventListener('focus', () => input.select());
  // The press that brought the focus has set the caret by now.
  input.addEventListener('click', () => {
    if (isFirstPress && input.selectionStart === input.selectionEnd) input.select();
    isFirstPress = false;
  });
}
