// @ts-check
// What is said to the library of the server: designs with revisions, what was measured of them, pushes, and all of it as a file.

import { readFile, request, sendFile } from './api.js';

/** @typedef {import('../model/types.js').Design} Design */
/** @typedef {import('../model/library.js').Kept} Kept */
/** @typedef {import('../model/library.js').About} About */
/** @typedef {import('../model/library.js').RecordKind} RecordKind */

/** A database may be slow, or locked for a while. */
const WITHIN_MS = 40_000;
const FILE_WITHIN_MS = 300_000;
/** Whole libraries are larger than captures: the server has them on its disk [bytes]. */
export const MOST_LIBRARY_BYTES = 2_147_483_648;
/** So many are told at once: who looks for others says more words. */
export const MOST_FOUND = 100;

/** @param {string} id @param {string} [rest] */
const design = (id, rest = '') => `library/designs/${encodeURIComponent(id)}${rest}`;

/** @param {'GET' | 'POST' | 'PUT'} method @param {string} path @param {unknown} [body] @param {number} [version] */
const ask = (method, path, body, version) => request(method, path, body, { withinMs: WITHIN_MS, version });

export const library = {
  /** @param {string} text words that name, notes and tags have together @param {string[]} tags all of which a design has
   * @returns {Promise<{count: number, designs: Kept[]}>} */
  search: (text, tags) => ask('POST', 'library/search', { text, tags, most: MOST_FOUND }),

  /** @param {string} id @returns {Promise<import('../model/library.js').KeptWithRevisions>} */
  design: (id) => ask('GET', design(id)),

  /** @param {Design} content @param {About & {note: string}} about @returns {Promise<Kept>} */
  add: (content, about) => ask('POST', 'library/designs', { design: content, ...about }),

  /** @param {string} id @param {number} version @param {About} about @returns {Promise<Kept>} */
  describe: (id, version, about) => ask('PUT', design(id), about, version),

  /** @param {string} id @param {number} version @param {Design} content @param {string} note @returns {Promise<Kept>} */
  save: (id, version, content, note) => ask('POST', design(id, '/revisions'), { design: content, note }, version),

  /** @param {string} id @param {number} number @returns {Promise<{number: number, design: Design}>} */
  revision: (id, number) => ask('GET', design(id, `/revisions/${number}`)),

  /** @param {string} id @param {number} number @param {number} other
   * @returns {Promise<{differences: import('../model/library.js').Difference[]}>} */
  differences: (id, number, other) => ask('GET', design(id, `/revisions/${number}/differences/${other}`)),

  /** @param {string} id @param {string} name of the copy @returns {Promise<Kept>} */
  duplicate: (id, name) => ask('POST', design(id, '/duplicate'), { name }),

  /** @param {string} id @returns {Promise<{records: import('../model/library.js').KeptRecord[]}>} */
  records: (id) => ask('GET', design(id, '/records')),

  /** @param {string} id @param {string} record @returns {Promise<{document: any}>} */
  record: (id, record) => ask('GET', design(id, `/records/${encodeURIComponent(record)}`)),

  /** @param {string} id @param {{revision: number, kind: RecordKind, note: string, document: object}} record
   * @returns {Promise<import('../model/library.js').KeptRecord>} */
  keepRecord: (id, record) => ask('POST', design(id, '/records'), record),

  /** @returns {Promise<{devices: import('../model/library.js').SeenDevice[]}>} */
  devices: () => ask('GET', 'library/devices'),

  /** @param {{device_id?: string, design_id?: string}} of nothing: all of them
   * @returns {Promise<{count: number, pushes: import('../model/library.js').PushTold[]}>} */
  pushes: (of) => ask('POST', 'library/pushes/search', { ...of, most: MOST_FOUND }),

  /** @param {string} id
   * @returns {Promise<import('../model/library.js').PushTold & {designs: {axis: number, design: Design}[]}>} */
  push: (id) => ask('GET', `library/pushes/${encodeURIComponent(id)}`),

  /** @returns {Promise<{file: Blob, name: string}>} */
  file: () => request('GET', 'library/file', undefined, { withinMs: FILE_WITHIN_MS, read: readFile }),

  /** @param {File} file @returns {Promise<import('../model/library.js').Imported>} */
  importFile: (file) => sendFile('library/import', file, new AbortController().signal, () => {}, MOST_LIBRARY_BYTES),
};
