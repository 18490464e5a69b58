// @ts-check
// Files: chosen with a dialog or dropped on the page, each taken for what it is, and designs saved. A file that can't be
// read changes nothing.

import { LONGEST_TEXT, readDocument, writeDocument } from './documents.js';
import { CAPTURE_FILES, HEAD_BYTES, isListing, kindOf, KINDS_TEXT, PASTES_TEXT, SETTINGS_FILES, TABLE_FILES } from './kinds.js';
import { LONGEST_SOURCE } from './table_text.js';
import { quoted } from '../model/quoted.js';
import { element } from '../ui/dom.js';
import { download } from '../ui/download.js';

/** @typedef {import('./documents.js').ReadDocument} ReadDocument */
/** @typedef {import('../model/workbench.js').Work} Work */
/** @typedef {(read: ReadDocument, from: string) => void} OnDocument */
/** What is done with files, by what they are.
 * @typedef {object} Takers
 * @property {OnDocument} onDocument
 * @property {(text: string) => void} onTable  the text of a file in which there may be tables
 * @property {(file: File) => void} onCapture  a file as logic analysers write it
 * @property {(text: string) => void} onSettings  what a controller lists of itself */

const ENDING = '.stepramp.json';
const LONGEST_NAME = 80;
/** Into which texts of any kind may be pasted. */
const TEXT_FIELDS = 'input:not([type="range"], [type="checkbox"], [type="radio"]), textarea';
// What file names must not hold on one system or another, and what would write them backwards.
const NOT_IN_NAMES = /[\\/:*?"<>|\p{Cc}\p{Bidi_Control}]+/gu;

/** @param {File} file @returns {Promise<ReadDocument>} */
export async function readFile(file) {
  if (file.size > LONGEST_TEXT) {
    const [size, limit] = [file.size, LONGEST_TEXT].map((count) => count.toLocaleString('en-US'));
    return { document: null, problem: `The file has ${size} bytes; a design has at most ${limit}.` };
  }
  try {
    const text = new TextDecoder('utf-8', { fatal: true }).decode(await file.arrayBuffer());
    return readDocument(text);
  } catch (error) {
    const isBinary = error instanceof TypeError;
    return { document: null, problem: isBinary ? 'This is no text, and so no design.' : 'It can’t be read.' };
  }
}

/** The text of a table's file, or why there is none.
 * @param {File} file @returns {Promise<{text: string, problem: null} | {text: null, problem: string}>} */
export async function readTableFile(file) {
  if (file.size > LONGEST_SOURCE) {
    const [size, limit] = [file.size, LONGEST_SOURCE].map((count) => count.toLocaleString('en-US'));
    return { text: null, problem: `${quoted(file.name)} has ${size} bytes; a table is read from at most ${limit}.` };
  }
  try {
    const bytes = await file.arrayBuffer();
    const text = decoded(bytes);
    const isText = !text.includes('\0');
    return isText ? { text, problem: null } : { text: null, problem: `${quoted(file.name)} is no text, and so no table.` };
  } catch {
    return { text: null, problem: `${quoted(file.name)} can’t be read.` };
  }
}

/** Old sources are in an encoding of their own.
 * @param {ArrayBuffer} bytes */
function decoded(bytes) {
  try {
    return new TextDecoder('utf-8', { fatal: true }).decode(bytes);
  } catch {
    return new TextDecoder('windows-1252').decode(bytes);
  }
}

/** Let a file be chosen.
 * @param {string} accept @param {(file: File) => void} onFile */
function chooseFile(accept, onFile) {
  const input = element('input', { type: 'file', accept, className: 'unseen', tabIndex: -1 });
  input.addEventListener('change', () => {
    const file = input.files?.[0];
    input.remove();
    if (file) onFile(file);
  });
  input.addEventListener('cancel', () => input.remove());
  // In the page, or some browsers forget the input before a file is chosen.
  document.body.append(input);
  input.click();
}

/** Let a file of any kind be chosen.
 * @param {Takers} takers */
export function openFile(takers) {
  chooseFile(['.json', ...TABLE_FILES, ...CAPTURE_FILES, ...SETTINGS_FILES].join(','), (file) => takeFile(file, takers));
}

/** Let a file that an analyser has written be chosen: all kinds, as analysers end their names in many ways.
 * @param {(file: File) => void} onCapture */
export function openCaptureFile(onCapture) {
  chooseFile('', onCapture);
}

/** @param {File} file @param {Takers} takers */
async function takeFile(file, { onDocument, onTable, onCapture, onSettings }) {
  const kind = kindOf(file.name, await headOf(file));
  if (kind === 'capture') onCapture(file);
  else if (kind === 'design') onDocument(await readFile(file), quoted(file.name));
  else if (kind === null) onDocument({ document: null, problem: `It is nothing that StepRamp reads. ${KINDS_TEXT}.` }, quoted(file.name));
  else {
    const { text, problem } = await readTableFile(file);
    if (text === null) onDocument({ document: null, problem }, 'the file');
    else if (kind === 'settings') onSettings(text);
    else onTable(text);
  }
}

/** Take what a controller lists of itself wherever it is pasted: no field has use for that. Of other texts that no field takes
 * it is said that nothing came of them.
 * @param {Pick<Takers, 'onDocument' | 'onSettings'>} takers */
export function watchPastes({ onDocument, onSettings }) {
  document.addEventListener('paste', (event) => {
    const text = event.clipboardData?.getData('text/plain') ?? '';
    if (event.defaultPrevented) return;
    if (isListing(text)) {
      event.preventDefault();
      onSettings(text);
    } else if (!(event.target instanceof Element && event.target.matches(TEXT_FIELDS))) {
      onDocument({ document: null, problem: `It is nothing that StepRamp reads. ${PASTES_TEXT}.` }, 'what was pasted');
    }
  });
}

/** @param {File} file @returns {Promise<Uint8Array>} nothing of what can't be read */
async function headOf(file) {
  try {
    return new Uint8Array(await file.slice(0, HEAD_BYTES).arrayBuffer());
  } catch {
    return new Uint8Array();
  }
}

/** Let a table's file be chosen.
 * @param {(text: string) => void} onText @param {(problem: string) => void} onProblem */
export function openTableFile(onText, onProblem) {
  chooseFile(TABLE_FILES.join(','), async (file) => {
    const { text, problem } = await readTableFile(file);
    if (text === null) onProblem(problem);
    else onText(text);
  });
}

/** Save designs as a file.
 * @param {Work} work @returns {string} the file's name */
export function saveFile(work) {
  const name = fileName(work.axes.map((design) => design.name));
  download(new Blob([`${writeDocument(work)}\n`], { type: 'application/json' }), name);
  return name;
}

/** A file's name from those of the designs in it.
 * @param {string[]} names */
export function fileName(names) {
  const joined = [...new Set(names.filter((name) => name.trim() !== ''))].join(' + ');
  const clean = joined.replace(NOT_IN_NAMES, '-').replace(/\s+/g, ' ').trim();
  const short = [...clean]
    .slice(0, LONGEST_NAME)
    .join('')
    .replace(/^\.+|[. ]+$/g, '');
  return (short || 'design') + ENDING;
}

/** Take files that are dropped anywhere on the page, and say before what a drop would do.
 * @param {() => string} present  names what would be replaced
 * @param {Takers} takers */
export function watchDrops(present, takers) {
  const text = element('p');
  const overlay = element('div', { className: 'drop-overlay', id: 'drop-overlay', hidden: true }, text);
  document.body.append(overlay);
  const carriesFiles = (/** @type {DragEvent} */ event) => Boolean(event.dataTransfer?.types.includes('Files'));

  addEventListener('dragover', (event) => {
    if (!carriesFiles(event)) return;
    // Else the browser would leave the page for the file.
    event.preventDefault();
    text.textContent = `Drop a design to open it. It takes the place of ${quoted(present() || 'unnamed')}; undo brings that back. Of C and CSV a lookup table is taken, after a look at it. What a logic analyser captured, as CSV, VCD or .sr, is laid over the plots. What a controller lists of itself becomes designs.`;
    overlay.hidden = false;
  });
  addEventListener('dragleave', (event) => {
    if (event.relatedTarget === null) overlay.hidden = true;
  });
  addEventListener('drop', (event) => {
    if (!carriesFiles(event)) return;
    event.preventDefault();
    overlay.hidden = true;
    const files = [...(event.dataTransfer?.files ?? [])];
    const [file] = files;
    if (files.length !== 1) {
      takers.onDocument({ document: null, problem: `${files.length} files were dropped; drop one.` }, 'the page');
    } else takeFile(file, takers);
  });
}
