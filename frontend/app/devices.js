// @ts-check
// What follows from the state of devices: the one in view, what a push of it would send, and what of them moves.

import { isAtTarget } from '../devices/traces.js';
import { areSameRamps } from '../model/design.js';
import { areEqual } from '../model/equal.js';
import { nameText, pushRefusals } from '../model/messages.js';
import { lengthText } from '../model/places.js';
import { inShownUnits } from '../model/told.js';
import { atScale, scaleOf } from '../model/units.js';
import { PAGE } from '../server/api.js';
import { axisOf, designOf, isDesignValid, machineOf, messagesOf, stalenessOf } from './selectors.js';
import { remembering } from './state.js';

/** @typedef {import('../model/types.js').Design} Design */
/** @typedef {import('../model/types.js').Device} Device */
/** @typedef {import('./state.js').State} State */

/** The ports that can be chosen, with those of devices that are not listed any more.
 * @param {State} state @returns {[string, string][]} */
export function portChoicesOf({ devices: { ports, list } }) {
  const gone = list.filter((one) => !ports.some((known) => known.port === one.port));
  return [
    ...ports.map((known) => /** @type {[string, string]} */ ([known.port, known.name])),
    ...gone.map((one) => /** @type {[string, string]} */ ([one.port, `${one.name} (${one.port})`])),
  ];
}

/** The port in view. Until a person chooses, a device that is connected already comes first: a reload finds it again.
 * @param {State} state */
export function portOf(state) {
  const { list, ports, port, id } = state.devices;
  const followed = list.find((one) => one.id === id);
  if (followed) return followed.port;
  const choices = portChoicesOf(state);
  // Which there are may not have been told yet.
  if (port !== null && (ports.length === 0 || choices.some(([value]) => value === port))) return port;
  return list[0]?.port ?? choices[0]?.[0] ?? '';
}

/** The device in view; null: none is connected there.
 * @param {State} state @returns {Device | null} */
export function deviceOf(state) {
  const { list, id } = state.devices;
  const port = portOf(state);
  return list.find((one) => one.id === id) ?? list.find((one) => one.port === port) ?? null;
}

/** What is kept of that over a reload: the device, its port and its axis. As long as no devices are told, what was kept before.
 * @param {State} state @returns {[string | null, string | null, number]} */
export function inViewOf(state) {
  const { kept, port, axis } = state.devices;
  if (kept !== null) return [kept.id, kept.port, kept.axis];
  const device = deviceOf(state);
  return [device?.id ?? null, device?.port ?? port, axis];
}

/** The families that a controller at the port in view may be of.
 * @param {State} state */
export function familiesOf(state) {
  const { ports, families } = state.devices;
  const taken = ports.find(({ port }) => port === portOf(state))?.families;
  return taken ? families.filter(({ name }) => taken.includes(name)) : families;
}

/** The family chosen for the port in view, now or before; until then the first.
 * @param {State} state */
export function familyOf(state) {
  const offered = familiesOf(state);
  const last = state.devices.chosenFamilies[portOf(state)];
  return (offered.find(({ name }) => name === last) ?? offered[0])?.name ?? '';
}

/** The family whose own ramp is of interest: that of the device in view, or the one chosen for its port; null: it plays what is
 * planned, or it isn't known what.
 * @param {State} state @returns {import('../model/types.js').Family | null} */
export function ownFamilyOf(state) {
  const name = deviceOf(state)?.family ?? familyOf(state);
  const family = state.devices.families.find((one) => one.name === name);
  return family?.plays_own ? family : null;
}

/** Who plays a ramp of its own that is of interest, and whom to ask for it: the machine that was chosen, or the controller in view.
 * @param {State} state @returns {{route: string, title: string, stepsPerMm: number | null} | null} */
