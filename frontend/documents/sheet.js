// @ts-check
// Rows of a table as CSV and spreadsheets have them: a line each.

import { numberOf } from './c_numbers.js';
import { refuseTooMany, rowOf, withoutEmptyEnd } from './table_row.js';
import { shortened, Unreadable } from './unreadable.js';

const NUMBER = /^[+-]?[\w.]+(e[+-]?\d+)?$/i;

/** @param {string} text a row a line, its cells parted by tabs, semicolons, commas or spaces
 * @returns {number[][]} @throws {Unreadable} */
export function sheetRows(text) {
  const [first, ...rest] = text
    .split('\n')
    .map((line) => line.replace(/\r$/, ''))
    .filter((line) => line.trim() !== '' && !/^sep=.$/i.test(line.trim()));
  if (first === undefined) throw new Unreadable('There is nothing to read yet.');
  const heading = cellsOf(first);
  const isHeading = rest.length > 0 && heading.length > 1 && heading.every((cell) => !/\d/.test(cell));
  refuseTooMany(rest.length + (isHeading ? 0 : 1));
  const body = rest.map(cellsOf);
  if (!isHeading) return [heading, ...body].map((cells, index) => rowOf(withoutEmptyEnd(cells), index, numberIn));
  const [step, delay] = columnsOf(heading);
  return body.map((cells, index) => rowOf([cells[step] ?? '', cells[delay] ?? ''], index, numberIn));
}

/** Which columns a heading calls the step and the delay; the first two where it says nothing of them.
 * @param {string[]} heading */
function columnsOf(heading) {
  const step = heading.findIndex((cell) => /step|index/i.test(cell) && !/\//.test(cell));
  const delay = heading.findIndex((cell) => /delay|interval|period|wait/i.test(cell));
  if (step >= 0 && delay >= 0) return [step, delay];
  if (heading.length === 2) return [0, 1];
  throw new Unreadable(
    `The heading has ${heading.length} columns, and none that are called “step” and “delay”: “${shortened(heading.join(', '))}”.`,
  );
}

/** @param {string} line */
function cellsOf(line) {
  const separator = ['\t', ';', ','].find((sign) => line.includes(sign)) ?? ' ';
  if (separator === ' ') return line.trim().split(/\s+/);
  // Quotation marks keep a separator within a cell.
  const cells = line.match(CELLS[separator]) ?? [];
  return cells.map((cell) =>
    plainNumber(
      cell
        .trim()
        .replace(/^"(.*)"$/, '$1')
        .trim(),
    ),
  );
}

/** Patterns of cells by separator.
 * @type {Record<string, RegExp>} */
const CELLS = {
  ',': /("[^"]*"|[^,])+|(?<=,|^)(?=,|$)/g,
  ';': /("[^"]*"|[^;])+|(?<=;|^)(?=;|$)/g,
  '\t': /("[^"]*"|[^\t])+|(?<=\t|^)(?=\t|$)/g,
};

/** A number as a spreadsheet writes it, without what parts its thousands and with a point for a decimal comma: 8,284 and
 * 1.234.567 are whole, as rows are; 1500,5 is not. Other text stays.
 * @param {string} cell */
function plainNumber(cell) {
  if (/^[+-]?[1-9]\d{0,2}([ ,'’\u00a0\u202f]\d{3})+(\.\d*)?$/.test(cell))
    return cell.replace(/[ ,'’\u00a0\u202f]/g, '');
  if (/^[+-]?[1-9]\d{0,2}(\.\d{3}){2,}$|^[+-]?[1-9]\d{0,2}(\.\d{3})+,\d+$/.test(cell))
    return cell.replaceAll('.', '').replace(',', '.');
  return /^[+-]?\d+,\d+$/.test(cell) ? cell.replace(',', '.') : cell;
}

/** A cell holds a number, and no sum: 2026-01-02 is a day.
 * @param {string} cell */
function numberIn(cell) {
  if (cell !== '' && !NUMBER.test(cell)) throw new Unreadable(`“${shortened(cell)}” is not a number`);
  return numberOf(cell, new Map());
}
