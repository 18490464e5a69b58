// @ts-check
// All that the page knows, in one object that nobody changes: commands make another one of it. And the store, which has
// the present one and tells of the next.

import { FIRST_GUIDE } from '../model/guide.js';
import { SHOWN_AT_FIRST } from '../model/methods.js';
import { STEPS_AND_SECONDS } from '../model/units.js';

/** @typedef {import('../model/types.js').Answer} Answer */
/** @typedef {import('../model/types.js').Design} Design */
/** @typedef {import('../model/types.js').Device} Device */
/** @typedef {import('../model/types.js').MethodName} MethodName */
/** @typedef {import('../model/types.js').Rejection} Rejection */
/** @typedef {import('../model/workbench.js').Machine} Machine */
/** @typedef {'light' | 'dark'} Theme */
/** @typedef {'parameters' | 'table' | 'device'} Tab */
/** @typedef {'push' | 'move' | 'jog' | 'trace'} SectionName */
/** @typedef {Pick<View, 'against' | 'part' | 'only' | 'zoom'>} TableView */

/** @typedef {import('../model/types.js').View} View */

/** What the server says of the design in hand, and of what is laid beside it.
 * @typedef {object} Answers
 * @property {Answer | null} curves     the newest; of an earlier design while `staleness` says so
 * @property {number | null} of         the axis that they are of
 * @property {number | null} about      the axis whose design was asked about last: what follows is said of it alone
 * @property {'refused' | 'unanswered' | null} staleness
 * @property {Rejection[]} rejections   what is wrong with that design
 * @property {Record<number, Design>} refused  the design of each axis that was refused when it was asked about last
 * @property {Pinned | null} pinned
 * @property {AllAxes | null} allAxes    the newest; of earlier designs while `axesStaleness` says so
 * @property {'awaited' | 'unanswered' | null} axesStaleness
 * @property {{design: Design, player: string, ramp: import('../model/types.js').OwnRamp | null} | null} ownRamp  what the
 *   controller in view, or the machine chosen, plays of a design; ramp: null when it refuses it
 * @property {{design: Design, of: number, answer: import('../model/types.js').MotorAnswer | null, rejections: Rejection[]} | null} motor
 *   of: the axis */

/** @typedef {{design: Design, curves: Answer | null}} Pinned   null: the server refuses it */
/** All axes over one time; what was planned is null when the server refuses one of them.
 * @typedef {{axes: Design[], together: import('../model/workbench.js').Together,
 *   planned: import('../model/types.js').ScheduledAxes | null, rejections: Rejection[]}} AllAxes */

/** What is known of the devices, and what was chosen among them.
 * @typedef {object} Devices
 * @property {Device[]} list                   as the server told last
 * @property {import('../model/types.js').Link} link
 * @property {import('../model/types.js').Port[]} ports
 * @property {import('../model/types.js').Family[]} families
 * @property {string | null} port              that a person chose; null: none yet
 * @property {string | null} id                the device in view, which keeps its id at another port
 * @property {Record<string, string>} chosenFamilies  now or before, by port
 * @property {number} axis                     that was chosen; a device may have fewer
 * @property {import('../documents/in_view.js').InView | null} kept  what was in view before a reload, until the devices are told
 * @property {SectionName} section
 * @property {'view' | 'operate'} role         what this page may do, as far as the server has told
 * @property {string | null} asking            what is being asked of a device: "connect", "push" …
 * @property {Rejection[]} rejections          what was refused last
 * @property {Record<string, Pushed>} pushed   what was last pushed from this page, by device
 * @property {Record<string, CutShort>} cutShort  pushes that a STOP ended, of which nothing is known yet, by device
 * @property {Record<string, import('../devices/homing.js').Homing>} homings  the last that this page began, by device
 * @property {boolean} isTracing
 * @property {Record<string, import('../model/types.js').Trace>} traces  by device
 * @property {MeasuredMove | null} measured    the move that was measured last
 * @property {Preview | null} preview
 * @property {Runs} runs
 * @property {import('../model/types.js').Samples[]} removed  of the runs, those that a person took away from the plots
 * @property {boolean} isHaltNext              whether a press of STOP halts
 * @property {import('../devices/stopping.js').Fate} stopFate  what has become of the last STOP
 * @property {Record<string, number>} ages     of devices of which nothing new is known, for how long [whole s]
 * @property {Record<string, import('../model/types.js').KeptLimits[]>} softLimits  last set, by port */

/** What a push would change, or why there can be none, and of what that was said.
 * @typedef {{question: import('./devices.js').PreviewQuestion, preview: import('../model/types.js').Preview | null,
 *   rejections: Rejection[]}} Preview */
