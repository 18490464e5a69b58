// @ts-check
// The device: which one, what it does, and in sections what can be done with it.

import { element, icon, messageLine, picker, segmented } from '../../dom.js';
import { memory } from '../../memory.js';
import { pushText } from '../../messages.js';
import { createJogSection } from './jog_section.js';
import { limitsText } from './limits.js';
import { createLive } from './live.js';
import { createMoveSection } from './move_section.js';
import { createPushSection } from './push_section.js';
import { createSettingsDialog } from './settings_dialog.js';
import { createTraceSection } from './trace_section.js';

/** @typedef {import('../../types.js').Device} Device */
/** @typedef {import('../../types.js').Port} Port */
/** @typedef {import('../../types.js').Situation} Situation */
/** @typedef {import('./section.js').Section} Section */
/** @typedef {'push' | 'move' | 'jog' | 'trace'} SectionName */

/** @type {[SectionName, string][]} */
const SECTIONS = [
  ['push', 'Push'],
  ['move', 'Move'],
  ['jog', 'Jog'],
  ['trace', 'Trace'],
];
/** What people read for a state; all others are called what they are.
 * @type {Record<string, string>} */
const STATE_WORDS = { none: 'not connected', connecting: 'waiting for the board' };

/**
 * @param {HTMLElement} root
 * @param {import('../../fleet.js').Fleet} fleet
 * @param {() => void} onChoice  another device or axis was chosen
 */
