// @ts-check
// The device: which one, what it does, pushing the ramp to it and moving with it.

import { element, icon, messageLine, picker, segmented, showMessage } from '../../dom.js';
import { formatEntry, formatFixed, parseEntry } from '../../numbers.js';
import { createPushReport } from './push_report.js';

/** @typedef {import('../../types.js').Device} Device */
/** @typedef {import('../../types.js').Port} Port */
/** @typedef {{by_steps: unknown} | {to_steps: unknown}} Move */

/** @typedef {import('../../types.js').Situation} Situation */

/**
 * @param {HTMLElement} root
 * @param {object} handlers
 * @param {() => void} handlers.onRefresh
 * @param {() => void} handlers.onPort
 * @param {(port: string) => void} handlers.onConnect
 * @param {(device: Device) => void} handlers.onDisconnect
 * @param {(device: Device) => void} handlers.onPush
 * @param {(device: Device, move: Move) => void} handlers.onMove
 */
export function createDevice(root, handlers) {
  /** @type {Port[]} */
  let ports = [];
  /** @type {Device[]} */
  let devices = [];
  let port = '';
  let isPortChosen = false;
  /** What the server refused last, other than a move. */
  let refused = '';
  /** @type {'by' | 'to'} */
  let kind = 'by';

  const pill = element('span', { className: 'pill' });
  const choice = picker('Port', (value) => {
    port = value;
    isPortChosen = true;
    refused = '';
    handlers.onPort();
  });
  choice.element.classList.add('grow');
  choice.select.id = 'port';
  const refresh = element(
    'button',
    {
      className: 'button square',
      type: 'button',
      'aria-label': 'Look for ports again',
      title: 'Look for ports again',
      onclick: handlers.onRefresh,
    },
    icon('refresh'),
  );
  const connect = element('button', { className: 'button', id: 'connect', type: 'button', onclick: toggleConnection });
  const problem = element('div', { className: 'problem', role: 'alert' });
  const report = createPushReport();
  const push = element(
    'button',
    {
      className: 'button primary grow',
      id: 'push',
      type: 'button',
      'aria-describedby': 'push-reason',
      onclick: () => withDevice(handlers.onPush),
    },
    icon('send'),
    element('span'),
  );
  const pushReason = element('p', { className: 'reason', id: 'push-reason' });
  const kinds = segmented(
    'Kind of move',
    [
      ['by', 'By'],
      ['to', 'To'],
    ],
    (value) => {
      kind = value;
      kinds.press(kind);
    },
  );
  kinds.press(kind);
  const distance = element('input', {
    id: 'move-steps',
    inputMode: 'numeric',
    autocomplete: 'off',
    spellcheck: false,
    value: '400',
    'aria-label': 'Steps to move, or position to move to',
    onblur: () => {
      distance.value = formatEntry(parseEntry(distance.value));
    },
  });
  const move = element('button', {
    className: 'button',
    id: 'move',
    type: 'submit',
    'aria-describedby': 'move-reason',
    textContent: 'Move',
  });
  const moveReason = element('p', { className: 'reason', id: 'move-reason' });
  const moveProblem = element('div', { className: 'problem' });
  const position = readout('Position', 'steps', 'position');
  const speed = readout('Speed', 'steps/s', 'speed');
  const form = element(
    'form',
    { className: 'line', onsubmit: submitted },
    kinds.element,
    element(
      'span',
      { className: 'field grow' },
      distance,
      element('span', { className: 'unit', textContent: 'steps' }),
    ),
    move,
  );
  root.replaceChildren(
    element('div', { className: 'panel-head' }, element('h2', { textContent: 'Device' }), pill),
    element(
      'div',
      { className: 'device-body' },
      element('div', { className: 'line' }, choice.element, refresh, connect),
      problem,
      element('div', { className: 'live' }, position.element, speed.element),
      form,
      moveProblem,
      moveReason,
      element('div', { className: 'separator' }),
      element('div', { className: 'line' }, push),
      pushReason,
      report.element,
    ),
  );

  function device() {
    return devices.find((one) => one.port === port) ?? null;
  }

  /** @param {(device: Device) => void} act */
  function withDevice(act) {
    const present = device();
    if (present) act(present);
  }

  function toggleConnection() {
    const present = device();
    if (present && present.state !== 'lost') handlers.onDisconnect(present);
    else handlers.onConnect(port);
  }

  /** @param {SubmitEvent} event */
  function submitted(event) {
    event.preventDefault();
    const steps = parseEntry(distance.value);
    withDevice((present) => handlers.onMove(present, kind === 'by' ? { by_steps: steps } : { to_steps: steps }));
  }

  function offerPorts() {
    const gone = devices
      .filter((one) => !ports.some((known) => known.port === one.port))
      .map((one) => /** @type {[string, string]} */ ([one.port, `${one.name} (${one.port})`]));
    const choices = [...ports.map((known) => /** @type {[string, string]} */ ([known.port, known.name])), ...gone];
    // Until a person chooses, a device that is connected already comes first: a reload finds it again.
    if (!isPortChosen || !choices.some(([value]) => value === port)) port = devices[0]?.port ?? choices[0]?.[0] ?? '';
    choice.offer(choices.length > 0 ? choices : [['', 'no port found']], port);
  }

  /** @param {Situation} situation */
  function show(situation) {
    const present = device();
    const isConnected = present !== null && present.state !== 'lost';
    const isMoving = present?.state === 'moving' || present?.state === 'stopping';
    pill.dataset.state = present?.state ?? 'none';
    pill.textContent = present?.state ?? 'not connected';
    connect.textContent = isConnected ? 'Disconnect' : situation.isBusy && !present ? 'Connecting…' : 'Connect';
    connect.disabled = !situation.isServerThere || situation.isBusy || isMoving || port === '';
    connect.title = isMoving ? 'Stop it first' : '';
    showProblem(present?.state === 'lost' ? (present.message ?? 'The device is lost.') : refused);
    const noDevice = !situation.isServerThere ? 'The server is gone.' : !isConnected ? 'Connect a device first.' : '';
    const inTheWay =
      noDevice ||
      (isMoving
        ? 'Wait until it is at rest, or stop it.'
        : present?.state === 'writing'
          ? 'It is writing its ramp.'
          : present?.state === 'connecting'
            ? 'It is connecting.'
            : '');
    able(push, pushReason, inTheWay || (!situation.isDesignValid ? 'Correct the design first.' : ''), situation.isBusy);
    able(move, moveReason, inTheWay || (!present?.ramp ? 'Push a ramp first.' : ''), situation.isBusy);
    if (pushReason.textContent === moveReason.textContent) pushReason.textContent = '';
    pushReason.hidden = pushReason.textContent === '';
    moveReason.hidden = moveReason.textContent === '';
    const label = /** @type {HTMLElement} */ (push.lastElementChild);
    label.textContent = situation.isPushing
      ? 'Pushing…'
      : situation.isChanged && present?.ramp
        ? 'Push the changes'
        : 'Push the ramp';
    report.show(isConnected ? present : null, situation);
    showLive(isConnected ? present : null);
  }

  /** @param {Device | null} present */
  function showLive(present) {
    position.show(
      present ? formatFixed(present.position_steps) : '–',
      present && present.target_steps !== present.position_steps ? `to ${formatFixed(present.target_steps)}` : '',
    );
    speed.show(present ? formatFixed(Math.abs(present.speed_steps_per_s)) : '–', '');
  }

  /** @param {string} text */
  function showProblem(text) {
    if (problem.textContent !== text)
      problem.replaceChildren(...(text === '' ? [] : [messageLine({ text, isWarning: false })]));
  }

  return {
    device,
    show,
    /** Take what the server refused, a move at its field and all else under the port; an empty list takes it away.
     * @param {import('../../types.js').Rejection[]} rejections */
    showRejections(rejections) {
      const ofMove = rejections.find(({ field }) => field === 'by_steps' || field === 'to_steps');
      showMessage(
        distance,
        moveProblem,
        ofMove && {
          text: ofMove.message.replace(/^(by|to)_steps/, kind === 'by' ? 'Steps' : 'Position'),
          isWarning: false,
        },
      );
      refused = rejections
        .filter((one) => one !== ofMove)
        .map(({ message }) => message)
        .join(' ');
    },
    /** @param {Port[]} known */
    showPorts(known) {
      ports = known;
      offerPorts();
    },
    /** @param {Device[]} known */
    showDevices(known) {
      devices = known;
      offerPorts();
    },
  };
}

/**
 * @param {HTMLButtonElement} button @param {HTMLElement} reason where it is told why not
 * @param {string} why empty: it can be used @param {boolean} isBusy
 */
function able(button, reason, why, isBusy) {
  button.disabled = why !== '' || isBusy;
  reason.textContent = why;
}

/** @param {string} label @param {string} unit @param {string} name */
function readout(label, unit, name) {
  const value = element('b', { id: `live-${name}` });
  const more = element('small', { className: 'target' });
  return {
    element: element('div', {}, element('span', {}, label, more), value, element('small', { textContent: ` ${unit}` })),
    /** @param {string} text @param {string} note */
    show(text, note) {
      value.textContent = text;
      more.textContent = note;
    },
  };
}
