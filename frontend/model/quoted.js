// @ts-check
// Texts of people, as they stand in the page's own sentences.

const TURNS = /[\u0590-\u08ff\u200e\u200f\u202a-\u202e\u2066-\u2069\ufb1d-\ufdff\ufe70-\ufefc\u{10800}-\u{10fff}\u{1e800}-\u{1efff}]/u;
const ISOLATES = /[\u2066-\u2069]/gu;

/** A text of somebody's, kept from having the words after it run backwards, as one with U+202E would.
 * @param {string} text */
export const isolated = (text) => (TURNS.test(text) ? `\u2068${text.replace(ISOLATES, '')}\u2069` : text);

/** The same in quotes.
 * @param {string} text */
export const quoted = (text) => `“${isolated(text)}”`;