/** Designs that were pushed, and the ids of the axes they are of; from which axis of the device on.
 * crc: of the ramps that the device has then; null: it is not known. heard_s: when the device was heard to have them.
 * @typedef {{designs: Design[], ids: number[], toAxis: number, crc: number | null, heard_s: number}} Pushed */
/** A push that a STOP ended, and the ramp that the device had before.
 * @typedef {Pick<Pushed, 'designs' | 'ids' | 'toAxis'> & {before: Device['ramp']}} CutShort */
/** The axis of the page that a move was of, and the design that it was to follow; null: nobody knows.
 * @typedef {{axis: number | null, design: Design | null}} MoveOf */
/** A move whose trace is awaited: what it is of, and by which numbers the server calls the motions that it consists of.
 * @typedef {{of: MoveOf, first: number, last: number}} TracedMove */
/** record: what it is in the library's words, where it comes from there.
 * @typedef {{of: MoveOf, move: import('../model/types.js').Measured, record?: string}} MeasuredMove */
/** What is known of the moves of axes, by device and axis.
 * @typedef {Record<string, {samples: import('../model/types.js').Samples | null, restingPlace: number | undefined}>} Runs */

/** A file of a logic analyser that is laid over the plots.
 * @typedef {object} Capture
 * @property {File} file
 * @property {number} axis                     id of the axis that it was opened for
 * @property {import('../model/types.js').CaptureWish} wish
 * @property {'asked' | 'answered' | 'refused' | 'unanswered' | 'cancelled'} stage
 * @property {number} sent                     share of the file that the server has, from 0 to 1
 * @property {import('../model/types.js').Captured | null} answer  the newest
 * @property {string | null} of                the design that it was held against; null: none could be computed
 * @property {import('../model/types.js').CaptureWish | null} answered  what was wanted of that answer
 * @property {Capture | null} before           that it took the place of, if something was found in that
 * @property {Rejection[]} rejections */

/** What is told to the person.
 * @typedef {object} Told
 * @property {Record<string, string>} urgent   what has to be read before all else, by what it is about
 * @property {{text: string, hasFailed: boolean} | null} notice     shown for a while
 * @property {string | null} fault             of the page itself, shown until it is closed
 * @property {{text: string} | null} announced                      for the ear
 * @property {{text: string} | null} link      that the page may not copy, to be copied by hand
 * @property {{text: string} | null} tableText  in which there may be tables, to look at
 * @property {import('../documents/storage.js').Keeping | null} keeping  whether the browser keeps the design; null: not tried yet */

/** What the page knows of the library.
 * @typedef {object} OfLibrary
 * @property {Record<number, import('../model/library.js').Link>} links  which revision each axis began with, by its id
 * @property {{key: string, label: string, design: Design, curves: Answer | null}[]} beside  what is laid beside the design in hand */

/** What another tab of the browser keeps, be it open or closed.
 * @typedef {{id: string, at_ms: number, isOpen: boolean, machine: Machine}} OtherTab */
/** @typedef {object} OtherTabs
 * @property {OtherTab[]} list         the newest first
 * @property {string | null} offered   that which has changed the design in hand
 * @property {string[]} declined       those whose changes are not wanted */

/** @typedef {object} State
 * @property {import('../model/workbench.js').History | null} history  null until there is something to work on
 * @property {import('../model/units.js').Units} units
 * @property {Theme} theme
 * @property {MethodName[]} shown              the methods that are drawn
 * @property {Record<number, View>} views      by axis
 * @property {boolean} areAllShown             whether the plots show all axes
 * @property {boolean} isOwnShown              whether the plots show what the controller in view plays itself
 * @property {{name: string, title: string} | null} ownMachine  that of the export dialog which is shown in its place
 * @property {[number, number] | null} allZoom into the plots of all axes
 * @property {Tab} tab                         where there is room for one side panel
 * @property {TableView | null} tableView      in the place of the chosen view for as long as the tab of the table is shown
 * @property {import('../plotting/curves.js').Reading | null} reading  what the cursor reads
 * @property {number} row                      that is selected in the table; -1: none
 * @property {number} opened                   grows with each document that takes the place of what was in hand
 * @property {Answers} answers
 * @property {Record<string, import('../model/types.js').StallMap>} stallMaps  by axis and what they go over: "3 load"
 * @property {import('../model/types.js').Example[]} examples  none until the server has told them
 * @property {Design | null} lastExample       that was in hand as it came when the page was left
 * @property {Capture | null} capture
 * @property {import('../model/flight.js').Told[] | null} inFlight  what the motor is told while it moves; null: nothing yet
 * @property {boolean} isCaptureOpen           whether its dialog is
 * @property {Machine | null} replaced         what an example, a file or a link took the place of
 * @property {OfLibrary} library
 * @property {import('../model/guide.js').Guide} guide
 * @property {OtherTabs} otherTabs
 * @property {number} firstId                  from which on no axis of any tab has an id
 * @property {Told} told
 * @property {Devices} devices */

