// @ts-check
// What the server tells of the devices, and what is chosen among them. Nothing here asks anything of a device.

import { homingAfter } from '../../devices/homing.js';
import { areEqual } from '../../model/equal.js';
import { PAGE } from '../../server/api.js';
import { deviceOf, samplesOf } from '../devices.js';
import { measuredOf } from '../selectors.js';
import { tell } from './told.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../state.js').Devices} Devices */
/** @typedef {import('../state.js').Pushed} Pushed */
/** @typedef {import('../state.js').CutShort} CutShort */
/** @typedef {import('../state.js').State} State */

/** @param {State} state @param {Partial<Devices>} known @returns {State} */
const knowing = (state, known) => ({ ...state, devices: { ...state.devices, ...known } });

/** The device in view stays so when it comes back at another port, which is the chosen one from then on.
 * @param {State} state @returns {State} */
function following(state) {
  const { id, port } = state.devices;
  const device = deviceOf(state);
  const next = { id: device?.id ?? null, port: port !== null && device !== null && device.id === id ? device.port : port };
  return next.id === id && next.port === port ? state : knowing(state, next);
}

/** Of those that are not told any more nothing is known.
 * @param {State} state @param {Device[]} list @param {import('../state.js').Runs} runs @returns {State} */
export function heard(state, list, runs) {
  const { pushed, cutShort, homings, traces, preview, removed } = state.devices;
  const told = new Set(list.map(({ id }) => id));
  const known = {
    list,
    runs,
    ...withWritten(list, stillThere(list, onlyOf(told, pushed)), onlyOf(told, cutShort)),
    homings: homingsAfter(list, onlyOf(told, homings)),
    traces: onlyOf(told, traces),
    removed: removed.filter((one) => Object.values(runs).some(({ samples }) => samples === one)),
    preview: preview !== null && told.has(preview.question.id) ? preview : null,
  };
  return following(takenAgain(knowing(state, isBack(state, list) ? { ...known, rejections: [] } : known)));
}

/** Once the devices are told after a reload: where that which was in view is not there any more, another one is, which is said.
 * @param {State} state @returns {State} */
function takenAgain(state) {
  const { kept, list } = state.devices;
  if (kept === null) return state;
  const isThere = list.some(({ port }) => port === kept.port);
  if (isThere || kept.id === null || list.length === 0) return knowing(state, { kept: null });
  const next = knowing(state, { kept: null, port: null, axis: 0 });
  const words = `The controller that was in view, at ${kept.port}, is not connected any more: ${list[0].name}, axis 0, is in view now.`;
  return tell(next, words, true);
}

/** Whether the device in view was lost and is heard again: what was refused before is over.
 * @param {State} state @param {Device[]} list */
function isBack(state, list) {
  const before = deviceOf(state);
  const now = before && list.find(({ id }) => id === before.id);
  const isAway = (/** @type {Device} */ one) => one.state === 'lost' || one.state === 'connecting';
  return now ? isAway(before) && !isAway(now) : false;
}

/** What is known of some devices; the same object when it is of no other.
 * @template Known
 * @param {Set<string>} ids @param {Record<string, Known>} known @returns {Record<string, Known>} */
function onlyOf(ids, known) {
  const entries = Object.entries(known);
  const told = entries.filter(([id]) => ids.has(id));
  return told.length === entries.length ? known : Object.fromEntries(told);
}

/** What has come of homings; the same object when nothing is new of them.
 * @param {Device[]} list @param {Devices['homings']} homings @returns {Devices['homings']} */
function homingsAfter(list, homings) {
  const now = list.flatMap((device) => (homings[device.id] ? [/** @type {const} */ ([device.id, homingAfter(homings[device.id], device)])] : []));
  return now.every(([id, homing]) => homing === homings[id]) ? homings : Object.fromEntries(now);
}

/** What was pushed and not replaced since; the same object when nothing is new of it.
 * @param {Device[]} list @param {Record<string, Pushed>} pushed @returns {Record<string, Pushed>} */
function stillThere(list, pushed) {
  const before = Object.entries(pushed);
  const now = before.map(([id, what]) => /** @type {const} */ ([id, asTold(what, list.find((one) => one.id === id))]));
  if (now.every(([, what], index) => what === before[index][1])) return pushed;
  return Object.fromEntries(now.flatMap(([id, what]) => (what === null ? [] : [[id, what]])));
}

/** What was pushed, with what a STOP ended after all of it had been sent: the device has another ramp since. For as long as this
 * page is in control nobody else can have written it.
 * @param {Device[]} list @param {Record<string, Pushed>} pushed @param {Record<string, CutShort>} cutShort
 * @returns {Pick<Devices, 'pushed' | 'cutShort'>} the same objects when nothing is new of them */
function withWritten(list, pushed, cutShort) {
  return Object.entries(cutShort).reduce((known, [id, { before, ...what }]) => {
    const device = list.find((one) => one.id === id);
    const isOthers = (device?.in_control ?? PAGE) !== PAGE;
    const isWritten = device?.ramp && !UNSETTLED.includes(device.state) && !areEqual(device.ramp, before);
    if (!isOthers && !isWritten) return known;
    const { [id]: _, ...left } = known.cutShort;
    if (isOthers || !device) return { ...known, cutShort: left };
    const written = { ...what, crc: device.ramp?.crc ?? null, heard_s: device.heard_s };
    return { pushed: { ...known.pushed, [id]: written }, cutShort: left };
  }, { pushed, cutShort });
}