export function ownPlayerOf(state) {
  const { ownMachine } = state;
  if (ownMachine !== null) return { route: `machine/${ownMachine.name}`, title: ownMachine.title, stepsPerMm: null };
  const family = ownFamilyOf(state);
  return family && { route: `families/${family.name}`, title: family.title, stepsPerMm: stepsPerMmOf(state) };
}

/** The steps per mm that the axis of the device is set to which plays the design in hand: that in view, unless another does;
 * null: not known.
 * @param {State} state @returns {number | null} */
export function stepsPerMmOf(state) {
  const axes = deviceOf(state)?.axes ?? [];
  const inHand = machineOf(state)?.active ?? null;
  const played = playedOf(state);
  const playing = played === null || played === inHand ? deviceAxisOf(state) : axes.findIndex((_, axis) => playedOf(state, axis) === inHand);
  return axes[playing]?.steps_per_mm ?? null;
}

/** How many axes of the device can be chosen: while a single design is pushed, one more than there are, as the next axis
 * may be given a ramp.
 * @param {State} state */
export function axesOffered(state) {
  const device = deviceOf(state);
  const count = device === null || device.state === 'lost' ? 0 : device.axes.length;
  const isGiving =
    state.devices.section === 'push' &&
    designsToPush(state).length === 1 &&
    device?.ramp &&
    count > 0 &&
    count < (device.most_axes ?? 0);
  return Math.max(1, isGiving ? count + 1 : count);
}

/** The axis of the device that is worked with.
 * @param {State} state */
export const deviceAxisOf = (state) => (state.devices.axis < axesOffered(state) ? state.devices.axis : 0);

/** The place among the page's axes of the design that an axis of the device plays, as far as the page knows: the one
 * that was pushed there last, or else the one that a push of all gives it; null: nobody knows.
 * @param {State} state @param {number} [axis] of the device; the chosen one @returns {number | null} */
export function playedOf(state, axis = deviceAxisOf(state)) {
  const [machine, device] = [machineOf(state), deviceOf(state)];
  if (machine === null || device === null || device.state === 'lost') return null;
  const given = moveOf(state, device.id, axis).axis;
  const arePushedTogether = machine.axes.length > 1 && designsToPush(state).length === machine.axes.length;
  const place = given === null ? (arePushedTogether ? axis : -1) : machine.ids.indexOf(given);
  return machine.axes[place] === undefined ? null : place;
}

/** The designs that a push sends: of more than the device can have axes only the one in hand.
 * @param {State} state @returns {Design[]} */
export function designsToPush(state) {
  const machine = machineOf(state);
  const most = deviceOf(state)?.most_axes ?? Infinity;
  return machine === null ? [] : toPush(machine.axes, machine.active, most);
}

const toPush = remembering(
  (/** @type {Design[]} */ axes, /** @type {number} */ active, /** @type {number} */ most) =>
    axes.length > most ? [axes[active]] : axes,
);

/** The design of each axis of the device that can be chosen, as it is and with the scale that the controller tells: the one in
 * hand where the device can't have those of all axes.
 * @param {State} state @param {import('../model/workbench.js').Machine} machine
 * @returns {Pick<import('../model/types.js').Situation, 'played' | 'scaled'>} */
function axisDesignsOf(state, machine) {
  const axes = deviceOf(state)?.axes ?? [];
  const places = Math.max(axesOffered(state), axes.length);
  const scales = Array.from({ length: places }, (_, axis) => scaleOf(axes[axis]));
  return axisDesigns(machine, designsToPush(state).length === machine.axes.length, JSON.stringify(scales));
}

// The scales as a text: the devices are told anew with all that moves.
const axisDesigns = remembering(
  (/** @type {import('../model/workbench.js').Machine} */ { axes, active }, /** @type {boolean} */ areAll, /** @type {string} */ scales) => {
    const told = /** @type {import('../model/units.js').Scale[]} */ (JSON.parse(scales));
    const played = told.map((_, axis) => (areAll && axes[axis]) || axes[active]);
    return { played, scaled: played.map((design, axis) => atScale(design, told[axis])) };
  },
);

