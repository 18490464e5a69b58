// @ts-check
// Designs as links: the whole document in the address' fragment, which browsers keep to themselves and send nowhere.

import { LONGEST_TEXT, readDocument, writeDocument } from './documents.js';

/** @typedef {import('./documents.js').ReadDocument} ReadDocument */
/** @typedef {import('../model/workbench.js').Work} Work */

const START = '#d=';
const FORMAT = 'deflate-raw';
/** No link longer than this is made or read: four axes of 1,000 rows have half of it [characters]. */
export const LONGEST_LINK = 100_000;
const SLICE_BYTES = 1024;
const DAMAGED = 'This link is damaged: a part of it is missing or was changed on the way. Ask for it again.';

/** Whether a fragment carries a design, or is what is left of one: a place on the page has no "=" in its name.
 * @param {string} fragment as in location.hash */
export function isLink(fragment) {
  return fragment === '#d' || fragment.includes('=');
}

/** The fragment that carries a document. Throws RangeError when it would be longer than browsers and mail take, or
 * nobody could open it.
 * @param {Work} work @returns {Promise<string>} */
export async function encodeLink(work) {
  const text = writeDocument(work, 0);
  const packed = new Blob([text]).stream().pipeThrough(new CompressionStream(FORMAT));
  const bytes = new Uint8Array(await new Response(packed).arrayBuffer());
  const fragment = START + toBase64Url(bytes);
  if (fragment.length > LONGEST_LINK) throw new RangeError(tooLong(fragment.length));
  const { problem } = readDocument(text);
  if (problem !== null) throw new RangeError(`No link was made, since nobody could open it. ${problem}`);
  return fragment;
}

/** The document that a fragment carries.
 * @param {string} fragment as in location.hash @returns {Promise<ReadDocument>} */
export async function decodeLink(fragment) {
  if (fragment.length > LONGEST_LINK) return { document: null, problem: tooLong(fragment.length) };
  const text = fragment.startsWith(START) ? await unpack(fragment.slice(START.length)) : null;
  return text === null ? { document: null, problem: DAMAGED } : readDocument(text);
}

/** @param {number} characters */
function tooLong(characters) {
  const [length, limit] = [characters, LONGEST_LINK].map((count) => count.toLocaleString('en-US'));
  return `A link with ${length} characters is too long; at most ${limit}. Save the design as a file and send that.`;
}

/** The text in a fragment, cut behind the longest that is read; null when it was damaged.
 * @param {string} packed */
async function unpack(packed) {
  try {
    const stream = inSlices(fromBase64Url(packed))
      .pipeThrough(new DecompressionStream(FORMAT))
      .pipeThrough(new TextDecoderStream('utf-8', { fatal: true }));
    return await readUpTo(stream.getReader(), LONGEST_TEXT + 1);
  } catch {
    return null;
  }
}

/** Bytes a slice at a time, and only when the one before was unpacked: of one there may come a thousand times as many.
 * @param {Uint8Array} bytes @returns {ReadableStream<Uint8Array>} */
function inSlices(bytes) {
  let at = 0;
  return new ReadableStream({
    pull(controller) {
      if (at >= bytes.length) controller.close();
      else controller.enqueue(bytes.subarray(at, (at += SLICE_BYTES)));
    },
  });
}

/** A short link can unpack to gigabytes: no more is taken than is needed to see that it is too much.
 * @param {ReadableStreamDefaultReader<string>} reader @param {number} limit characters */
async function readUpTo(reader, limit) {
  let text = '';
  while (text.length < limit) {
    const { done, value } = await reader.read();
    if (done) return text;
    text += value;
  }
  await reader.cancel();
  return text;
}

/** @param {Uint8Array} bytes */
function toBase64Url(bytes) {
  const letters = Array.from(bytes, (byte) => String.fromCharCode(byte)).join('');
  return btoa(letters).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '');
}

/** @param {string} text */
function fromBase64Url(text) {
  if (!/^[\w-]+$/.test(text)) throw new RangeError('letters that are not base64url');
  const letters = atob(text.replaceAll('-', '+').replaceAll('_', '/'));
  return Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
}
