// @ts-check
// What kind of file somebody has opened or dropped: by its name where that says enough, else by what it begins with.

/** @typedef {'design' | 'table' | 'capture'} Kind */

const SOURCES = ['.c', '.h', '.cpp', '.hpp', '.cc', '.ino'];
/** How the names of files end in which tables are looked for. */
export const TABLE_FILES = [...SOURCES, '.csv'];
/** How the names of files end that logic analysers write. */
export const CAPTURE_FILES = ['.csv', '.vcd', '.sr'];
/** So much of a file tells its kind [bytes]. */
export const HEAD_BYTES = 16_384;
/** What else is there, for those who brought something else. */
export const KINDS_TEXT =
  'A design ends in .stepramp.json, a lookup table in .c, .h, .cpp, .ino or .csv, what a logic analyser captured in .csv, .vcd or .sr';
const LOOKED_AT_ROWS = 50;
const SIGROK = /^(?:;|META)\s*(?:CSV.*libsigrok|samplerate:|Channels \()/im;
const COMMENT = /^\s*(?:[;#]|META\b|sep=)/i;
const TIME = /^(?:time(?:\s*[[(].*[\])])?|(?:milli|micro|nano|pico)?seconds|samples|logic)$/i;

/** @param {string} name of the file @param {Uint8Array} head its first bytes @returns {Kind | null} null: none that is known */
export function kindOf(name, head) {
  const ends = (/** @type {string[]} */ endings) => endings.some((ending) => name.toLowerCase().endsWith(ending));
  if (ends(['.json'])) return 'design';
  if (ends(['.vcd', '.sr'])) return 'capture';
  if (ends(SOURCES)) return 'table';
  const text = textOf(head);
  if (isCaptureText(text)) return 'capture';
  if (ends(['.csv'])) return 'table';
  return text.trimStart().startsWith('{') ? 'design' : null;
}

/** Whether a text is what an analyser or a simulator writes: VCD, or rows of levels, and not of steps and their delays.
 * @param {string} text */
export function isCaptureText(text) {
  if (/^\s*\$(?:date|version|timescale|comment|scope|var)\b/.test(text) || SIGROK.test(text)) return true;
  const lines = text.split(/\r\n?|\n/).filter((line) => line.trim() !== '' && !COMMENT.test(line));
  // The last line may be cut.
  const rows = lines.slice(0, Math.min(LOOKED_AT_ROWS, Math.max(1, lines.length - 1))).map(cellsOf);
  if (rows.length === 0) return false;
  return TIME.test(rows[0][0]) || rows[0].includes('logic') || rows.every((cells) => cells.every((cell) => /^[01]$/.test(cell)));
}

/** @param {string} line */
function cellsOf(line) {
  return line.split(/[\t;,]/).map((cell) => cell.trim().replace(/^"(.*)"$/, '$1'));
}

/** Spreadsheets write UTF-16, too.
 * @param {Uint8Array} head */
function textOf(head) {
  const [first, second] = head;
  const encoding = first === 0xff && second === 0xfe ? 'utf-16le' : first === 0xfe && second === 0xff ? 'utf-16be' : 'utf-8';
  return new TextDecoder(encoding).decode(head);
}
