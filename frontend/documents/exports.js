// @ts-check
// The formats that a design can be exported in, and what each is good for.

import { METHODS } from '../model/methods.js';
import { formatFixed, formatSignedPercent } from '../model/numbers.js';

/** What of the request a format looks at besides the design.
 * @typedef {'name' | 'arithmetic' | 'segment_bound_ticks' | 'methods' | 'axis_letter'} ExportOption */
/** @typedef {{name: string, label: string, help: string, kind: 'text' | 'picture' | 'page', options: ExportOption[],
 *   report?: 'html' | 'pdf', isOfMachine?: boolean, title?: string, letters?: string[]}} ExportFormat   report: it is made
 *   as a report, not exported; isOfMachine: what is lost of the design comes with it; title: what people call the machine;
 *   letters: of the axes that it may have; without: all */

/** @type {ExportOption[]} */
const OF_A_FORMULA = ['name', 'arithmetic'];
/** Letters of axes, as machines call them. */
export const AXIS_LETTERS = ['X', 'Y', 'Z', 'A', 'B', 'C'];
const OF_GRBL = AXIS_LETTERS.slice(0, 3);
const PLAYED = 'C99, for moves of any length; gives the planned delays, to the tick.';

/** The C code of a method, if it has some.
 * @param {import('../model/types.js').RampMethod} method @returns {ExportFormat[]} */
function codeOf({ code }) {
  if (code === null) return [];
  return [
    { name: code.format, label: code.label, help: `${code.help} ${PLAYED}`, kind: 'text', options: OF_A_FORMULA },
  ];
}

/** Of machines that ramp by themselves.
 * @param {string} name @param {string} label @param {string} help @param {ExportOption[]} options @returns {ExportFormat} */
function ofMachine(name, label, help, options) {
  return { name, label, help, kind: 'text', options, isOfMachine: true, title: label.split(', ')[0] };
}

/** @param {string} name @param {string} library @param {string} help @returns {ExportFormat} */
function sketchWith(name, library, help) {
  return { ...ofMachine(name, `Sketch, ${library}`, help, ['name']), title: library };
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
        help: 'The same with the StepRamp library, for any pins: from loop() down to 400 µs between two steps, and by Timer1 down to 10 µs.',
        kind: 'text',
        options: ['name', 'segment_bound_ticks'],
      },
      sketchWith('accelstepper', 'AccelStepper', 'For any board: AccelStepper works out a ramp of constant acceleration by itself.'),
      sketchWith('fastaccelstepper', 'FastAccelStepper', 'For Uno, ESP32, Pico and others: its timers make the steps, also fast ones.'),
      sketchWith('teensystep', 'TeensyStep', 'For Teensys: it begins at a pull-in speed.'),
      sketchWith('switecx25', 'SwitecX25', 'For gauges: it plays the design’s lookup table, up to its last row.'),
    ],
  },
  {
    title: 'Other controllers',
    formats: [
      { ...ofMachine('grbl', 'grbl', 'Settings of one axis of grbl 1.1: steps per mm, highest speed, acceleration.', ['axis_letter']), letters: OF_GRBL },
      ofMachine('grblhal', 'grblHAL', 'The same for grblHAL, which may have more axes.', ['axis_letter']),
      ofMachine('fluidnc', 'FluidNC', 'Items of its YAML configuration, for one axis.', ['axis_letter']),
      ofMachine('marlin', 'Marlin, M-codes', 'What is sent to it: steps per mm, speed, acceleration.', ['axis_letter']),
      ofMachine('marlin_configuration', 'Marlin, Configuration.h', 'The same as lines for its source.', ['axis_letter']),
      ofMachine('klipper', 'Klipper', 'Options of its printer.cfg, for one axis.', ['axis_letter']),
      ofMachine('tic', 'Pololu Tic, ticcmd', 'Calls of ticcmd, for a Tic on USB.', []),
      ofMachine('tic_settings', 'Pololu Tic, settings', 'Lines for its settings file, to be kept.', []),
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

/** How a machine's own ramp differs from the design's.
 * @param {Pick<import('../model/types.js').OwnRamp, 'max_relative_error' | 'max_error_step' | 'duration_s' | 'planned_duration_s'>} ramp
 * @param {string} title */
export function playedText({ max_relative_error: error, max_error_step: step, duration_s: lasts, planned_duration_s: planned }, title) {
  const longer = (lasts - planned) * 1000;
  const move = `the move takes ${formatFixed(Math.abs(longer), 1)} ms ${longer < 0 ? 'less' : 'more'} than planned`;
  return `${title} really plays delays that differ by up to ${formatSignedPercent(error)} %, at step ${formatFixed(step)}; ${move}.`;
}

/** @param {number} bytes */
export function formatBytes(bytes) {
  if (bytes < 1000) return `${bytes} bytes`;
  return bytes < 1e6 ? `${(bytes / 1e3).toFixed(1)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}
