// @ts-check
// The device: which one, what it does, and in sections what can be done with it.

import { chooseAxis, chooseFamily, choosePort, chooseSection, refused as refuse, setTracing } from '../../app/commands/device.js';
import { tell } from '../../app/commands/told.js';
import { axesOffered, deviceAxisOf, deviceOf, familiesOf, familyOf, playedOf, portChoicesOf, portOf, situationOf } from '../../app/devices.js';
import { machineOf } from '../../app/selectors.js';
import { whenChanged, whenever } from '../../app/state.js';
import { shownState } from '../../devices/state_words.js';
import { memory } from '../../documents/memory.js';
import { UNKNOWN_PAGE } from '../../server/api.js';
import { closeButton, element, icon, messageLine, picker, segmented, showText } from '../../ui/dom.js';
import { pushText } from '../../model/messages.js';
import { withSavedAt } from '../../model/saved_at.js';
import { inShownUnits } from '../../model/told.js';
import { createHome } from './home.js';
import { createInputs } from './inputs.js';
import { createJogSection } from './jog_section.js';
import { createLimitsOffer } from './limits_offer.js';
import { createLive } from './live.js';
import { createMachine } from './machine.js';
import { createMoveSection } from './move_section.js';
import { createPushSection } from './push_section.js';
import { withoutThatOf } from '../../ui/refusal.js';
import { createSettingsDialog } from './settings_dialog.js';
import { createSurroundings } from './surroundings.js';
import { createTraceSection } from './trace_section.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').Situation} Situation */
/** @typedef {import('./section.js').Section} Section */
/** @typedef {import('../../app/state.js').SectionName} SectionName */
/** @typedef {import('../../app/state.js').State} State */

/** @type {[SectionName, string][]} */
const SECTIONS = [
  ['push', 'Push'],
  ['move', 'Move'],
  ['jog', 'Jog'],
  ['trace', 'Trace'],
];
/** The first line of a section is as high, at most. */
const LINE_PX = 40;
/** What people read for a state; all others are called what they are.
 * @type {Record<string, string>} */
const STATE_WORDS = { none: 'not connected', connecting: 'waiting for the board' };
const RESTARTS = 'It restarts to prove what it has stored.';
/** What the settings are of a device that has all of them, and of one that keeps how it drives its pins to itself. */
const SETTINGS = { all: 'Device settings: how it drives its pins, and soft limits', limits: 'Device settings: soft limits' };

/**
 * @param {HTMLElement} root
 * @param {import('../../app/state.js').Dispatch} dispatch
 * @param {import('../../app/effects/device_actions.js').DeviceActions &
 *   {jog: Parameters<typeof createJogSection>[0]} & Pick<import('../../app/effects/library.js').LibraryActions, 'keepRecord'>} act  what can be asked of a device
 */
