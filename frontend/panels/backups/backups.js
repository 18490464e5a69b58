// @ts-check
// The dialog with what was saved of controllers before they were written to, connected or not: read, kept as a file, and
// restored to one of the same family.

import { deviceOf } from '../../app/devices.js';
import { whenever } from '../../app/state.js';
import { api, Refusal, ServerGone } from '../../server/api.js';
import { savedAtText, withSavedAt } from '../../model/saved_at.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, icon, picker, showText } from '../../ui/dom.js';
import { download as saveFile } from '../../ui/download.js';

/** @typedef {import('../../model/types.js').BackupSource} BackupSource */
/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {{source: BackupSource, name: string, text: string}} Shown */

const NONE = 'Nothing was saved yet: what a controller has is saved before it is written to for the first time over a connection.';

/** @param {Pick<import('../../app/state.js').Store, 'state'>} store
 * @param {{restoreFrom: (device: Device, source: string, name: string) => void}} act
 * @param {Pick<typeof api, 'archive' | 'archived' | 'backups'>} [server] */
export function createBackups({ state }, act, server = api) {
  /** @type {BackupSource[]} */
  let sources = [];
  /** What is in view; null: nothing is yet.
   * @type {Shown | null} */
  let shown = null;
  const source = picker('Controller', () => showNames());
  source.select.id = 'backup-source';
  const name = picker('Saved at', () => read());
  name.select.id = 'backup-name';
  const note = element('p', { className: 'muted', id: 'backup-note', 'aria-live': 'polite' });
  const unreadable = element('p', { className: 'reason', id: 'backups-unreadable', hidden: true });
  const lines = element('pre', { id: 'backup-text', tabIndex: 0, role: 'region', 'aria-label': 'What the controller told' });
  const why = element('p', { className: 'reason', id: 'backup-why' });
  const restore = element('button', { className: 'button', id: 'backup-restore', type: 'button', textContent: 'Restore', onclick: write });
  const download = element(
    'button',
    { className: 'button primary', id: 'backup-download', type: 'button', onclick: save },
    icon('down'),
    'Download',
  );
  const dialog = createDialog(
    { id: 'backups-dialog', title: 'Backups of controllers' },
    element('div', { className: 'line' }, source.element, name.element),
    unreadable,
    note,
    lines,
    why,
    dialogFoot(null, restore, download),
  );

  /** @template T @param {() => Promise<T>} ask @returns {Promise<T | null>} null: the note says why */
  async function asked(ask) {
    try {
      return await ask();
    } catch (error) {
      if (!(error instanceof Refusal || error instanceof ServerGone)) throw error;
      showText(note, withSavedAt(error.message));
      return null;
    }
  }

  async function list() {
    const found = await asked(() => server.archive());
    sources = found?.sources ?? [];
    showText(unreadable, found?.unreadable.join(' ') ?? '');
    unreadable.hidden = unreadable.textContent === '';
    const first = await firstShown(deviceOf(state()));
    source.element.hidden = name.element.hidden = sources.length === 0;
    if (found && sources.length === 0) showText(note, NONE);
    const titles = new Map(state().devices.families.map((one) => [one.name, one.title]));
    source.offer(sources.map((one) => [one.name, `${titles.get(one.family) ?? one.family}, ${one.plugged_in}`]), first?.name ?? '');
    showNames();
  }

  /** The source of what was saved of the device in view; until something was, one of its family, or that with the newest.
   * @param {Device | null} device */
  async function firstShown(device) {
    if (device === null) return sources[0];
    const own = device.capabilities.includes('backup') ? await asked(() => server.backups(device.id)) : null;
    const names = new Set(own?.backups.map((one) => one.name));
    const isOfDevice = (/** @type {BackupSource} */ from) => from.backups.some((one) => names.has(one.name));
    const isOfFamily = (/** @type {BackupSource} */ from) => from.family === device.family;
    const isOfKind = (/** @type {BackupSource} */ from) => kindOf(from.family) === kindOf(device.family);
    return sources.find(isOfDevice) ?? sources.find(isOfFamily) ?? sources.find(isOfKind) ?? sources[0];
  }

  /** @param {string} family a name, also of one that there isn't any more */
  const kindOf = (family) => state().devices.families.find(({ name }) => name === family)?.kind ?? family;

  const chosen = () => sources.find((one) => one.name === source.select.value) ?? null;

  function showNames() {
    const saved = chosen()?.backups ?? [];
    const lacking = saved.find((one) => one.name === deviceOf(state())?.lacks_backup);
    name.offer(saved.map((one) => [one.name, savedAtText(one.name)]), (lacking ?? saved[0])?.name ?? '');
    return read();
  }

  async function read() {
    const [from, which] = [chosen(), name.select.value];
    showBackup(null);
    if (from === null) return;
    const found = await asked(() => server.archived(from.name, which));
    // Meanwhile another one may have been chosen.
    if (found === null || from !== chosen() || which !== name.select.value) return;
    showBackup({ source: from, name: which, text: found });
    showText(note, `${from.name}, ${found.length.toLocaleString('en')} characters`);
  }

  /** @param {Shown | null} backup */
  function showBackup(backup) {
    shown = backup;
    lines.textContent = backup?.text ?? '';
    lines.hidden = backup === null;
    showState();
  }

  /** Why the backup in view can't be restored now; empty: it can. */
  function hindrance() {
    const device = deviceOf(state());
    if (shown === null) return 'There is nothing to restore.';
    const from = shown.source;
    if (device === null || device.state === 'lost') return 'To restore it, connect the controller first.';
    if (kindOf(device.family) !== kindOf(from.family)) return 'The device in view is of another family.';
    if (!device.capabilities.includes('backup')) return 'The device in view can’t be written such things.';
    return device.state === 'ready' ? '' : 'Wait until the device is at rest.';
  }

  function showState() {
    const reason = hindrance();
    restore.disabled = reason !== '';
    download.disabled = shown === null;
    showText(why, shown === null ? '' : reason);
  }

  function write() {
    const device = deviceOf(state());
    if (shown === null || device === null || hindrance() !== '') return;
    act.restoreFrom(device, shown.source.name, shown.name);
    dialog.close();
  }

  function save() {
    if (shown === null) return;
    saveFile(new Blob([shown.text], { type: 'text/plain' }), `${shown.source.name} ${shown.name}.txt`);
  }

  const shows = whenever((/** @type {import('../../app/state.js').State} */ now) => [deviceOf(now)], () => dialog.isOpen() && showState());
  return {
    open() {
      dialog.open();
      return list();
    },
    show: (/** @type {import('../../app/state.js').State} */ now) => shows(now),
  };
}
