// @ts-check
// The formats that a design can be exported in, and what each is good for.

import { METHODS } from '../model/methods.js';

/** What of the request a format looks at besides the design.
 * @typedef {'name' | 'arithmetic' | 'segment_bound_ticks' | 'methods'} ExportOption */
/** @typedef {{name: string, label: string, help: string, kind: 'text' | 'picture' | 'page', options: ExportOption[],
 *   report?: 'html' | 'pdf'}} ExportFormat   report: it is made as a report, not exported */

/** @type {ExportOption[]} */
const OF_A_FORMULA = ['name', 'arithmetic'];
const PLAYED = 'C99, for moves of any length; gives the planned delays, to the tick.';

/** The C code of a method, if it has some.
 * @param {import('../model/types.js').RampMethod} method @returns {ExportFormat[]} */
function codeOf({ code }) {
  if (code === null) return [];
  return [
    { name: code.format, label: code.label, help: `${code.help} ${PLAYED}`, kind: 'text', options: OF_A_FORMULA },
  ];
}

/** @type {{title: string, formats: ExportFormat[]}[]} */
export const EXPORT_GROUPS = [
  {
    title: 'C code',
    formats: [
      {
        name: 'c_segments',
        label: 'Ramp, as segments',
        help: 'Header with the ramp as short straight lines, and the few lines of C that play them: no arithmetic but adding.',
        kind: 'text',
        options: ['name', 'segment_bound_ticks'],
      },
      {
        name: 'c_ramp_image',
        label: 'Ramp, for the library',
        help: 'Header with the ramp as the bytes that StepRamp’s firmware plays: for sketches with the StepRamp library.',
        kind: 'text',
        options: ['name', 'segment_bound_ticks'],
      },
      ...METHODS.flatMap(codeOf),
      {
        name: 'c_table',
        label: 'Lookup table',
        help: 'Header with the table as an array, and a function that looks a delay up.',
        kind: 'text',
        options: ['name'],
      },
      {
        name: 'c_table_progmem',
        label: 'Lookup table, PROGMEM',
        help: 'The same in the program memory of an AVR, where it takes no RAM.',
        kind: 'text',
        options: ['name'],
      },
    ],
  },
  {
    title: 'Arduino sketch',
    formats: [
      {
        name: 'arduino',
        label: 'Sketch for the Uno',
        help: 'A complete .ino that needs no library: at the press of a button it moves there and back, to the tick.',
        kind: 'text',
        options: ['name', 'segment_bound_ticks'],
      },
      {
        name: 'arduino_library',
        label: 'Sketch, with the library',
        help: 'The same with the StepRamp library, for any pins and slower motors: at least 400 µs between two steps.',
        kind: 'text',
        options: ['name', 'segment_bound_ticks'],
      },
    ],
  },
  {
    title: 'Data',
    formats: [
      {
        name: 'csv',
        label: 'Steps, CSV',
        help: 'Every step: interval in ticks and µs, time, position, speed.',
        kind: 'text',
        options: [],
      },
      {
        name: 'json',
        label: 'Design, JSON',
        help: 'The design itself, to be opened here or sent to the API.',
        kind: 'text',
        options: [],
      },
    ],
  },
  {
    title: 'Report',
    formats: [
      {
        name: 'report_pdf',
        label: 'Report, PDF',
        help: 'To be sent or printed: in the units chosen, with the methods shown, the pinned design and a verdict on each warning.',
        kind: 'page',
        options: [],
        report: 'pdf',
      },
      {
        name: 'report_html',
        label: 'Report, HTML',
        help: 'The same as one page that opens offline in any browser.',
        kind: 'page',
        options: [],
        report: 'html',
      },
      {
        name: 'html',
        label: 'Plots to zoom, HTML',
        help: 'One page with numbers, warnings and plots of the methods shown that can be zoomed; opens offline in any browser.',
        kind: 'page',
        options: ['methods'],
      },
      {
        name: 'svg',
        label: 'Plots, SVG',
        help: 'The plots of the methods shown, sharp at any size.',
        kind: 'picture',
        options: ['methods'],
      },
      {
        name: 'png',
        label: 'Plots, PNG',
        help: 'The plots of the methods shown, as a picture of 1500 × 1350 dots.',
        kind: 'picture',
        options: ['methods'],
      },
    ],
  },
];

export const EXPORT_FORMATS = EXPORT_GROUPS.flatMap((group) => group.formats);

/**
 * The beginning of a long text, in whole lines, and how much of it that is; all of a short one.
 * @param {string} text @param {number} mostLines
 * @returns {{shown: string, lines: number, shownLines: number}}
 */
export function beginning(text, mostLines) {
  const lines = text.replace(/\n$/, '').split('\n');
  const shownLines = Math.min(lines.length, mostLines);
  return { shown: lines.slice(0, shownLines).join('\n'), lines: lines.length, shownLines };
}

/** @param {number} bytes */
export function formatBytes(bytes) {
  if (bytes < 1000) return `${bytes} bytes`;
  return bytes < 1e6 ? `${(bytes / 1e3).toFixed(1)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}
