// @ts-check
// Why a text can't be read as a table.

/** Raised by what reads tables, and caught where they are asked for: its message is what a person is told. */
export class Unreadable extends Error {}

/** @param {string} text */
export function shortened(text) {
  const line = text.replace(/\s+/g, ' ').trim();
  return line.length > 32 ? `${line.slice(0, 31)}…` : line;
}