/** What decides what a push would change.
 * ids: of the axes whose designs they are.
 * @typedef {{id: string, state: unknown[], axis: number, designs: Design[], ids: number[]}} PreviewQuestion */

/** What is to be asked of the device about a push; null: nothing can be now.
 * @param {State} state @returns {PreviewQuestion | null} */
export const previewQuestionOf = (state) => (isDesignValid(state) ? pushQuestionOf(state) : null);

/** The same whether the design in hand is sound or not.
 * @param {State} state @returns {PreviewQuestion | null} */
function pushQuestionOf(state) {
  const device = deviceOf(state);
  if (state.devices.link !== 'there' || device?.state !== 'ready') return null;
  const { id, ramp, on_trial, timer_hz, in_control, motors_on } = device;
  const designs = designsToPush(state);
  // What a push warns of depends on its scale, too, which somebody else may set meanwhile.
  const scales = device.axes.map(({ steps_per_mm, microsteps }) => `${steps_per_mm} ${microsteps}`).join();
  // With motors that have current, some aren't restarted.
  return { id, state: [ramp, on_trial, timer_hz, in_control, scales, motors_on], axis: deviceAxisOf(state), designs, ids: idsToPush(state) };
}

/** The ids of the axes whose designs a push sends.
 * @param {State} state @returns {number[]} */
export function idsToPush(state) {
  const machine = machineOf(state);
  if (machine === null) return [];
  return designsToPush(state).length === machine.ids.length ? machine.ids : [machine.ids[machine.active]];
}

/** @type {import('../model/types.js').PushRefusal[]} */
const NO_REFUSALS = [];

/** Why a push is refused, each with the axis of the page that is to blame. */
const refusals = remembering((/** @type {import('./state.js').Preview} */ { question, rejections }, /** @type {import('../model/units.js').Units} */ units) =>
  pushRefusals(rejections.map(inShownUnits(units, question.designs))).map(({ axis, ...refusal }) => ({ ...refusal, axis: axis === null ? null : question.ids[axis] })),
);

/** The axes that are refused, be it by themselves or by the device, by their ids.
 * @param {State} state @returns {number[]} */
export const refusedAxesOf = (state) =>
  refusedAxes(machineOf(state), state.answers.refused, situationOf(state)?.refusals ?? NO_REFUSALS);

const refusedAxes = remembering(
  (
    /** @type {import('../model/workbench.js').Machine | null} */ machine,
    /** @type {Record<number, Design>} */ refused,
    /** @type {import('../model/types.js').PushRefusal[]} */ ofPush,
  ) => (machine?.ids ?? []).filter((id, at) => refused[id] === machine?.axes[at] || ofPush.some(({ axis }) => axis === id)),
);

/** @param {PreviewQuestion} one @param {PreviewQuestion} other */
export function areSameQuestions(one, other) {
  return (
    one.id === other.id &&
    one.axis === other.axis &&
    areEqual([one.state, one.ids], [other.state, other.ids]) &&
    areSameRamps(one.designs, other.designs)
  );
}

/** What decides which of the device's buttons can be used; null until there is a design.
 * @param {State} state */
export const situationOf = (state) => {
  const machine = machineOf(state);
  return machine && situation(state.devices, machine, state.units, isDesignValid(state), stalenessOf(state), nameProblemOf(state), state);
};

/** What is wrong with the name of the design in hand; empty: nothing.
 * @param {State} state */
const nameProblemOf = (state) => nameText(messagesOf(state).fields.get('name'), designOf(state)?.name ?? '');

/** @param {import('./state.js').Devices} devices @param {import('../model/workbench.js').Machine} machine
 * @param {import('../model/units.js').Units} units @param {boolean} isValid
 * @param {import('../model/types.js').Staleness} staleness @param {string} nameProblem
 * @param {State} state @returns {import('../model/types.js').Situation} */