/** @typedef {<Args extends unknown[]>(command: (state: State, ...args: Args) => State, ...args: Args) => void} Dispatch */

/** @type {View} */
export const FIRST_VIEW = {
  against: 'step',
  part: 'whole',
  only: 'velocity',
  third: 'error',
  acceleration: false,
  zoom: null,
  range: null,
};

/** @type {State} */
export const FIRST_STATE = {
  history: null,
  units: STEPS_AND_SECONDS,
  theme: 'dark',
  shown: SHOWN_AT_FIRST,
  views: {},
  areAllShown: false,
  isOwnShown: true,
  ownMachine: null,
  allZoom: null,
  tab: 'parameters',
  tableView: null,
  reading: null,
  row: -1,
  opened: 0,
  answers: { curves: null, of: null, about: null, staleness: null, rejections: [], refused: {}, pinned: null, allAxes: null, axesStaleness: null, ownRamp: null, motor: null },
  stallMaps: {},
  examples: [],
  lastExample: null,
  capture: null,
  isCaptureOpen: false,
  inFlight: null,
  replaced: null,
  library: { links: {}, beside: [] },
  guide: FIRST_GUIDE,
  otherTabs: { list: [], offered: null, declined: [] },
  firstId: 0,
  told: { urgent: {}, notice: null, fault: null, announced: null, link: null, tableText: null, keeping: null },
  devices: {
    list: [],
    link: 'there',
    ports: [],
    families: [],
    port: null,
    id: null,
    chosenFamilies: {},
    role: 'operate',
    axis: 0,
    kept: null,
    section: 'push',
    asking: null,
    rejections: [],
    pushed: {},
    cutShort: {},
    homings: {},
    isTracing: true,
    traces: {},
    measured: null,
    removed: [],
    preview: null,
    runs: {},
    isHaltNext: false,
    stopFate: 'answered',
    ages: {},
    softLimits: {},
  },
};

/** @param {State} first @param {(error: unknown) => void} onError  what one listener throws the others don't feel */
export function createStore(first, onError) {
  let state = first;
  let isTelling = false;
  /** @type {((state: State) => void)[]} */
  const listeners = [];

  function tell() {
    isTelling = true;
    /** Those that have failed: showing so makes another state, at which they may fail again and again. */
    const failed = new Set();
    for (let told = null; told !== state; ) {
      told = state;
      for (const listener of listeners) {
        try {
          listener(state);
        } catch (error) {
          if (failed.has(listener)) continue;
          failed.add(listener);
          onError(error);
        }
      }
    }
    isTelling = false;
  }

  return {
    state: () => state,
    /** @type {Dispatch} */
    dispatch(command, ...args) {
      const next = command(state, ...args);
      if (next === state) return;
      state = next;
      // What a listener asks for is told to all once they have heard of what is.
      if (!isTelling) tell();
    },
    /** Hear of each state from now on, in the order of those who asked first.
     * @param {(state: State) => void} listener */
    subscribe(listener) {
      listeners.push(listener);
    },
  };
}

/** @typedef {ReturnType<typeof createStore>} Store */

/** A listener that acts only when something of what it looks at is another.
 * @param {(state: State) => unknown[]} look @param {(state: State) => void} act
 * @param {State | null} [known] what it has seen already; null: nothing
 * @returns {(state: State) => void} */
export function whenever(look, act, known = null) {
  let before = known && look(known);
  return (state) => {
    const now = look(state);
    if (before !== null && now.every((part, index) => Object.is(part, before?.[index]))) return;
    before = now;
    act(state);
  };
}

/** The same, and it is told what it looks at.
 * @template {unknown[]} Parts
 * @param {(state: State) => [...Parts]} look @param {(...parts: Parts) => void} show @param {State | null} [known]
 * @returns {(state: State) => void} */
export function whenChanged(look, show, known = null) {
  return whenever(look, (state) => show(...look(state)), known);
}

/** A function that works only when it is given something else than the last time.
 * @template {unknown[]} Given @template Made
 * @param {(...given: Given) => Made} make @returns {(...given: Given) => Made} */
export function remembering(make) {
  /** @type {{given: Given, made: Made} | null} */
  let last = null;
  return (...given) => {
    if (last === null || given.some((one, index) => !Object.is(one, last?.given[index]))) last = { given, made: make(...given) };
    return last.made;
  };
}
