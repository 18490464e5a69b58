// @ts-check
// The designs that a search finds: it is asked as words are typed, and by the tags that are pressed.

import { foundText, moreTagsText, revisionsText, tagsOfAll, whenText } from '../../model/library.js';
import { element, showText } from '../../ui/dom.js';
import { tagList } from './rows.js';

/** @typedef {import('../../model/library.js').Kept} Kept */

/** So long nothing is typed before it is asked for. */
const STANDS_MS = 200;
/** More tags than these are found by their words. */
const MOST_TAGS = 12;

/** @param {{search: (text: string, tags: string[]) => Promise<{count: number, designs: Kept[]} | null>, onChoose: (kept: Kept) => void}} act
 *   search: null: it could not be, which is told already */
export function createList({ search, onChoose }) {
  /** @type {string[]} */
  let chosenTags = [];
  /** @type {string[]} */
  let knownTags = [];
  /** @type {Kept[]} */
  let designs = [];
  /** @type {string | null} */
  let chosen = null;
  let asked = 0;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let waiting;
  const words = element('input', {
    id: 'library-search',
    className: 'library-words',
    type: 'search',
    placeholder: 'Search names, notes and tags',
    'aria-label': 'Search names, notes and tags',
    autocomplete: 'off',
    spellcheck: false,
    maxLength: 200,
    oninput: () => {
      clearTimeout(waiting);
      waiting = setTimeout(find, STANDS_MS);
    },
  });
  const tags = element('div', { className: 'library-filter', id: 'library-filter', role: 'group', 'aria-label': 'Only with these tags' });
  const count = element('p', { className: 'muted', id: 'library-count', role: 'status' });
  const list = element('ul', { className: 'library-list', id: 'library-list', 'aria-label': 'Designs' });

  async function find() {
    clearTimeout(waiting);
    asked += 1;
    const mine = asked;
    const isSearched = words.value.trim() !== '' || chosenTags.length > 0;
    const found = await search(words.value.trim(), chosenTags);
    // Meanwhile other words may have been typed.
    if (mine !== asked || found === null) return;
    designs = found.designs;
    if (!isSearched) knownTags = tagsOfAll(designs);
    showText(count, foundText(found.count, designs.length, isSearched));
    draw();
  }

  function draw() {
    const all = [...new Set([...chosenTags, ...knownTags])];
    const offered = all.slice(0, Math.max(MOST_TAGS, chosenTags.length));
    tags.hidden = offered.length === 0;
    tags.replaceChildren(...offered.map(tagButton));
    if (offered.length < all.length) tags.append(element('span', { className: 'muted', textContent: moreTagsText(all.length - offered.length) }));
    list.hidden = designs.length === 0;
    list.replaceChildren(...designs.map((kept) => element('li', {}, designButton(kept))));
  }

  /** @param {string} tag */
  function tagButton(tag) {
    const isPressed = chosenTags.includes(tag);
    const onclick = () => {
      chosenTags = isPressed ? chosenTags.filter((one) => one !== tag) : [...chosenTags, tag];
      draw();
      const again = [...tags.children].find((one) => one.textContent === tag);
      if (again instanceof HTMLElement) again.focus();
      find();
    };
    return element('button', { type: 'button', className: 'library-tag', 'aria-pressed': String(isPressed), textContent: tag, onclick });
  }

  /** @param {Kept} kept */
  function designButton(kept) {
    return element(
      'button',
      { type: 'button', className: 'library-design', 'aria-current': String(kept.id === chosen), onclick: () => onChoose(kept) },
      element('b', { textContent: kept.name || 'unnamed' }),
      element('span', { className: 'muted', textContent: `${revisionsText(kept.revisions)} · ${whenText(kept.saved_at)}` }),
      kept.tags.length > 0 && tagList(kept.tags),
    );
  }

  return {
    element: element('div', { className: 'library-found', id: 'library-found' }, words, tags, count, list),
    words,
    find,
    /** @param {string | null} id of the design in the other pane */
    choose(id) {
      chosen = id;
      for (const [index, one] of [...list.children].entries()) one.children[0]?.setAttribute('aria-current', String(designs[index]?.id === id));
    },
  };
}
