// @ts-check
// The stall maps of this tab, over a reload: what took a while to compute isn't computed again.

/** @typedef {import('../model/types.js').StallMap} StallMap */

const KEY = 'stepramp.stall_maps';

/** Of a tab that this one is a duplicate of there are the pictures, too, but no jobs: ended here, they would end there.
 * @param {string} tab its id @returns {Record<string, StallMap>} none where nothing readable is kept */
export function keptMaps(tab) {
  try {
    const { tab: of, maps } = JSON.parse(sessionStorage.getItem(KEY) ?? '{}');
    const kept = Object.entries(maps).filter(([, map]) => isMap(map));
    return Object.fromEntries(kept.map(([key, map]) => [key, of === tab ? map : { ...map, id: null }]));
  } catch {
    return {};
  }
}

/** Where there is no room they are computed again.
 * @param {string} tab its id @param {Record<string, StallMap>} maps */
export function keepMaps(tab, maps) {
  try {
    sessionStorage.setItem(KEY, JSON.stringify({ tab, maps }));
  } catch {
    // The page goes on without.
  }
}

/** @param {any} result @returns {result is import('../model/types.js').MapResult} */
function isResult(result) {
  const isRow = (/** @type {any} */ row) => Array.isArray(row) && row.length === result.over_values?.length;
  const rows = result?.verdicts;
  const isSpaced = ['even', 'ratios'].includes(result?.over_spacing);
  return isSpaced && Array.isArray(rows) && rows.length > 1 && rows.every(isRow) && result.accelerations_steps_per_s2?.length === rows.length;
}

/** @param {any} map @returns {map is StallMap} */
function isMap(map) {
  const isKnown = typeof map?.key === 'string' && typeof map.over === 'string' && typeof map.stage === 'string' && Array.isArray(map.rejections);
  return isKnown && Array.isArray(map.pictures) && map.pictures.every((/** @type {any} */ one) => typeof one?.key === 'string' && isResult(one.result));
}
