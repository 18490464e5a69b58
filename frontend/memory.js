// @ts-check
// What the browser remembers between visits.

import { isDesign } from './design.js';
import { METHODS } from './methods.js';
import { STEPS_AND_SECONDS } from './units.js';
import { MOST_AXES } from './workbench.js';

/** @typedef {import('./types.js').MethodName} MethodName */
/** @typedef {import('./workbench.js').State} State */
/** @typedef {import('./units.js').Units} Units */
/** @typedef {import('./types.js').SoftLimits} SoftLimits */

const STATE = 'stepramp.work';
const REPLACED = 'stepramp.work.replaced';
const UNREADABLE = 'stepramp.work.unreadable';
const UNITS = 'stepramp.units';
const SHOWN = 'stepramp.shown';
const THEME = 'stepramp.theme';
const RUN_SECONDS = 'stepramp.run_seconds';
const SOFT_LIMITS = 'stepramp.soft_limits';
const FAMILIES = 'stepramp.families';

/** Private windows may refuse storage: the page then works without a memory.
 * @param {string} key */
function read(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** @param {string} key @param {string} text @returns {boolean} whether it is kept */
function write(key, text) {
  try {
    localStorage.setItem(key, text);
    return true;
  } catch {
    return false;
  }
}

/** Axes, and what else is kept with them; null: there is nothing, or it can't be shown and is kept aside.
 * @param {string} key @returns {State | null} */
function readState(key) {
  const text = read(key);
  if (text === null) return null;
  try {
    const state = JSON.parse(text);
    if (isState(state)) return state;
  } catch {
    // Not even JSON: kept aside below, like a document of another shape.
  }
  write(UNREADABLE, text);
  return null;
}

/** @param {any} state @returns {state is State} */
function isState(state) {
  return (
    Array.isArray(state?.axes) &&
    state.axes.length >= 1 &&
    state.axes.length <= MOST_AXES &&
    state.axes.every(isDesign) &&
    Number.isInteger(state.active) &&
    state.active >= 0 &&
    state.active < state.axes.length &&
    (state.together === 'independent' || state.together === 'line') &&
    (state.kept === null || isDesign(state.kept))
  );
}

/** @returns {Record<string, unknown>} the family last chosen, by port */
function readFamilies() {
  try {
    return Object(JSON.parse(read(FAMILIES) ?? '{}'));
  } catch {
    return {};
  }
}

/** @returns {Record<string, SoftLimits[]>} by port */
function readSoftLimits() {
  try {
    const kept = JSON.parse(read(SOFT_LIMITS) ?? '{}');
    const entries = Object.entries(kept ?? {}).filter(([, axes]) => Array.isArray(axes) && axes.every(isLimited));
    return Object.fromEntries(entries);
  } catch {
    return {};
  }
}

/** Whether an axis has a soft limit, and none that can't be one.
 * @param {any} limits @returns {limits is SoftLimits} */
function isLimited(limits) {
  const both = [limits?.lowest_steps, limits?.highest_steps];
  const areKnown = both.every((steps) => steps === null || Number.isInteger(steps));
  return Number.isInteger(limits?.axis) && areKnown && both.some((steps) => steps !== null);
}

export const memory = {
  /** What was last worked on. */
  state: () => readState(STATE),
  /** @param {State} state */
  keepState: (state) => write(STATE, JSON.stringify(state)),
  /** What an example, a file or a link took the place of. */
  replaced: () => readState(REPLACED),
  /** @param {State} state */
  keepReplaced: (state) => write(REPLACED, JSON.stringify(state)),
  /** @returns {Units} */
  units: () => {
    const [length, time] = (read(UNITS) ?? '').split(' ');
    const isKnown = ['steps', 'rev', 'deg', 'mm'].includes(length) && ['s', 'min'].includes(time);
    return isKnown ? /** @type {Units} */ ({ length, time }) : STEPS_AND_SECONDS;
  },
  /** @param {Units} units */
  keepUnits: ({ length, time }) => write(UNITS, `${length} ${time}`),
  /** The methods last shown, unknown names left out; null: nothing is kept.
   * @returns {MethodName[] | null} */
  shown: () => {
    const names = read(SHOWN)?.split(' ');
    return names ? METHODS.map((method) => method.name).filter((name) => names.includes(name)) : null;
  },
  /** @param {Iterable<MethodName>} names */
  keepShown: (names) => write(SHOWN, [...names].join(' ')),
  /** How long a run lasts, as it was last typed [s]. */
  runSeconds: () => read(RUN_SECONDS) ?? '10',
  /** @param {string} text */
  keepRunSeconds: (text) => write(RUN_SECONDS, text),
  /** The soft limits last set at a port, of the axes that have some.
   * @param {string} port */
  softLimits: (port) => readSoftLimits()[port] ?? [],
  /** @param {string} port @param {SoftLimits[]} axes those that are set now; others stay */
  keepSoftLimits(port, axes) {
    const all = readSoftLimits();
    const others = (all[port] ?? []).filter(({ axis }) => !axes.some((one) => one.axis === axis));
    write(SOFT_LIMITS, JSON.stringify({ ...all, [port]: [...others, ...axes].filter(isLimited) }));
  },
  /** The family last chosen of the controller at a port; null: none was.
   * @param {string} port */
  family: (port) => {
    const name = readFamilies()[port];
    return typeof name === 'string' ? name : null;
  },
  /** @param {string} port @param {string} family */
  keepFamily: (port, family) => write(FAMILIES, JSON.stringify({ ...readFamilies(), [port]: family })),
  /** @returns {string | null} */
  theme: () => read(THEME),
  /** @param {string} theme */
  keepTheme: (theme) => write(THEME, theme),
};