export function createDevice(root, fleet, onChoice) {
  /** @type {Port[]} */
  let ports = [];
  /** @type {Device[]} */
  let devices = [];
  let port = '';
  /** What controllers may be of, and what was chosen, by port.
   * @type {import('../../types.js').Family[]} */
  let families = [];
  /** @type {Map<string, string>} */
  const chosenFamilies = new Map();
  /** The device shown last, which keeps its id when it comes back at another port.
   * @type {string | null} */
  let shownId = null;
  let isPortChosen = false;
  let axis = 0;
  /** @type {SectionName} */
  let chosen = 'push';
  /** What the server refused last, other than what a field shows. */
  let refused = '';
  /** @type {Situation | null} */
  let situation = null;

  const pill = element('span', { className: 'pill', role: 'status' });
  const settings = createSettingsDialog(fleet);
  const gear = iconButton('settings', 'Device settings: how it drives its pins, and soft limits', 'gear', () => {
    const present = device();
    if (present && situation) settings.open(present, situation);
  });
  const choice = picker('Port', (value) => {
    port = value;
    isPortChosen = true;
    shownId = null;
    refused = '';
    onChoice();
  });
  choice.element.classList.add('grow');
  choice.select.id = 'port';
  const familyChoice = picker('Family of the controller', (value) => {
    chosenFamilies.set(port, value);
    memory.keepFamily(port, value);
    onChoice();
  });
  familyChoice.element.classList.add('grow');
  familyChoice.select.id = 'family';
  const onlyFamily = element('span', { className: 'grow', id: 'only-family' });
  const refresh = iconButton('refresh-ports', 'Look for ports again', 'refresh', fleet.refreshPorts);
  const connect = element('button', { className: 'button', id: 'connect', type: 'button', onclick: toggleConnection });
  const problem = element('div', { className: 'problem', role: 'alert' });
  const control = element(
    'div',
    { className: 'others', id: 'others', role: 'status' },
    messageLine({ text: 'Another page is in control of it. You see all it does, and STOP works.', isWarning: true }),
    element('button', {
      className: 'button small',
      id: 'take-over',
      type: 'button',
      textContent: 'Take over',
      onclick: () => withDevice(fleet.takeOver),
    }),
  );
  const forgotten = element('p', { className: 'message warning' }, icon('warning'), element('span'));
  const setLimits = element('button', { className: 'button small', id: 'set-limits', type: 'button', textContent: 'Set' });
  const limitsOffer = element('div', { className: 'others', id: 'limits-offer', role: 'status' }, forgotten, setLimits);
  const live = createLive();
  const axisChoice = picker('Axis of the device', (value) => {
    axis = Number(value);
    onChoice();
  });
  axisChoice.select.id = 'device-axis';
  /** @type {Record<SectionName, Section>} */
  const sections = {
    push: createPushSection({
      push: (present, mode) => situation && fleet.push(present, situation.toPush, axis, mode),
      store: fleet.store,
    }),
    move: createMoveSection(fleet.go),
    jog: createJogSection(fleet.jog, fleet),
    trace: createTraceSection(fleet.trace),
  };
  const tabs = segmented('Work with the device', SECTIONS, (name) => {
    chosen = name;
    onChoice();
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
        onlyFamily,
        connect,
      ),
      problem,
      control,
      limitsOffer,
      live.element,
      element('div', { className: 'line' }, tabs.element, axisChoice.element),
      ...SECTIONS.map(([name]) => sections[name].element),
    ),
  );

  function device() {
    return devices.find((one) => one.id === shownId) ?? devices.find((one) => one.port === port) ?? null;
  }

  /** @param {(device: Device) => void} act */
  function withDevice(act) {
    const present = device();
    if (present) act(present);
  }

  async function toggleConnection() {
    const present = device();
    if (present && present.state !== 'lost') await fleet.disconnect(present);
    else await fleet.connect(port, present?.family ?? family());
    // While it was asked it could not be used, and lost the focus.
    if (document.activeElement === document.body) connect.focus();
  }

  /** The families that a controller at the port may be of. */
  function offeredFamilies() {
    const taken = ports.find((known) => known.port === port)?.families;
    return taken ? families.filter(({ name }) => taken.includes(name)) : families;
  }

  /** The family chosen for the port, now or before; until then the first. */
  function family() {
    const offered = offeredFamilies();
    const last = chosenFamilies.get(port) ?? memory.family(port);
    return (offered.find(({ name }) => name === last) ?? offered[0])?.name ?? '';
  }

  /** Have a person say what kind of controller there is, where there are several: none is ever tried. One that is known
   * already, also while it is lost, stays what it is.
   * @param {Device | null} present */
  function showFamilies(present) {
    const chosen = present?.family ?? family();
    const offered = present ? families : offeredFamilies();
    const isChoice = offeredFamilies().length > 1;
    familyChoice.element.hidden = !isChoice;
    familyChoice.select.disabled = present !== null;
    const choices = offered.map(({ name, title }) => /** @type {[string, string]} */ ([name, title]));
    familyChoice.offer(choices, chosen);
    onlyFamily.hidden = isChoice;
    const title = families.find(({ name }) => name === chosen)?.title ?? '';
    if (onlyFamily.textContent !== title) onlyFamily.textContent = title;
  }

  function offerPorts() {
    const present = devices.find((one) => one.id === shownId);
    if (present) port = present.port;
    const gone = devices
      .filter((one) => !ports.some((known) => known.port === one.port))
      .map((one) => /** @type {[string, string]} */ ([one.port, `${one.name} (${one.port})`]));
    const choices = [...ports.map((known) => /** @type {[string, string]} */ ([known.port, known.name])), ...gone];
    // Until a person chooses, a device that is connected already comes first: a reload finds it again.
    if (!isPortChosen || !choices.some(([value]) => value === port)) port = devices[0]?.port ?? choices[0]?.[0] ?? '';
    choice.offer(choices.length > 0 ? choices : [['', 'no port found']], port);
    shownId = device()?.id ?? null;
  }

  /** Why nothing can be asked of a device; empty: something can.
   * @param {Device | null} present @param {Situation} now */
  function hindrance(present, now) {
    if (now.link !== 'there') return `The server is ${now.link}.`;
    if (present === null || present.state === 'lost') return 'Connect a device first.';
    if (now.isOthers) return 'Another page is in control.';
    if (present.state === 'connecting') return 'It is waiting for the board.';
    return present.state === 'writing' ? 'It is writing its ramp.' : '';
  }

  function showSections() {
    if (situation === null) return;
    const found = device();
    const present = found?.state === 'lost' ? null : found;
    const isMoving = present?.state === 'moving' || present?.state === 'stopping';
    const { designs, active, toPush } = situation;
    const context = {
      device: present,
      known: found,
      axis,
      design: (toPush.length < designs.length ? null : designs[axis]) ?? designs[active],
      inTheWay: hindrance(found, situation),
      notAtRest: isMoving ? 'Wait until it is at rest, or stop it.' : '',
      situation,
    };
    live.show(context);
    tabs.press(chosen);
    for (const [name] of SECTIONS) {
      sections[name].element.hidden = name !== chosen;
      sections[name].show(context);
    }
  }

  /** @param {Device | null} present */
  function showAxes(present) {
    const count = present?.axes.length ?? 0;
    // One more than there are: the next axis may be given a ramp.
    const isGiving = chosen === 'push' && situation?.toPush.length === 1 && present?.ramp && count > 0 && count < (present.most_axes ?? 0);
    const offered = isGiving ? count + 1 : count;
    if (axis >= Math.max(1, offered)) axis = 0;
    axisChoice.element.hidden = offered < 2;
    axisChoice.offer(
      Array.from({ length: Math.max(1, offered) }, (_, index) => [String(index), `Axis ${index}`]),
      String(axis),
    );
  }

  /** @param {Situation} now */
  function show(now) {
    situation = now;
    const present = device();
    const isConnected = present !== null && present.state !== 'lost';
    const isMoving = present?.state === 'moving' || present?.state === 'stopping';
    const state = present?.state ?? 'none';
    const isLive = now.link === 'there';
    pill.dataset.state = isLive ? state : 'old';
    const told = STATE_WORDS[state] ?? state;
    const word = isLive || present === null ? told : `was ${told}`;
    if (pill.textContent !== word) pill.textContent = word;
    connect.textContent = isConnected ? 'Disconnect' : now.isBusy && !present ? 'Connecting…' : 'Connect';
    connect.disabled = !isLive || now.isBusy || isMoving || port === '' || (isConnected && now.isOthers);
    connect.title = isMoving ? 'Stop it first' : '';
    gear.disabled = hindrance(present, now) !== '' || isMoving || now.isBusy;
    control.hidden = !now.isOthers || !isConnected;
    const message = present?.message ?? '';
    const trouble = present?.state === 'lost' ? `${message || 'It is lost.'} It is connected again once it is back.` : message;
    showProblem([trouble, refused === message ? '' : refused].filter(Boolean).join(' '));
    showFamilies(present);
    showForgottenLimits(isConnected && !now.isOthers ? present : null, now);
    showAxes(isConnected ? present : null);
    showSections();
  }

  /** Offer to bring back into force the soft limits that are remembered of a port, of each axis that has others or none.
   * @param {Device | null} present @param {Situation} now */
  function showForgottenLimits(present, { designs, active, units, isBusy }) {
    const axes = present?.axes ?? [];
    const kept = (present ? memory.softLimits(present.port) : []).filter(({ axis, lowest_steps, highest_steps }) => {
      const one = axes[axis];
      return one && (one.lowest_steps !== lowest_steps || one.highest_steps !== highest_steps);
    });
    limitsOffer.hidden = kept.length === 0;
    if (present === null || kept.length === 0) return;
    const spans = kept.map((one) => {
      const span = limitsText(units, designs[one.axis] ?? designs[active], one);
      return axes.length === 1 ? span : `axis ${one.axis} ${span}`;
    });
    const text = `Soft limits of this port, ${spans.join(', ')}, are not in force.`;
    const shown = /** @type {HTMLElement} */ (forgotten.lastElementChild);
    if (shown.textContent !== text) shown.textContent = text;
    setLimits.disabled = isBusy;
    setLimits.onclick = () => fleet.limitAgain(present, kept);
  }

  /** @param {string} text */
  function showProblem(text) {
    if (problem.textContent !== text)
      problem.replaceChildren(...(text === '' ? [] : [messageLine({ text, isWarning: false })]));
  }

  return {
    device,
    /** The axis that is worked with. */
    axis: () => axis,
    show,
    /** Take what the server refused: shown at its field, or else under the port; an empty list takes it away.
     * @param {import('../../types.js').Rejection[]} rejections */
    showRejections(rejections) {
      const others = SECTIONS.reduce((left, [name]) => sections[name].reject?.(left) ?? left, rejections);
      refused = pushText(others);
      if (situation) show(situation);
    },
    /** @param {import('../../types.js').Ports} known */
    showPorts(known) {
      ({ ports, families } = known);
      offerPorts();
      showFamilies(device());
    },
    /** @param {Device[]} known */
    showDevices(known) {
      devices = known;
      offerPorts();
    },
  };
}

/** @param {string} id @param {string} label @param {'gear' | 'refresh'} drawing @param {() => void} onclick */
function iconButton(id, label, drawing, onclick) {
  return element(
    'button',
    { className: 'button square', id, type: 'button', 'aria-label': label, title: label, onclick },
    icon(drawing),
  );
}
