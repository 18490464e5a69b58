// @ts-check
// The link to copy by hand, where the browser does not let the page copy it.

import { createDialog } from '../../dialog.js';
import { element } from '../../dom.js';

export function createLinkDialog() {
  const field = element('input', { id: 'share-link', readOnly: true, onfocus: () => field.select() });
  const label = element('label', {
    htmlFor: 'share-link',
    textContent: 'The browser did not let the page copy it: copy it from here.',
  });
  const dialog = createDialog({ id: 'share-dialog', title: 'Share a link' }, label, field);
  return {
    /** @param {string} link */
    open(link) {
      field.value = link;
      dialog.open(field);
    },
  };
}