function makeSituation(devices, machine, units, isValid, staleness, nameProblem, state) {
  const isAwaited = staleness === 'awaited';
  const device = deviceOf(state);
  const pushing = designsToPush(state);
  const last = device ? devices.pushed[device.id]?.designs : undefined;
  // What is known of these designs stays in view while an answer is awaited.
  const question = isValid || isAwaited ? pushQuestionOf(state) : null;
  const { preview } = devices;
  const would = question && preview && areSameQuestions(preview.question, question) ? preview : null;
  return {
    isDesignValid: isValid,
    isAwaited,
    nameProblem,
    designs: machine.axes,
    ids: machine.ids,
    active: machine.active,
    ...axisDesignsOf(state, machine),
    units,
    toPush: pushing,
    link: devices.link,
    age: device ? (devices.ages[device.id] ?? null) : null,
    isBusy: devices.asking !== null,
    isPushing: devices.asking === 'push',
    // What is refused is no change yet.
    isChanged: last !== undefined && staleness !== 'refused' && !areSameRamps(last, pushing),
    mayAct: devices.role === 'operate',
    isOthers: device !== null && device.in_control !== null && device.in_control !== PAGE,
    isTracing: devices.isTracing,
    preview: would?.preview ?? null,
    isPreviewAwaited: question !== null && would === null,
    refusals: would ? refusals(would, units) : NO_REFUSALS,
    lastPushed: last ?? null,
    trace: device ? (devices.traces[device.id] ?? null) : null,
  };
}

/** Anew only when one of the others is another: the rest of the state has no say in it.
 * @type {typeof makeSituation} */
const situation = (() => {
  /** @type {{of: unknown[], made: import('../model/types.js').Situation} | null} */
  let last = null;
  return (devices, machine, units, isValid, staleness, nameProblem, state) => {
    const of = [devices, machine, units, isValid, staleness, nameProblem];
    if (last === null || of.some((one, index) => one !== last?.of[index])) {
      last = { of, made: makeSituation(devices, machine, units, isValid, staleness, nameProblem, state) };
    }
    return last.made;
  };
})();

/** The device that the head of the page tells of: what moves, or will by itself, be it the one in view or another; else the one
 * in view, or any that is connected.
 * @param {State} state */
export function toldDeviceOf(state) {
  const { list } = state.devices;
  const moving = list.find(({ state: does }) => does === 'moving' || does === 'stopping');
  return moving ?? list.find(({ shuttle }) => shuttle) ?? deviceOf(state) ?? list[0] ?? null;
}

/** Where a device is, as its panel shows it, to go on with after its state: the axis in view of the device in view, the
 * first one of another; empty: it isn't known.
 * @param {State} state @param {Device} device */
export function placeTextOf(state, device) {
  const axis = deviceOf(state)?.id === device.id ? deviceAxisOf(state) : 0;
  const [one, design] = [device.axes[axis], situationOf(state)?.played[axis] ?? designOf(state)];
  if (!one?.position_told || !design || device.state === 'lost' || device.state === 'connecting') return '';
  const which = device.axes.length > 1 ? `, axis ${axis}` : '';
  return `${which} at ${lengthText(state.units, atScale(design, scaleOf(one)), one.position_steps)}`;
}

/** How old what is known of that device is [whole s]; null: it is new.
 * @param {State} state */
export function toldAgeOf(state) {
  const device = toldDeviceOf(state);
  return device && (state.devices.ages[device.id] ?? null);
}

/** What a device was found to have, where nothing was pushed from here: the page was loaded anew since. Known as long as nothing on it has changed.
 * @param {State} state @param {string} id of the device @returns {Pick<import('./state.js').Pushed, 'designs' | 'ids' | 'toAxis'> | null} */
