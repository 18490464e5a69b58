// @ts-check
// Somebody else was quicker: what they did is told, and both versions can be had. Nothing is overwritten whatever is chosen.

import { conflictText } from '../../model/library.js';
import { element, messageLine } from '../../ui/dom.js';
import { button } from './rows.js';

/** @typedef {import('../../model/library.js').KeptWithRevisions} KeptWithRevisions */
/** @typedef {import('../../model/library.js').Link} Link */
/** @typedef {import('../../app/effects/library.js').Mine} Mine */

/** @param {{openTheirs: (theirs: KeptWithRevisions) => void, saveMine: (mine: Mine, theirs: KeptWithRevisions, note: string) => void,
 *   saveCopy: (mine: Mine, theirs: KeptWithRevisions, note: string) => void, look: (theirs: KeptWithRevisions) => void}} act */
export function createConflict({ openTheirs, saveMine, saveCopy, look }) {
  const root = element('div', { className: 'library-conflict', id: 'library-conflict', role: 'alert' });
  return {
    element: root,
    /** @param {Mine} mine whatever is in hand when a choice is made @param {KeptWithRevisions} theirs @param {Link} link
     * @param {string} note of mine @param {boolean} isRoom for another axis */
    show(mine, theirs, link, note, isRoom) {
      const choices = /** @type {[string, string, () => void][]} */ ([
        ...(isRoom ? [['Open theirs beside mine', 'As another axis, to look at both; mine stays as it is', () => openTheirs(theirs)]] : []),
        ['See what they changed', 'Their revisions, and what these differ in', () => look(theirs)],
        [`Save mine as revision ${theirs.revisions + 1}`, 'On top of theirs, which stays as it is', () => saveMine(mine, theirs, note)],
        ['Save mine as a copy', 'As a design of its own', () => saveCopy(mine, theirs, note)],
      ]);
      root.replaceChildren(
        element('h3', { textContent: 'Somebody else was quicker' }),
        messageLine({ text: conflictText(theirs, link), isWarning: true }),
        element('ul', { className: 'library-choices' }, ...choices.map(([text, why, act]) => element('li', {}, button(text, act), element('span', { className: 'muted', textContent: why })))),
      );
    },
  };
}
