// @ts-check
// What the last push asked for, sent and read back, item by item.

import { closeButton, element, icon, messageLine } from '../../ui/dom.js';
import { formatFigures } from '../../model/numbers.js';
import { pushedWords, warningsOf } from './push_words.js';
import { figureCell, figureHead, figuresOf, sizeText, tableHead, unseen } from './figures.js';

/** @typedef {import('../../model/types.js').Device} Device */

const STAGES = ['requested', 'sent', 'read back', 'verified'];

/** Whether the device has another ramp than the one that was pushed last: it was rolled back, or restored.
 * @param {Device} device @param {import('../../model/types.js').Preview | null} preview  also tells what is there now */
export function hasAnotherRamp({ pushed, ramp }, preview) {
  const items = pushed?.items ?? [];
  const sent = items.find(({ unit }) => unit === 'CRC-16')?.sent;
  if (sent !== undefined) return (ramp?.crc ?? null) !== sent;
  const present = new Map(preview?.items.map(({ axis, own }) => [`${axis} ${own?.term}`, own?.on_device]));
  return items.some(({ axis, own }) => {
    const now = own && present.get(`${axis} ${own.term}`);
    return typeof now === 'number' && now !== own?.on_device;
  });
}

export function createPushReport() {
  const stages = STAGES.map((name) => element('div', { textContent: name }));
  const bar = element('div', { className: 'stages', 'aria-hidden': 'true' }, ...stages);
  const details = element('div', { className: 'push-details' });
  let known = '';
  /** The push whose report was closed.
   * @type {string | null} */
  let closed = null;
  const close = closeButton('Close the report', () => {
    closed = shown;
    details.hidden = bar.hidden = true;
  });
  /** The push that is reported. */
  let shown = '';
  /** By device, the designs that its report is of: they are known no more once it has another ramp, but their scale is that of the
   * figures as long as it is shown.
   * @type {Map<string, {push: string, designs: import('../../model/types.js').Design[]}>} */
  const reported = new Map();

  /** @param {Device} device @param {import('../../model/types.js').Situation} situation */
  function reportedDesigns({ id }, { lastPushed, toPush }) {
    const before = reported.get(id);
    const designs = lastPushed ?? (before?.push === shown ? before.designs : toPush);
    reported.set(id, { push: shown, designs });
    return designs;
  }

  /** @param {import('../../model/types.js').Push} pushed @param {string[]} warnings @param {boolean} isChanged
   * @param {import('../../model/types.js').Design[] | null} lastPushed  null: another page has pushed it
   * @param {boolean} isReplaced @param {import('../../model/units.js').Units} units
   * @param {import('../../model/types.js').Design[]} designs */
  function showDetails(pushed, warnings, isChanged, lastPushed, isReplaced, units, designs) {
    const what = [
      ...(lastPushed ? [pushedWords(lastPushed)] : []),
      ...(pushed.sequence === null ? [] : [`ramp ${pushed.sequence}`]),
    ].join(' · ');
    const rows = pushed.items.map((item) => reportRow(item, figuresOf(item, units, designs)));
    details.replaceChildren(
      element(
        'div',
        { className: 'push-head' },
        element('b', {
          className: pushed.verified ? 'verified' : 'differs',
          textContent: pushed.verified ? 'Read back as sent' : 'Not as sent',
        }),
        element('span', { textContent: sizeText(pushed) }),
        close,
      ),
      ...(isReplaced ? [element('p', { className: 'reason pushed-what', textContent: 'The device has another ramp since this push.' })] : []),
      ...(what === '' ? [] : [element('p', { className: 'reason pushed-what', textContent: what })]),
      element(
        'div',
        { className: 'push-rows', tabIndex: 0, role: 'region', 'aria-label': 'What was pushed' },
        element(
          'table',
          {},
          tableHead([unseen('item'), 'requested', 'sent', 'read back', unseen('the same')]),
          element('tbody', {}, ...rows),
        ),
      ),
      ...(pushed.largest_deviation_us !== null && pushed.largest_deviation_us > 0
        ? [
            element('p', {
              className: 'reason',
              textContent: `Largest deviation from the design: ${formatFigures(pushed.largest_deviation_us, 3)} µs`,
            }),
          ]
        : []),
      ...warnings.map((text) => messageLine({ text, isWarning: true })),
      ...(isChanged ? [element('p', { className: 'reason', textContent: 'The design has changed since this push.' })] : []),
    );
  }

  return {
    element: element('div', { className: 'push-report', id: 'push-report' }, bar, details),
    /** @param {Device | null} device @param {import('../../model/types.js').Situation} situation */
    show(device, situation) {
      const { isPushing, isChanged, preview, lastPushed, units } = situation;
      const pushed = device?.pushed ?? null;
      const reached = isPushing ? 1 : pushed === null ? 0 : pushed.verified ? STAGES.length : STAGES.length - 1;
      stages.forEach((stage, index) => {
        stage.className = index < reached ? 'done' : isPushing && index < STAGES.length - 1 ? 'doing' : '';
      });
      shown = JSON.stringify(pushed);
      if (isPushing) closed = null;
      bar.hidden = shown === closed;
      details.hidden = isPushing || pushed === null || shown === closed;
      // What is said of the next push is not said of the last one again.
      const designs = device === null ? [] : reportedDesigns(device, situation);
      const told = pushed ? warningsOf(pushed, units, designs) : [];
      const warnings = told.filter((_, place) => !preview?.warnings.includes(pushed?.warnings[place] ?? ''));
      const isReplaced = device !== null && hasAnotherRamp(device, preview);
      const state = JSON.stringify([pushed, warnings, isChanged, lastPushed && pushedWords(lastPushed), isReplaced, units, designs.map(({ axis }) => axis)]);
      if (state === known) return;
      known = state;
      if (pushed) showDetails(pushed, warnings, isChanged, lastPushed, isReplaced, units, designs);
    },
  };
}

/** @param {import('../../model/types.js').PushItem} item @param {ReturnType<typeof figuresOf>} figures */
function reportRow(item, { unit, write }) {
  const isSame = item.sent === item.read_back;
  return element(
    'tr',
    {},
    figureHead(item.name, unit, item.own),
    figureCell(write(item.requested)),
    figureCell(write(item.sent), item.own?.sent),
    figureCell(item.read_back === null ? 'unreadable' : write(item.read_back), item.own?.on_device),
    element(
      'td',
      { className: isSame ? 'same' : 'differs' },
      icon(isSame ? 'ok' : 'error'),
      element('span', { className: 'unseen', textContent: isSame ? 'as sent' : 'not as sent' }),
    ),
  );
}
