// @ts-check
// What other tabs of the browser have in hand: heard of when they write it, and looked up when this one is looked at.

import { parseRecord, RECORD, records } from '../../documents/records.js';
import { openTabs } from '../../documents/tab.js';
import { otherChanged, othersCame } from '../commands/others.js';

/** @param {Pick<import('../state.js').Store, 'dispatch'>} store @param {string} own the id of this tab */
export function watchOtherTabs({ dispatch }, own) {
  async function look() {
    const open = await openTabs();
    const others = records.all().filter(({ id, record }) => id !== own && record.isOwn);
    const list = others.map(({ id, record: { at_ms, machine } }) => ({ id, at_ms, machine, isOpen: open.has(id) }));
    dispatch(othersCame, list);
  }

  addEventListener('storage', ({ key, newValue }) => {
    const id = key?.startsWith(RECORD) ? key.slice(RECORD.length) : own;
    const record = id === own ? null : parseRecord(newValue);
    if (record?.isOwn) dispatch(otherChanged, { id, at_ms: record.at_ms, machine: record.machine, isOpen: true });
    else if (key === null || id !== own) look();
  });
  addEventListener('focus', look);
  return look();
}