function foundOn(state, id) {
  const { preview } = state.devices;
  const device = state.devices.list.find((one) => one.id === id);
  if (!device || preview?.question.id !== id || preview.preview?.same !== true) return null;
  if (!areEqual(preview.question.state.slice(0, 1), [device.ramp])) return null;
  const { designs, ids, axis } = preview.question;
  return { designs, ids, toAxis: designs.length === 1 ? axis : 0 };
}

/** What a move of a device's axis is of.
 * @param {State} state @param {string} id of the device @param {number} axis of it @returns {import('./state.js').MoveOf} */
export function moveOf(state, id, axis) {
  const last = state.devices.pushed[id] ?? foundOn(state, id);
  const design = last?.designs[axis - last.toAxis] ?? null;
  return { axis: design && last ? last.ids[axis - last.toAxis] : null, design };
}

/** @typedef {{done: number, remaining: number, speed: number, isOld: boolean}} RunningMove  in steps since its start and to
 *   its end; isOld: it was so when it was last heard of */

/** Whether what the axis that is worked with does belongs over the plots: not when it was given another axis' ramp.
 * @param {State} state @param {string} id of the device */
function isOfAxisInHand(state, id) {
  const { axis } = moveOf(state, id, deviceAxisOf(state));
  return axis === null || axis === axisOf(state);
}

/** The move of the axis that is worked with, counted from its start and its end; null when it rests.
 * @param {State} state @returns {RunningMove | null} */
export function runningMoveOf(state) {
  const device = deviceOf(state);
  if (device !== null && !isOfAxisInHand(state, device.id)) return null;
  const axis = deviceAxisOf(state);
  const one = device?.axes[axis];
  if (!device || !one || (one.state !== 'moving' && one.state !== 'stopping')) return null;
  const isOld = state.devices.link !== 'there' || (state.devices.ages[device.id] ?? null) !== null;
  const run = state.devices.runs[runKey(device.id, axis)];
  return runningMove(one, run?.restingPlace, isOld, isAtTarget(one) && (run?.samples?.length ?? null) === null);
}

/** Whether that axis moves, or rests only until the next half of there and back.
 * @param {State} state */
export function isGoingOn(state) {
  const device = deviceOf(state);
  if (device === null || !isOfAxisInHand(state, device.id)) return false;
  return runningMoveOf(state) !== null || device.shuttle?.axis === deviceAxisOf(state);
}

const runningMove = remembering(
  (
    /** @type {import('../model/types.js').AxisState} */ one,
    /** @type {number | undefined} */ start, /** @type {boolean} */ isOld, /** @type {boolean} */ isEndless,
  ) => {
    const remaining = isEndless ? Infinity : Math.abs(one.target_steps - one.position_steps);
    const done = start === undefined ? one.steps_made : Math.abs(one.position_steps - start);
    return { done, remaining, speed: one.speed_steps_per_s, isOld };
  },
);

/** What is known of the running or last move of the axis that is worked with, unless it was taken away; null also of what had
 * no end to go to, as a jog: no plan is like it.
 * @param {State} state */
export function samplesOf(state) {
  const device = deviceOf(state);
  if (device === null || !isOfAxisInHand(state, device.id)) return null;
  const samples = state.devices.runs[runKey(device.id, deviceAxisOf(state))]?.samples ?? null;
  return samples === null || samples.length === null || state.devices.removed.includes(samples) ? null : samples;
}

/** Whether that move follows the ramp that is plotted, as far as the page knows: only then its ends are those of the plan.
 * @param {State} state */
export function isMoveOfPlotted(state) {
  const device = deviceOf(state);
  const [made, present] = [device && moveOf(state, device.id, deviceAxisOf(state)).design, designOf(state)];
  return made !== null && present !== null && areSameRamps([{ ...made, move: present.move }], [present]);
}

/** @param {string} id @param {number} axis */
const runKey = (id, axis) => `${id} ${axis}`;
