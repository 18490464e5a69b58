// @ts-check
// Designs as files: chosen with a dialog or dropped on the page, and saved. A file that can't be read changes nothing.

import { LONGEST_TEXT, readDocument, writeDocument } from './documents.js';
import { element } from './dom.js';

/** @typedef {import('./documents.js').Reading} Reading */
/** @typedef {import('./workbench.js').Work} Work */
/** @typedef {(reading: Reading, from: string) => void} OnReading */

const ENDING = '.stepramp.json';
const LONGEST_NAME = 80;
// What file names must not hold on one system or another, and what would write them backwards.
const NOT_IN_NAMES = /[\\/:*?"<>|\p{Cc}\p{Bidi_Control}]+/gu;
const RELEASE_MS = 10_000;

/** @param {File} file @returns {Promise<Reading>} */
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

/** Let a file be chosen.
 * @param {OnReading} onReading */
export function openFile(onReading) {
  const input = element('input', { type: 'file', accept: '.json,application/json', className: 'unseen', tabIndex: -1 });
  input.addEventListener('change', async () => {
    const file = input.files?.[0];
    input.remove();
    if (file) onReading(await readFile(file), `“${file.name}”`);
  });
  input.addEventListener('cancel', () => input.remove());
  // In the page, or some browsers forget the input before a file is chosen.
  document.body.append(input);
  input.click();
}

/** Save as a file.
 * @param {Work} work @returns {string} the file's name */
export function saveFile(work) {
  const name = fileName(work.axes.map((design) => design.name));
  const url = URL.createObjectURL(new Blob([`${writeDocument(work)}\n`], { type: 'application/json' }));
  element('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), RELEASE_MS);
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

/** Read files that are dropped anywhere on the page, and say before what a drop would do.
 * @param {{present: () => string, onReading: OnReading}} handlers `present` names what would be replaced */
export function watchDrops({ present, onReading }) {
  const text = element('p');
  const overlay = element('div', { className: 'drop-overlay', id: 'drop-overlay', hidden: true }, text);
  document.body.append(overlay);
  const carriesFiles = (/** @type {DragEvent} */ event) => Boolean(event.dataTransfer?.types.includes('Files'));

  addEventListener('dragover', (event) => {
    if (!carriesFiles(event)) return;
    // Else the browser would leave the page for the file.
    event.preventDefault();
    text.textContent = `Drop a design to open it. It takes the place of “${present() || 'unnamed'}”; undo brings that back.`;
    overlay.hidden = false;
  });
  addEventListener('dragleave', (event) => {
    if (event.relatedTarget === null) overlay.hidden = true;
  });
  addEventListener('drop', async (event) => {
    if (!carriesFiles(event)) return;
    event.preventDefault();
    overlay.hidden = true;
    const files = [...(event.dataTransfer?.files ?? [])];
    if (files.length === 1) onReading(await readFile(files[0]), `“${files[0].name}”`);
    else onReading({ document: null, problem: `${files.length} files were dropped; drop one.` }, 'the page');
  });
}
