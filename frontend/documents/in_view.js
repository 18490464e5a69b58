// @ts-check
// Which controller and axis this tab has in view, over a reload: chosen anew by itself, another motor would move.

/** The device, its port, and the axis of it. id: null where none is connected at the port that was chosen.
 * @typedef {{id: string | null, port: string, axis: number}} InView */

const KEY = 'stepramp.in_view';

/** @returns {InView | null} null: nothing readable is kept */
export function keptInView() {
  try {
    const { id, port, axis } = JSON.parse(sessionStorage.getItem(KEY) ?? 'null');
    const isKnown = (id === null || typeof id === 'string') && typeof port === 'string' && Number.isInteger(axis) && axis >= 0;
    return isKnown ? { id, port, axis } : null;
  } catch {
    return null;
  }
}

/** @param {string | null} id @param {string | null} port null: none was chosen @param {number} axis */
export function keepInView(id, port, axis) {
  try {
    sessionStorage.setItem(KEY, JSON.stringify({ id, port, axis }));
  } catch {
    // The next page of this tab chooses as a new one does.
  }
}
