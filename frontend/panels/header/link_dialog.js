// @ts-check
// The link to copy by hand, where the browser does not let the page copy it.

import { createDialog } from '../../ui/dialog.js';
import { element } from '../../ui/dom.js';

export function createLinkDialog() {
  const field = element('input', { id: 'share-link', readOnly: true, onfocus: () => field.select() });
  const label = element('label', {
    htmlFor: 'share-link',
    textContent: 'The browser did not let the page copy it: copy it from here.',
  });
  const needed = element('p', {
    className: 'muted',
    textContent: `To open it, StepRamp has to run at ${location.host}.`,
  });
  const dialog = createDialog({ id: 'share-dialog', title: 'Share a link' }, label, field, needed);
  return {
    /** @param {string} link */
    open(link) {
      field.value = link;
      dialog.open(field);
    },
  };
}
