// @ts-check
// What the browser remembers between visits, for all tabs; what is worked on each keeps for itself.

import { knownMethods } from '../model/methods.js';
import { unitsNamed, unitsText } from '../model/units.js';
import { readText as read, writeText as write } from './storage.js';

/** @typedef {import('../model/types.js').MethodName} MethodName */
/** @typedef {import('../model/units.js').Units} Units */
/** @typedef {import('../model/types.js').Entry} Entry */
/** @typedef {import('../model/types.js').KeptLimits} KeptLimits */
/** How axes are homed, in steps and seconds, as it was typed.
 * @typedef {{axis: number, isChosen: boolean, end: 'low' | 'high', fast: Entry, position: Entry}} AxisHomeKept */
/** @typedef {{axes: AxisHomeKept[], slow: Entry, backOff: Entry, seconds: Entry}} HomingKept */

const UNITS = 'stepramp.units';
const SHOWN = 'stepramp.shown';
const THEME = 'stepramp.theme';
const RUN_SECONDS = 'stepramp.run_seconds';
const SOFT_LIMITS = 'stepramp.soft_limits';
const HOMING = 'stepramp.homing';
const FAMILIES = 'stepramp.families';
const GUIDE = 'stepramp.guide';

/** @returns {Record<string, string>} the family last chosen, by port */
function readFamilies() {
  try {
    const kept = Object.entries(JSON.parse(read(FAMILIES) ?? '{}') ?? {});
    return Object.fromEntries(kept.filter(([, family]) => typeof family === 'string'));
  } catch {
    return {};
  }
}

/** @returns {Record<string, KeptLimits[]>} by port */
function readSoftLimits() {
  try {
    const kept = JSON.parse(read(SOFT_LIMITS) ?? '{}');
    const entries = Object.entries(kept ?? {}).filter(([, axes]) => Array.isArray(axes) && axes.every(isLimited));
    return Object.fromEntries(entries);
  } catch {
    return {};
  }
}

/** @returns {Record<string, HomingKept>} by port */
function readHomings() {
  try {
    const entries = Object.entries(JSON.parse(read(HOMING) ?? '{}') ?? {});
    return Object.fromEntries(entries.filter(([, kept]) => isHoming(kept)));
  } catch {
    return {};
  }
}

const isEntry = (/** @type {unknown} */ value) => typeof value === 'number' || typeof value === 'string';

/** @param {any} kept @returns {kept is HomingKept} */
function isHoming(kept) {
  const areAxes = Array.isArray(kept?.axes) && kept.axes.every((/** @type {any} */ one) => Number.isInteger(one?.axis) && [one.fast, one.position].every(isEntry));
  return areAxes && [kept.slow, kept.backOff, kept.seconds].every(isEntry);
}

/** Whether an axis has a soft limit, and none that can't be one.
 * @param {any} limits @returns {limits is KeptLimits} */
function isLimited(limits) {
  const both = [limits?.lowest_steps, limits?.highest_steps];
  const areKnown = both.every((steps) => steps === null || Number.isInteger(steps));
  return Number.isInteger(limits?.axis) && areKnown && both.some((steps) => steps !== null);
}

export const memory = {
  /** The units last chosen. */
  units: () => unitsNamed(read(UNITS) ?? ''),
  /** @param {Units} units */
  keepUnits: (units) => write(UNITS, unitsText(units)),
  /** The methods last shown, unknown names left out; null: nothing is kept.
   * @returns {MethodName[] | null} */
  shown: () => {
    const names = read(SHOWN)?.split(' ');
    return names ? knownMethods(names) : null;
  },
  /** @param {Iterable<MethodName>} names */
  keepShown: (names) => write(SHOWN, [...names].join(' ')),
  /** How long a run lasts, as it was last typed [s]. */
  runSeconds: () => read(RUN_SECONDS) ?? '10',
  /** @param {string} text */
  keepRunSeconds: (text) => write(RUN_SECONDS, text),
  /** Those of all ports. */
  allSoftLimits: readSoftLimits,
  /** The soft limits last set at a port, of the axes that have some.
   * @param {string} port */
  softLimits: (port) => readSoftLimits()[port] ?? [],
  /** @param {string} port @param {KeptLimits[]} axes those that are set now; others stay */
  keepSoftLimits(port, axes) {
    const all = readSoftLimits();
    const others = (all[port] ?? []).filter(({ axis }) => !axes.some((one) => one.axis === axis));
    write(SOFT_LIMITS, JSON.stringify({ ...all, [port]: [...others, ...axes].filter(isLimited) }));
  },
  /** How axes were last homed at a port; null: none were.
   * @param {string} port */
  homing: (port) => readHomings()[port] ?? null,
  /** @param {string} port @param {HomingKept} homing */
  keepHoming: (port, homing) => write(HOMING, JSON.stringify({ ...readHomings(), [port]: homing })),
  /** The family last chosen of the controller at each port. */
  families: readFamilies,
  /** @param {string} port @param {string} family */
  keepFamily: (port, family) => write(FAMILIES, JSON.stringify({ ...readFamilies(), [port]: family })),
  /** Whether the guide was open when the page was left; null: it never was.
   * @returns {boolean | null} */
  isGuideOpen: () => ({ open: true, closed: false })[read(GUIDE) ?? ''] ?? null,
  /** @param {boolean} isOpen */
  keepGuideOpen: (isOpen) => write(GUIDE, isOpen ? 'open' : 'closed'),
  /** @returns {string | null} */
  theme: () => read(THEME),
  /** @param {string} theme */
  keepTheme: (theme) => write(THEME, theme),
};
