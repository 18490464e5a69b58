// @ts-check
// What is told to the person who sits there.

/** @typedef {import('../state.js').State} State */
/** @typedef {import('../state.js').Told} Told */

const FULL =
  'This browser has no room left to keep your design: what you change now is gone when this tab is closed. Save it as a file.';

/** @param {State} state @param {Partial<Told>} told @returns {State} */
const telling = (state, told) => ({ ...state, told: { ...state.told, ...told } });

/** For the ear: what the eye sees by itself.
 * @param {State} state @param {string} text @returns {State} */
export const announce = (state, text) => telling(state, { announced: { text } });

/** What nothing else on the page shows is shown for a while.
 * @param {State} state @param {string} text @param {boolean} hasFailed @returns {State} */
export const tell = (state, text, hasFailed) => telling(state, { announced: { text }, notice: { text, hasFailed } });

/** What came of something before is no answer to what is asked now.
 * @param {State} state @returns {State} */
export const closeNotice = (state) => telling(state, { notice: null });

/** What went wrong in the page itself stays until it is closed.
 * @param {State} state @param {string} fault @returns {State} */
export const tellFault = (state, fault) => telling(state, { fault, announced: { text: fault } });

/** @param {State} state @returns {State} */
export const closeFault = (state) => telling(state, { fault: null });

/** What has to be read before all else; '' once it is over.
 * @param {State} state @param {string} about what it takes the place of @param {string} text @returns {State} */
export function urge(state, about, text) {
  if ((state.told.urgent[about] ?? '') === text) return state;
  const { [about]: _, ...others } = state.told.urgent;
  return telling(state, { urgent: text === '' ? others : { ...others, [about]: text } });
}

/** A link that the page may not copy.
 * @param {State} state @param {string} text @returns {State} */
export const showLink = (state, text) => telling(state, { link: { text } });

/** A text in which there may be tables, such as that of a file that was dropped.
 * @param {State} state @param {string} text @returns {State} */
export const showTableText = (state, text) => telling(state, { tableText: { text } });

/** Whether the browser keeps the design; that it has no room for it has to be known before it is too late.
 * @param {State} state @param {import('../../documents/storage.js').Keeping} keeping @returns {State} */
export function saved(state, keeping) {
  if (state.told.keeping === keeping) return state;
  return urge(telling(state, { keeping }), 'keeping', keeping === 'full' ? FULL : '');
}

/** What was in hand can be had back.
 * @param {State} state @param {import('../../model/workbench.js').Machine | null} replaced @returns {State} */
export const setAside = (state, replaced) => ({ ...state, replaced });
