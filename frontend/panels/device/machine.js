// @ts-check
// What the machine itself is set to, and what was saved of it: to start from it, and to bring back what it had.

import { element, messageLine, picker, showText } from '../../ui/dom.js';
import { mend } from '../../app/commands/work.js';
import { createQuestion, laterText } from '../../app/effects/question.js';
import { DEVICE_LOST, NOT_FOUND } from '../../server/api.js';
import { counted, formatKnown } from '../../model/numbers.js';
import { savedAtText } from '../../model/saved_at.js';
import { hasOtherMicrosteps, isOtherScale, scaleOf, stepsPerUnit, travelAt } from '../../model/units.js';
import { enable } from './section.js';

/** @typedef {import('../../model/types.js').Backup} Backup */
/** @typedef {import('../../model/types.js').Backups} Backups */
/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').Design} Design */

const FIGURES = 7;
/** In the server's words: it says the same where it tells what is amiss. */
export const MENDING = 'Restore a backup of this device, or push again.';

/**
 * @param {{startFrom: (device: Device, axis: number, design: Design, axisId: number) => void,
 *   restoreBackup: (device: Device, name: string) => void, listBackups: (device: Device) => Promise<Backups>}} handlers
 * @param {import('../../app/state.js').Dispatch} dispatch
 */
export function createMachine(handlers, dispatch) {
  /** @type {import('./section.js').Context | null} */
  let now = null;
  /** Of which device, and after which backup, the list is. */
  let known = '';
  const scaleLine = element('p', { className: 'reason', id: 'machine-scale' });
  const useScale = button('use-scale', 'Use its scale', () => now && takeScale(now));
  const start = button('start-from', 'Start from this machine', () => {
    if (now?.device) handlers.startFrom(now.device, now.axis, now.design, now.axisId);
  });
  start.title = 'Make its speed, acceleration, steps a turn and scale those of the design';
  const choice = picker('Backup', () => {});
  choice.select.id = 'backup';
  choice.element.classList.add('grow');
  const restore = button('restore-backup', 'Restore', () => {
    if (now?.device) handlers.restoreBackup(now.device, choice.select.value);
  });
  const backups = element('div', { className: 'line', id: 'backups', hidden: true }, choice.element, restore);
  const unlisted = element('p', { className: 'reason', id: 'backups-unlisted', hidden: true });
  const failed = element(
    'div',
    { id: 'push-failed' },
    messageLine({ text: `It has not got what was sent. ${MENDING}`, isWarning: true }),
  );

  /** @param {import('./section.js').Context} context */
  function takeScale({ device, axis, design, axisId }) {
    const changes = scaleChanges(design, scaleOf(device?.axes[axis]));
    if (changes.length > 0) dispatch(mend, axisId, { changes });
  }

  /** Cancelled when another device is in view: a backup of one is none of the other. */
  const listing = createQuestion({
    ask: (/** @type {Device} */ device) => handlers.listBackups(device),
    take: ({ backups, unreadable }) => offer(backups, unreadable.join(' ')),
    // A device that is gone meanwhile has none to choose: of that others tell.
    refuse: ({ status, message }) => offer([], status === NOT_FOUND || status === DEVICE_LOST ? '' : message),
    miss: (_, error) => offer([], `Its backups can’t be listed: ${laterText(error)}`),
  });

  /** @param {Backup[]} found @param {string} why there are none, or not all, to choose from; empty: there are no more */
  function offer(found, why) {
    // The newest may have been saved when settings were half written already.
    const lacking = found.find(({ name }) => name === now?.device?.lacks_backup);
    choice.offer(found.map(({ name }) => [name, savedAtText(name)]), (lacking ?? found[0])?.name ?? '');
    backups.hidden = found.length === 0;
    showText(unlisted, why);
    unlisted.hidden = why === '';
  }

  return {
    element: element(
      'div',
      { className: 'machine', id: 'machine' },
      failed,
      backups,
      unlisted,
      scaleLine,
      element('div', { className: 'line' }, useScale, start),
    ),
    /** @param {import('./section.js').Context} context */
    show(context) {
      now = context;
      const { device, axis, design, inTheWay, notAtRest, situation } = context;
      const isThere = device !== null && device.capabilities.includes('backup');
      const canTell = device !== null && device.capabilities.includes('import');
      showText(scaleLine, scaleWords(scaleOf(device?.axes[axis]), design));
      scaleLine.hidden = useScale.hidden = scaleLine.textContent === '';
      start.hidden = !canTell;
      failed.hidden = !isThere || !hasOthers(device);
      const blocked = inTheWay !== '' || notAtRest !== '' || situation.isBusy;
      enable(restore, !blocked);
      enable(start, !blocked);
      const wanted = isThere ? `${device.id} ${device.backup} ${device.lacks_backup}` : '';
      if (wanted === known) return;
      known = wanted;
      listing.cancel();
      offer([], '');
      if (isThere) listing.want(device);
    },
  };
}

/** Whether it has something else than was sent, as it was read back or since its start.
 * @param {Device} device */
const hasOthers = ({ pushed, proof }) => pushed?.verified === false || (proof?.not_kept ?? []).length > 0;

/** That the controller's steps are others than the design's; '' where they aren't, as far as is known.
 * @param {import('../../model/units.js').Scale} scale @param {Design} design */
function scaleWords({ stepsPerMm, microsteps }, design) {
  const { axis } = design;
  if (microsteps !== null && hasOtherMicrosteps(design, microsteps)) {
    return `The controller is set to ${counted(microsteps, 'microstep')}, the design has ${axis.microsteps}.`;
  }
  const isOfDegrees = axis.travel_unit !== 'mm';
  if (stepsPerMm === null || !(isOfDegrees || isOtherScale(design, stepsPerMm))) return '';
  const own = isOfDegrees ? 'a travel in degrees' : `${scaleText(stepsPerUnit(axis))} steps/mm`;
  return `The controller is set to ${scaleText(stepsPerMm)} steps/mm, the design has ${own}.`;
}

/** @param {number} scale */
const scaleText = (scale) => formatKnown(scale, FIGURES);

/** What gives a design the scale of a controller: the microsteps that it tells, or else the travel that makes so many steps/mm.
 * @param {Design} design @param {import('../../model/units.js').Scale} scale */
function scaleChanges(design, { stepsPerMm, microsteps }) {
  if (microsteps !== null) return [{ field: 'axis.microsteps', value: microsteps }];
  if (stepsPerMm === null) return [];
  return [
    { field: 'axis.travel_unit', value: 'mm' },
    { field: 'axis.travel_per_rev', value: Number(travelAt(design, stepsPerMm).toPrecision(12)) },
  ];
}

/** @param {string} id @param {string} textContent @param {() => void} onclick */
function button(id, textContent, onclick) {
  return element('button', { className: 'button small', id, type: 'button', textContent, onclick });
}