export function createDevice(root, dispatch, act) {
  /** What is shown.
   * @type {State | null} */
  let state = null;
  /** What was refused, other than what a field shows. */
  let refused = '';

  const pill = element('span', { className: 'pill', role: 'status' });
  const settings = createSettingsDialog({ ...act, tell: (text) => dispatch(tell, text, true) });
  const gear = iconButton('settings', SETTINGS.all, 'gear', () => {
    const [present, situation] = [device(), state && situationOf(state)];
    if (present && situation) settings.open(present, situation);
  });
  const choice = picker('Port', (value) => dispatch(choosePort, value));
  choice.element.classList.add('grow');
  choice.select.id = 'port';
  choice.select.title = 'Ports of other machines are listed that StepRamp was started with: --allow-remote-port host:port';
  const familyChoice = picker('Family of the controller', (value) => {
    if (state === null) return;
    memory.keepFamily(portOf(state), value);
    dispatch(chooseFamily, portOf(state), value);
  });
  familyChoice.element.classList.add('grow');
  familyChoice.select.id = 'family';
  const find = iconButton('find-family', 'Find its family: listen to what the controller says as it starts', 'listen', () => {
    if (state) act.findFamily(portOf(state));
  });
  const onlyFamily = element('span', { className: 'grow', id: 'only-family' });
  const refresh = iconButton('refresh-ports', 'Look for ports again', 'refresh', act.refreshPorts);
  const connect = element('button', { className: 'button', id: 'connect', type: 'button', onclick: toggleConnection });
  const problem = element('div', { className: 'problem', role: 'alert' });
  const inControl = element('span');
  const takeOver = element('button', {
    className: 'button small',
    id: 'take-over',
    type: 'button',
    textContent: 'Take over',
    onclick: () => withDevice(act.takeOver),
  });
  const control = element(
    'div',
    { className: 'others', id: 'others', role: 'status' },
    element('p', { className: 'message warning' }, icon('warning'), inControl),
    takeOver,
  );
  const limitsOffer = createLimitsOffer(act);
  const live = createLive();
  const inputs = createInputs(act);
  const home = createHome(act);
  const surroundings = createSurroundings(act);
  const machine = createMachine(act, dispatch);
  const cannotList = element('ul');
  const cannot = element('details', { id: 'cannot' }, element('summary', { textContent: 'What it can’t do' }), cannotList);
  const axisChoice = picker('Axis of the device', (value) => dispatch(chooseAxis, Number(value)));
  axisChoice.select.id = 'device-axis';
  const otherDesign = element('p', { className: 'reason', id: 'other-design', role: 'status' });
  /** @type {Record<SectionName, Section>} */
  const sections = {
    push: createPushSection({
      ...act,
      push(present, mode) {
        const situation = state && situationOf(state);
        if (state && situation) act.push(present, situation.toPush, deviceAxisOf(state), mode);
      },
    }, dispatch),
    move: createMoveSection(act),
    jog: createJogSection(act.jog, { ...act, refuse: (rejections) => dispatch(refuse, rejections) }),
    trace: createTraceSection((wanted) => dispatch(setTracing, wanted), { ...act, keepTrace }),
  };
  const tabs = segmented('Work with the device', SECTIONS, (name) => {
    dispatch(chooseSection, name);
    if (!isInSight(sections[name].element)) tabs.element.scrollIntoView({ block: 'start' });
  });
  tabs.element.classList.add('fill', 'grow');
  tabs.element.id = 'device-sections';
  root.replaceChildren(
    element('div', { className: 'panel-head' }, element('h2', { textContent: 'Device' }), pill, gear),
    element(
      'div',
      { className: 'device-body' },
      element('div', { className: 'line' }, choice.element, refresh),
      element(
        'div',
        { className: 'line family-line' },
        element('label', { htmlFor: 'family', textContent: 'Family' }),
        familyChoice.element,
        find,
        onlyFamily,
        connect,
      ),
      cannot,
      problem,
      control,
      limitsOffer.element,
      live.element,
      inputs.element,
      surroundings.element,
      home.element,
      element('div', { className: 'line' }, tabs.element, axisChoice.element),
      otherDesign,
      ...SECTIONS.map(([name]) => sections[name].element),
      machine.element,
    ),
  );

  root.addEventListener('input', ({ target }) => {
    const told = state?.devices.rejections ?? [];
    const left = withoutThatOf(target, told);
    if (left !== told) dispatch(refuse, left);
  });

  const device = () => state && deviceOf(state);

  /** Keep a trace with the design that was moved, as far as anybody knows which.
   * @param {import('../../model/types.js').Trace} trace */
  function keepTrace(trace) {
    const { axis = null, design = null } = state?.devices.measured?.of ?? {};
    act.keepRecord('trace', trace, { axis, design, note: `Axis ${trace.traced_axis} of ${device()?.name ?? 'a controller'}` });
  }

  /** @param {(device: Device) => void} ask */
  function withDevice(ask) {
    const present = device();
    if (present) ask(present);
  }

  async function toggleConnection() {
    const present = device();
    if (present && present.state !== 'lost') await act.disconnect(present);
    else if (state) await act.connect(portOf(state), present?.family ?? familyOf(state));
    // While it was asked it could not be used, and lost the focus.
    if (document.activeElement === document.body) connect.focus();
  }

  /** Have a person say what kind of controller there is, where there are several: none is ever tried. One that is known
   * already, also while it is lost, stays what it is.
   * @param {State} now @param {Device | null} present */
  function showFamilies(now, present) {
    const { families } = now.devices;
    const chosen = present?.family ?? familyOf(now);
    const offered = present ? families : familiesOf(now);
    const isChoice = familiesOf(now).length > 1;
    familyChoice.element.hidden = !isChoice;
    familyChoice.select.disabled = present !== null;
    find.hidden = !isChoice || present !== null;
    const choices = offered.map(({ name, title }) => /** @type {[string, string]} */ ([name, title]));
    familyChoice.offer(choices, chosen);
    onlyFamily.hidden = isChoice;
    const family = familyShown(now, present);
    const title = family?.title ?? '';
    showCannot(family?.cannot ?? []);
    if (onlyFamily.textContent !== title) onlyFamily.textContent = title;
  }

  /** @param {string[]} sentences */
  function showCannot(sentences) {
    cannot.hidden = sentences.length === 0;
    const told = sentences.join('\n');
    if (cannotList.dataset.told === told) return;
    cannotList.dataset.told = told;
    cannotList.replaceChildren(...sentences.map((textContent) => element('li', { textContent })));
  }

  /** @param {State} now */
  function showPorts(now) {
    const choices = portChoicesOf(now);
    choice.offer(choices.length > 0 ? choices : [['', 'no port found']], portOf(now));
  }

  /** Why nothing can be asked of a device; empty: something can.
   * @param {Device | null} present @param {Situation} now */
  function hindrance(present, now) {
    if (now.link === 'unknown') return `${UNKNOWN_PAGE}.`;
    if (now.link !== 'there') return `The server is ${now.link}.`;
    if (!now.mayAct) return 'You look on: your link allows to see, to compute and to stop.';
    if (present === null || present.state === 'lost') return 'Connect a device first.';
    if (now.isOthers) return 'Another page is in control.';
    if (present.state === 'connecting') return present.proving ? RESTARTS : 'It is waiting for the board.';
    return present.state === 'writing' ? 'It is writing its ramp.' : '';
  }

  /** @param {State} now @param {Situation} situation */
  function showSections(now, situation) {
    const found = deviceOf(now);
    const present = found?.state === 'lost' ? null : found;
    const isMoving = present?.state === 'moving' || present?.state === 'stopping';
    const { designs, ids, active, toPush } = situation;
    const axis = deviceAxisOf(now);
    const place = toPush.length === designs.length && axis < designs.length ? axis : active;
    const context = {
      device: present,
      known: found,
      family: familyShown(now, found),
      axis,
      design: designs[place],
      axisId: ids[place],
      inTheWay: hindrance(found, situation),
      isVirtual: now.devices.ports.some(({ port, virtual }) => virtual && port === found?.port),
      homing: found ? (now.devices.homings[found.id] ?? null) : null,
      notAtRest: isMoving ? 'Wait until it is at rest, or stop it.' : '',
      situation,
    };
    live.show(context);
    inputs.show(context);
    surroundings.show(context);
    home.show(context);
    machine.show(context);
    machine.element.hidden = now.devices.section !== 'push';
    tabs.press(now.devices.section);
    for (const [name] of SECTIONS) {
      sections[name].element.hidden = name !== now.devices.section;
      sections[name].show(context);
    }
  }

  /** @param {State} now */
  function showAxes(now) {
    const offered = axesOffered(now);
    axisChoice.element.hidden = offered < 2;
    axisChoice.offer(
      Array.from({ length: offered }, (_, index) => [String(index), `Axis ${index}`]),
      String(deviceAxisOf(now)),
    );
    showText(otherDesign, offered < 2 ? '' : otherDesignText(now));
    otherDesign.hidden = otherDesign.textContent === '';
  }

  /** @param {State} shown @param {Situation} now */
  function showDevice(shown, now) {
    const present = deviceOf(shown);
    const isConnected = present !== null && present.state !== 'lost';
    const isMoving = present?.state === 'moving' || present?.state === 'stopping';
    const state = shownState(present);
    const isLive = now.link === 'there';
    const isNew = (isLive && now.age === null) || state === 'lost';
    pill.dataset.state = isNew ? state : 'old';
    const told = STATE_WORDS[state] ?? state;
    const word = isNew || present === null ? told : `was ${told}`;
    if (pill.textContent !== word) pill.textContent = word;
    const waiting = shown.devices.asking === 'find' ? 'Listening…' : 'Connecting…';
    showText(connect, isConnected ? 'Disconnect' : now.isBusy && !present ? waiting : 'Connect');
    connect.disabled = !isLive || now.isBusy || isMoving || state === 'restarting' || portOf(shown) === '' || (isConnected && now.isOthers) || !now.mayAct;
    find.disabled = !isLive || now.isBusy || !now.mayAct;
    connect.title = now.mayAct ? (isMoving ? 'Stop it first' : '') : 'You look on: your link allows no more';
    gear.title = present?.capabilities.includes('settings') === false ? SETTINGS.limits : SETTINGS.all;
    gear.setAttribute('aria-label', gear.title);
    gear.disabled = hindrance(present, now) !== '' || isMoving || now.isBusy;
    control.hidden = !now.isOthers || !isConnected;
    const others = present?.in_control_at ? `Another page, at ${present.in_control_at},` : 'Another page';
    showText(inControl, `${others} is in control of it.${now.link === 'there' ? ' You see all it does, and STOP works.' : ''}`);
    takeOver.disabled = !now.mayAct;
    const message = present?.message ?? '';
    const trouble = present?.state === 'lost' ? `${message || 'It is lost.'} It is connected again once it is back.` : message;
    showProblem(withSavedAt(trouble), message.includes(refused) ? '' : withSavedAt(refused));
    limitsOffer.show(isConnected && !now.isOthers ? present : null, shown.devices.softLimits[present?.port ?? ''] ?? [], now);
    showAxes(shown);
    showSections(shown, now);
  }

  /** @param {string} trouble that the device has @param {string} fault what was refused, which can be closed */
  function showProblem(trouble, fault) {
    const text = [trouble, fault].filter(Boolean).join(' ');
    if (problem.textContent === text) return;
    const line = messageLine({ text, isWarning: false });
    if (fault !== '') line.append(closeButton('Close this message', () => dispatch(refuse, [])));
    problem.replaceChildren(...(text === '' ? [] : [line]));
  }

  /** What the server refused: shown at its field, or else under the port; an empty list takes it away.
   * @param {import('../../model/types.js').Rejection[]} rejections @param {import('../../model/units.js').Units} units
   * @param {import('../../model/types.js').Design | null} design */
  function showRejections(rejections, units, design) {
    const others = SECTIONS.reduce((left, [name]) => sections[name].reject?.(left) ?? left, rejections);
    refused = pushText(others.map(inShownUnits(units, design === null ? [] : [design])));
  }

  const shows = [
    whenChanged(({ devices }) => [devices.list, devices.link], settings.follow),
    whenChanged(
      (now) => [now.devices.rejections, now.units, now.devices.rejections.length > 0 ? scaledDesignOf(now) : null],
      showRejections,
    ),
    whenever(
      (now) => [now.devices, situationOf(now)],
      (now) => {
        const situation = situationOf(now);
        showPorts(now);
        showFamilies(now, deviceOf(now));
        if (situation) showDevice(now, situation);
      },
    ),
  ];

  return {
    /** @param {State} now */
    show(now) {
      state = now;
      for (const show of shows) show(now);
    },
  };
}

