// @ts-check
// The stall maps of this tab, over a reload: what took a while to compute isn't computed again.

/** @typedef {import('../model/types.js').StallMap} StallMap */

const KEY = 'stepramp.stall_maps';

/** @returns {Record<string, StallMap>} none where nothing readable is kept */
export function keptMaps() {
  try {
    const kept = Object.entries(JSON.parse(sessionStorage.getItem(KEY) ?? '{}') ?? {});
    return Object.fromEntries(kept.filter(([, map]) => isMap(map)));
  } catch {
    return {};
  }
}

/** Where there is no room they are computed again.
 * @param {Record<string, StallMap>} maps */
export function keepMaps(maps) {
  try {
    sessionStorage.setItem(KEY, JSON.stringify(maps));
  } catch {
    // The page goes on without.
  }
}

/** @param {any} result @returns {result is import('../model/types.js').MapResult} */
function isResult(result) {
  const isRow = (/** @type {any} */ row) => Array.isArray(row) && row.length === result.over_values?.length;
  const rows = result?.verdicts;
  return Array.isArray(rows) && rows.length > 1 && rows.every(isRow) && result.accelerations_steps_per_s2?.length === rows.length;
}

/** @param {any} map @returns {map is StallMap} */
function isMap(map) {
  const isKnown = typeof map?.key === 'string' && typeof map.over === 'string' && typeof map.stage === 'string' && Array.isArray(map.rejections);
  return isKnown && Array.isArray(map.pictures) && map.pictures.every((/** @type {any} */ one) => typeof one?.key === 'string' && isResult(one.result));
}
