// @ts-check
// What was pushed, when, by whom, with what came of it: of one design, or to one device.

import { pushedText, pushOutcome, whenText } from '../../model/library.js';
import { element, icon, picker, showText } from '../../ui/dom.js';
import { button, section } from './rows.js';

/** @typedef {import('../../model/library.js').PushTold} PushTold */
/** @typedef {import('../../model/library.js').SeenDevice} SeenDevice */

const NONE = 'Nothing was pushed yet. What the simulated controller is sent is not kept.';

/** @param {PushTold} push @param {{openPush: (push: PushTold) => void, openBackups: () => void}} act @param {boolean} withDevice */
export function pushRow(push, { openPush, openBackups }, withDevice) {
  const { text, hasFailed } = pushOutcome(push);
  const who = [withDevice ? push.device : null, push.client === null ? null : `by ${push.client}`, whenText(push.pushed_at)].filter((one) => one !== null);
  return element(
    'li',
    {},
    element(
      'span',
      { className: 'library-row-text' },
      element('b', { textContent: pushedText(push.axes) }),
      element('span', { className: `library-outcome ${hasFailed ? 'failed' : 'verified'}` }, icon(hasFailed ? 'error' : 'ok'), element('span', { textContent: text })),
      element('span', { className: 'muted', textContent: who.join(' · ') }),
    ),
    element(
      'span',
      { className: 'library-acts' },
      push.backup !== null && button('Backups', openBackups, { title: 'What the controller had before was saved: look at the backups of controllers' }),
      button('Open', () => openPush(push), { title: 'Open what was pushed, an axis for each design' }),
    ),
  );
}

/** @param {{devices: () => Promise<SeenDevice[] | null>, pushes: (device: string) => Promise<{count: number, pushes: PushTold[]} | null>,
 *   present: () => import('../../model/types.js').Device | null} & Parameters<typeof pushRow>[1]} act  present: the device in view */
export function createPushes(act) {
  let asked = 0;
  const choice = picker('Device', () => list());
  choice.select.id = 'library-device';
  const note = element('p', { className: 'muted', id: 'library-pushes-note', role: 'status' });
  const rows = element('div', { id: 'library-pushes' });

  async function list() {
    asked += 1;
    const mine = asked;
    const found = await act.pushes(choice.select.value);
    if (found === null || mine !== asked) return;
    const { count, pushes } = found;
    showText(note, pushes.length < count ? `The last ${pushes.length} of ${count.toLocaleString('en')} pushes.` : '');
    note.hidden = note.textContent === '';
    rows.replaceChildren(section('Pushes', pushes.map((push) => pushRow(push, act, choice.select.value === '')), NONE, 'h3'));
  }

  return {
    element: element('div', { className: 'library-all-pushes', id: 'library-all-pushes' }, element('div', { className: 'library-line' }, choice.element), note, rows),
    /** Those to the device in view first. */
    async open() {
      const devices = await act.devices();
      if (devices === null) return;
      const now = act.present();
      const own = devices.find(({ family, port }) => now !== null && family === now.family && port === now.port);
      choice.offer([['', 'To all devices'], ...devices.map(({ id, name, port }) => /** @type {[string, string]} */ ([id, `To ${name}, ${port}`]))], own?.id ?? '');
      await list();
    },
  };
}