/** The design that the chosen axis' lengths are converted by; null: there is none.
 * @param {State} state */
const scaledDesignOf = (state) => situationOf(state)?.scaled[deviceAxisOf(state)] ?? null;

/** Whether the first line of a section is in sight, and nothing lies over it.
 * @param {HTMLElement} section */
function isInSight(section) {
  const { left, top, width, height } = section.getBoundingClientRect();
  return section.contains(document.elementFromPoint(left + width / 2, top + Math.min(height, LINE_PX) - 1));
}

/** That what is designed is not what the chosen axis plays; '' where it is. The choice doesn't follow the tabs: looking at
 * another design must not change which motor a button moves.
 * @param {State} state */
function otherDesignText(state) {
  const [machine, played] = [machineOf(state), playedOf(state)];
  if (machine === null || played === null || played === machine.active) return '';
  const tab = (/** @type {number} */ place) => `tab ${place}, ${machine.axes[place].name || 'unnamed'}`;
  return `Axis ${deviceAxisOf(state)} plays the design of ${tab(played)}. The one in hand is ${tab(machine.active)}.`;
}

/** The family of a device, or the one chosen for what is to be connected.
 * @param {State} state @param {Device | null} present */
function familyShown(state, present) {
  const chosen = present?.family ?? familyOf(state);
  return state.devices.families.find(({ name }) => name === chosen) ?? null;
}

/** @param {string} id @param {string} label @param {'gear' | 'listen' | 'refresh'} drawing @param {() => void} onclick */
function iconButton(id, label, drawing, onclick) {
  return element(
    'button',
    { className: 'button square', id, type: 'button', 'aria-label': label, title: label, onclick },
    icon(drawing),
  );
}
