// @ts-check
// What kind of file somebody has opened or dropped: by its name where that says enough, else by what it begins with.

/** @typedef {'design' | 'table' | 'capture' | 'settings'} Kind */

const SOURCES = ['.c', '.h', '.cpp', '.hpp', '.cc', '.ino'];
/** How the names of files end in which tables are looked for. */
export const TABLE_FILES = [...SOURCES, '.csv'];
/** How the names of files end that logic analysers write. */
export const CAPTURE_FILES = ['.csv', '.vcd', '.sr'];
/** How the names of files end that controllers' settings are kept in. */
export const SETTINGS_FILES = ['.txt', '.yaml', '.cfg'];
/** So much of a file tells its kind [bytes]. */
export const HEAD_BYTES = 16_384;
/** What else is there, for those who brought something else. */
export const KINDS_TEXT =
  'A design ends in .stepramp.json, a lookup table in .c, .h, .cpp, .ino or .csv, what a logic analyser captured in .csv, .vcd or .sr; what a controller lists of itself is known by its lines';
/** What can be pasted, for those who pasted something else. */
export const PASTES_TEXT =
  'What a controller tells of itself can be pasted: grbl’s lines after $$, Marlin’s after M503, FluidNC’s configuration, Klipper’s printer.cfg, a Tic’s settings file, a backup saved here; rows of a lookup table into the table. A design is opened as a file';
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
  if (isListing(text)) return 'settings';
  if (isCaptureText(text)) return 'capture';
  if (ends(['.csv'])) return 'table';
  return text.trimStart().startsWith('{') ? 'design' : null;
}

/** A line begins with blanks, and never with line ends: from each of many of those all the rest would be looked at. No two
 * rows of blanks follow each other, and each mark begins as no other does, for the same reason.
 * What is found in a text that tells a controller's settings, all of each: as grbl lists them after $$, also with a terminal's
 * marks before them, a Tic's settings file, also without a figure, Klipper's printer.cfg, Marlin after M503, of which a program
 * has no line with its echo, FluidNC's configuration, and backups: of TMCL, of Klipper, and all that StepRamp has saved. */
const LISTINGS = [
  [/^[ \t]*\$1[0-2]\d[ \t]*=/m],
  [/^[ \t]*(?:(?:>+|<+|\$\$|\[[^\]\r\n]*\]|[A-Za-z]\w*:|[\d:.]+)[ \t]+)+\$1[0-2]\d=[\d.]/m],
  [/^[ \t]*max_speed[ \t]*:/m, /^[ \t]*max_accel[ \t]*:/m],
  [/^[ \t]*max_(?:speed|accel)[ \t]*:/m, /^[ \t]*(?:starting_speed|max_decel|step_mode)[ \t]*:/m],
  [/^\[(?:printer|stepper_[xyz])\]/m],
  ['M92', 'M201', 'M203'].map((code) => new RegExp(`^[ \\t]*(?:[\\d:.]+[ \\t]+)?(?:[<>]+[ \\t]*)?(?:Recv:[ \\t]*)?(?:echo:[ \\t]*)?${code} +[XYZE]`, 'm')),
  [/^[ \t]*(?:[\d:.]+[ \t]+)?(?:[<>]+[ \t]*)?(?:Recv:[ \t]*)?echo:[ \t]*M(?:92|201|203) +[XYZE]/m],
  [/^axes[ \t]*:/m, /^[ \t]+steps_per_mm[ \t]*:/m],
  [/^[ \t]*axis \d parameter \d{1,3} = -?\d/m],
  [/^[ \t]*(?:\{[ \t]*)?"backup_of"[ \t]*:[ \t]*"klipper"/m],
  [/^\ufeff?# StepRamp backup\b/],
];

/** Whether a text tells a controller's settings, whichever it is.
 * @param {string} text */
export function isListing(text) {
  // What is copied from a page may have spaces that don't break.
  const head = text.slice(0, HEAD_BYTES).replaceAll('\u00a0', ' ');
  return LISTINGS.some((lines) => lines.every((line) => line.test(head)));
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