// While these last, what is told of a device's ramp may be from before.
const UNSETTLED = ['connecting', 'writing', 'lost'];

/** What was pushed as it stands after what is told of the device; null: it has another ramp since. What was heard before
 * the push may come after its answer.
 * @param {Pushed} what @param {Device | undefined} device @returns {Pushed | null} */
function asTold(what, device) {
  if (what.crc === null || device === undefined || UNSETTLED.includes(device.state)) return what;
  return device.ramp?.crc === what.crc || device.heard_s <= what.heard_s ? what : null;
}

/** @param {State} state @param {import('../../model/types.js').Link} link @returns {State} */
export const linked = (state, link) => (state.devices.link === link ? state : knowing(state, { link }));

/** @param {State} state @param {import('../../model/types.js').Ports} known @returns {State} */
export const portsCame = (state, { ports, families }) => following(knowing(state, { ports, families }));

/** @param {State} state @param {import('../../model/types.js').Access} access @returns {State} */
export const accessCame = (state, { role }) => (state.devices.role === role ? state : knowing(state, { role }));

/** @param {State} state @param {string} port @returns {State} */
export const choosePort = (state, port) => following(knowing(state, { port, id: null, kept: null, rejections: [] }));

/** @param {State} state @param {string} port @param {string} family @returns {State} */
export const chooseFamily = (state, port, family) =>
  knowing({ ...state, ownMachine: null }, { chosenFamilies: { ...state.devices.chosenFamilies, [port]: family } });

/** @param {State} state @param {number} axis of the device @returns {State} */
export const chooseAxis = (state, axis) => knowing(state, { axis });

/** @param {State} state @param {import('../state.js').SectionName} section @returns {State} */
export const chooseSection = (state, section) => knowing(state, { section });

/** Something is being asked of a device: what was refused before is over.
 * @param {State} state @param {string} asking @returns {State} */
export const asks = (state, asking) => knowing(state, { asking, rejections: [] });

/** @param {State} state @returns {State} */
export const answered = (state) => knowing(state, { asking: null });

/** @param {State} state @param {import('../../model/types.js').Rejection[]} rejections @returns {State} */
export function refused(state, rejections) {
  return rejections.length === 0 && state.devices.rejections.length === 0 ? state : knowing(state, { rejections });
}

/** @param {State} state @param {string} id of the device @param {Pushed | null} what  null: it has others
 * @returns {State} */
export function pushed(state, id, what) {
  const { [id]: _, ...others } = state.devices.pushed;
  const { [id]: __, ...cutShort } = state.devices.cutShort;
  if (what === null) return knowing(state, { pushed: others, cutShort });
  const all = { ...others, [id]: what };
  return knowing(state, { pushed: stillThere(state.devices.list, all), cutShort });
}

/** A STOP ended a push: whether the device has its ramps all the same, what it tells next says.
 * @param {State} state @param {string} id of the device @param {CutShort} what @returns {State} */
export function pushCutShort(state, id, what) {
  const { list, pushed: before, cutShort } = state.devices;
  return knowing(state, withWritten(list, before, { ...cutShort, [id]: what }));
}

/** A device was asked to home axes, and does.
 * @param {State} state @param {string} id of the device @param {import('../../devices/homing.js').Homing} homing
 * @returns {State} */
export const homingBegan = (state, id, homing) => knowing(state, { homings: { ...state.devices.homings, [id]: homing } });

/** @param {State} state @param {boolean} isTracing whether moves are measured @returns {State} */
export const setTracing = (state, isTracing) => knowing(state, { isTracing });

/** @param {State} state @param {string} id of the device @param {import('../../model/types.js').Trace} trace
 * @returns {State} */
export const traceCame = (state, id, trace) => knowing(state, { traces: { ...state.devices.traces, [id]: trace } });

/** @param {State} state @param {import('../state.js').MeasuredMove | null} measured @returns {State} */
export const showMeasured = (state, measured) => (state.devices.measured === measured ? state : knowing(state, { measured }));

/** Take the trace away that the plots show, be it measured or told of a move while it ran: none comes in its place.
 * @param {State} state @returns {State} */
export function removeTrace(state) {
  const { measured, removed } = state.devices;
  const told = samplesOf(state);
  return knowing(state, { measured: measuredOf(state) === null ? measured : null, removed: told === null ? removed : [...removed, told] });
}

/** @param {State} state @param {import('../state.js').Preview | null} preview @returns {State} */
export const previewCame = (state, preview) => (state.devices.preview === preview ? state : knowing(state, { preview }));

/** @param {State} state @param {boolean} isHaltNext whether a press of STOP halts
 * @param {import('../../devices/stopping.js').Fate} stopFate what has become of the last @returns {State} */
export function stopKnown(state, isHaltNext, stopFate) {
  const { devices } = state;
  return devices.isHaltNext === isHaltNext && devices.stopFate === stopFate ? state : knowing(state, { isHaltNext, stopFate });
}

/** @param {State} state @param {Record<string, number>} ages of those devices of which nothing new is known @returns {State} */
export const aged = (state, ages) => (areEqual(ages, state.devices.ages) ? state : knowing(state, { ages }));

/** @param {State} state @param {string} port @param {import('../../model/types.js').KeptLimits[]} axes as they are remembered
 * @returns {State} */
export const limitsKept = (state, port, axes) => knowing(state, { softLimits: { ...state.devices.softLimits, [port]: axes } });
