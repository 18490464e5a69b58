// @ts-check
// The map as a drawing: each verdict a colour and a pattern, and the design a point on it that pointer and keys move.

import { formatFigures } from '../../model/numbers.js';
import { axesOf, MAP_VERDICTS, overOf, shareOf, stretchesOf, UNKNOWN, valueAtShare, verdictAt } from '../../model/stall_map.js';
import { shownValue, unitWord } from '../../model/units.js';
import { chartText } from '../../ui/chart.js';
import { element, svgElement } from '../../ui/dom.js';
import { createDragging } from '../../ui/dragging.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').MapResult} MapResult */
/** @typedef {import('../../model/types.js').Over} Over */
/** @typedef {import('../../model/stall_map.js').MapAxis} MapAxis */
/** @typedef {import('../../model/stall_map.js').MapPlace} MapPlace */
/** @typedef {import('../../model/units.js').Units} Units */
/** What is drawn; isOld: of another design.
 * @typedef {{map: MapResult, isOld: boolean, place: MapPlace, units: Units, design: Design, over: Over}} Scene */

const [WIDTH, HEIGHT] = [520, 336];
const [LEFT, RIGHT, TOP, BOTTOM] = [64, 14, 24, 42];
const [ACROSS, DOWN] = [WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM];
const FIGURES = 3;
/** An axis of more than so many times its least has a number at each power of ten only. */
const MOST_TICKED = 2000;
/** Of the way along an axis, what an arrow key goes; Shift: farther, Alt: less far. */
const STRIDE = 1 / 64;
const STRIDES = { usual: STRIDE, coarse: 8 * STRIDE, fine: STRIDE / 8 };
/** @type {Record<string, [number, number]>} */
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };
const NAMES = ['safe', 'marginal', 'stalls', 'impossible'];

/** @param {{onMove: (place: MapPlace, isStep: boolean) => void, onEnd: () => void}} handlers */
export function createMapChart({ onMove, onEnd }) {
  /** @type {Scene | null} */
  let scene = null;
  /** What the cells show.
   * @type {unknown} */
  let drawn = null;
  const drawing = svgElement('svg', { class: 'stall-map', viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'group', 'aria-label': 'Stall map' });
  const [cells, scale] = [svgElement('g', { role: 'img' }), svgElement('g', { 'aria-hidden': 'true' })];
  const point = svgElement('g', { class: 'map-point', tabindex: 0, role: 'slider', 'aria-label': 'The design', 'aria-valuemin': 0 });
  point.append(...['hit', 'ring', 'dot'].map((name) => svgElement('circle', { class: name })));
  const label = svgElement('text', { class: 'map-here', x: LEFT, y: TOP - 9, 'aria-hidden': 'true' });
  drawing.append(patterns(), svgElement('rect', { class: 'ground', x: LEFT, y: TOP, width: ACROSS, height: DOWN }), cells, scale, point, label);
  const box = element('div', { className: 'map-box', hidden: true }, drawing);
  /** Where the point was when it was taken up.
   * @type {MapPlace | null} */
  let before = null;
  const dragging = createDragging(drawing, {
    width: () => WIDTH,
    onMove: ({ x, y }, isHeldToOne) => move(x, y, isHeldToOne),
    onEnd(how) {
      if (how === 'restored' && before) onMove(before, false);
      before = null;
      onEnd();
    },
  });
  point.addEventListener('pointerdown', (event) => {
    if (scene === null || event.button !== 0) return;
    event.preventDefault();
    before = scene.place;
    dragging.begin(event, point, pixelOf(scene, scene.place));
  });
  // A finger takes the point up; elsewhere it scrolls. Within a drawing touch-action can't say so everywhere.
  point.addEventListener('touchstart', (event) => event.preventDefault(), { passive: false });
  point.addEventListener('keydown', stepped);
  for (const happens of /** @type {const} */ (['pointermove', 'pointerdown'])) drawing.addEventListener(happens, (event) => readHere(dragging.placeOf(event)));
  // A finger that was lifted has read, too.
  drawing.addEventListener('pointerleave', ({ pointerType }) => pointerType === 'mouse' && nameUpwards());

  /** @param {number} x @param {number} y @param {boolean} isHeldToOne */
  function move(x, y, isHeldToOne) {
    if (scene === null || before === null) return;
    const from = pixelOf(scene, before);
    const isAcross = Math.abs(x - from.x) >= Math.abs(y - from.y);
    const wanted = placeAt(scene, isHeldToOne && !isAcross ? from.x : x, isHeldToOne && isAcross ? from.y : y);
    onMove(wanted, false);
  }

  /** @param {KeyboardEvent} event */
  function stepped(event) {
    const { key, shiftKey, altKey } = event;
    if (scene === null || !(key in KEYS) || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    event.stopPropagation();
    const by = STRIDES[altKey ? 'fine' : shiftKey ? 'coarse' : 'usual'];
    const { map, place } = scene;
    const [across, up] = KEYS[key].map((sign) => sign * by);
    const axes = axesOf(map);
    const along = (/** @type {MapAxis} */ axis, /** @type {number} */ value, /** @type {number} */ share) =>
      share === 0 ? value : valueAtShare(axis, within(shareOf(axis, value) + share));
    onMove({ acceleration: along(axes.acceleration, place.acceleration, up), value: along(axes.over, place.value, across) }, true);
  }

  /** What the map says where the pointer is.
   * @param {import('../../ui/dragging.js').Place} at */
  function readHere({ x, y }) {
    if (scene === null) return;
    const isInside = x >= LEFT && x <= LEFT + ACROSS && y >= TOP && y <= TOP + DOWN;
    const place = placeAt(scene, x, y);
    const verdict = isInside ? verdictAt(scene.map, place) : null;
    const known = verdict === null ? '' : verdict === UNKNOWN ? 'not known yet' : MAP_VERDICTS[verdict];
    const of = scene.isOld ? ', of an earlier design' : '';
    if (known === '') return nameUpwards();
    label.textContent = `${known} at ${placeText(place, scene.over, scene.units, scene.design)}${of}`;
    label.classList.add('read');
  }

  /** While nothing is read, its place tells what goes upwards. */
  function nameUpwards() {
    label.textContent = scene && `acceleration, ${unitWord(scene.units, scene.design, 'acceleration')}`;
    label.classList.remove('read');
  }

  /** @param {Scene} now */
  function drawScale({ map, units, design, over }) {
    const { label: name } = overOf(over);
    const axes = axesOf(map);
    const toX = (/** @type {number} */ value) => LEFT + shareOf(axes.over, value) * ACROSS;
    const toY = (/** @type {number} */ value) => TOP + (1 - shareOf(axes.acceleration, value)) * DOWN;
    const ofValue = overUnit(over, units, design);
    const ofAcceleration = shownValue(units, design, 'acceleration', 1);
    scale.replaceChildren(
      ...ticksOf(axes.over, ofValue.factor).map(({ at, text }) => chartText(text, toX(at), HEIGHT - BOTTOM + 17, 'middle')),
      ...ticksOf(axes.acceleration, ofAcceleration).map(({ at, text }) => chartText(text, LEFT - 6, toY(at) + 3, 'end')),
      chartText(`${name.toLowerCase()}, ${ofValue.word}`, LEFT + ACROSS, HEIGHT - 4, 'end'),
    );
  }

  /** @param {Scene} now */
  function drawPoint(now) {
    const { map, isOld, place, units, design, over } = now;
    const isKnown = Number.isFinite(place.acceleration) && Number.isFinite(place.value);
    point.toggleAttribute('hidden', !isKnown);
    if (!isKnown) return;
    const { x, y } = pixelOf(now, place);
    point.setAttribute('transform', `translate(${x.toFixed(2)} ${y.toFixed(2)})`);
    const axes = axesOf(map);
    const shares = [shareOf(axes.acceleration, place.acceleration), shareOf(axes.over, place.value)];
    const isOutside = shares.some((share) => share < 0 || share > 1);
    point.classList.toggle('outside', isOutside);
    const verdict = verdictAt(map, place);
    const said = isOld ? 'the map is of an earlier design' : verdict === null || verdict === UNKNOWN ? 'not on the map' : MAP_VERDICTS[verdict].toLowerCase();
    const { accelerations_steps_per_s2: accelerations } = map;
    point.setAttribute('aria-valuemax', String(accelerations[accelerations.length - 1]));
    point.setAttribute('aria-valuenow', String(Math.min(place.acceleration, accelerations[accelerations.length - 1])));
    point.setAttribute('aria-valuetext', `${placeText(place, over, units, design)}: ${said}`);
  }

  return {
    element: box,
    /** @param {MapResult | null} map @param {boolean} isOld of another design @param {MapPlace} place of the design
     * @param {Units} units @param {Design} design @param {Over} over */
    show(map, isOld, place, units, design, over) {
      box.hidden = map === null;
      scene = map && { map, isOld, place, units, design, over };
      if (scene === null || map === null) return;
      drawing.classList.toggle('old', isOld);
      if (drawn !== map) {
        drawn = map;
        cells.replaceChildren(...stretchesOf(map.verdicts).flatMap((stretch) => cell(map, stretch)));
        cells.setAttribute('aria-label', `The map, ${overOf(over).label.toLowerCase()} across, acceleration up.`);
      }
      drawScale(scene);
      drawPoint(scene);
      if (!label.classList.contains('read')) nameUpwards();
    },
  };
}

/** A stretch of equal verdicts, half way to its neighbours.
 * @param {MapResult} map @param {ReturnType<typeof stretchesOf>[number]} stretch */
function cell({ verdicts }, { verdict, row, from, to }) {
  if (verdict === UNKNOWN) return [];
  const [wide, high] = [ACROSS / (verdicts[0].length - 1), DOWN / (verdicts.length - 1)];
  const edge = (/** @type {number} */ index, /** @type {number} */ size, /** @type {number} */ most) => Math.min(most, Math.max(0, (index - 0.5) * size));
  const [x, end] = [edge(from, wide, ACROSS), edge(to, wide, ACROSS)];
  const [above, below] = [edge(row + 1, high, DOWN), edge(row, high, DOWN)];
  const place = { x: LEFT + x, y: TOP + DOWN - above, width: end - x, height: above - below };
  return ['fill', 'hatch'].map((layer) => svgElement('rect', { class: `${layer} ${NAMES[verdict]}`, ...place }));
}

/** The patterns by which verdicts differ besides their colours; safe has none. */
function patterns() {
  const defs = svgElement('defs');
  /** @type {Record<string, string>} */
  const drawings = { marginal: 'M0 6L6 0', stalls: 'M0 6L6 0M0 0L6 6', impossible: 'M0 3H6' };
  for (const [name, d] of Object.entries(drawings)) {
    const pattern = svgElement('pattern', { id: `map-${name}`, width: 6, height: 6, patternUnits: 'userSpaceOnUse' });
    pattern.append(svgElement('path', { class: `hatching ${name}`, d }));
    defs.append(pattern);
  }
  return defs;
}

/** @param {number} verdict */
export function legendSwatch(verdict) {
  const drawing = svgElement('svg', { class: 'stall-map swatch', viewBox: '0 0 18 12', 'aria-hidden': 'true' });
  const layers = verdict === UNKNOWN ? ['ground'] : [`fill ${NAMES[verdict]}`, `hatch ${NAMES[verdict]}`];
  drawing.append(...layers.map((name) => svgElement('rect', { class: name, width: 18, height: 12 })));
  return drawing;
}

/** A place in words, in the units shown.
 * @param {MapPlace} place @param {Over} over @param {Units} units @param {Design} design */
export function placeText({ acceleration, value }, over, units, design) {
  const { factor, word } = overUnit(over, units, design);
  const up = formatFigures(shownValue(units, design, 'acceleration', acceleration), FIGURES);
  return `${up} ${unitWord(units, design, 'acceleration')} and ${formatFigures(value * factor, FIGURES)} ${word}`;
}

/** @param {Over} over @param {Units} units @param {Design} design */
function overUnit(over, units, design) {
  const { quantity, unit } = overOf(over);
  return quantity === undefined ? { factor: 1, word: unit } : { factor: shownValue(units, design, quantity, 1), word: unitWord(units, design, quantity) };
}

/** Round values along an axis, as they are shown: 1, 2 and 5 of each decade, or evenly apart.
 * @param {MapAxis} axis @param {number} factor of the unit shown @returns {{at: number, text: string}[]} */
function ticksOf({ values, spacing }, factor) {
  const [low, high] = [values[0] * factor, values[values.length - 1] * factor];
  const parts = high > MOST_TICKED * low ? [1] : [1, 2, 5];
  /** @type {number[]} */
  const found = [];
  if (spacing === 'ratios') {
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) found.push(...parts.map((part) => part * 10 ** power));
  } else found.push(...[0, 0.25, 0.5, 0.75, 1].map((share) => low + share * (high - low)));
  return found.filter((at) => at >= low * 0.999 && at <= high * 1.001).map((at) => ({ at: at / factor, text: shortened(at) }));
}

/** @param {number} value */
const shortened = (value) => (value >= 1e6 ? `${formatFigures(value / 1e6, 1)}M` : value >= 1e4 ? `${formatFigures(value / 1e3, 1)}k` : formatFigures(value, 2));

/** Within the map, also what lies beyond it.
 * @param {Scene} scene @param {MapPlace} place */
function pixelOf({ map }, { acceleration, value }) {
  const axes = axesOf(map);
  const across = within(shareOf(axes.over, value));
  const up = within(shareOf(axes.acceleration, acceleration));
  return { x: LEFT + across * ACROSS, y: TOP + (1 - up) * DOWN };
}

/** @param {Scene} scene @param {number} x @param {number} y @returns {MapPlace} */
function placeAt({ map }, x, y) {
  const axes = axesOf(map);
  return {
    acceleration: valueAtShare(axes.acceleration, within(1 - (y - TOP) / DOWN)),
    value: valueAtShare(axes.over, within((x - LEFT) / ACROSS)),
  };
}

/** @param {number} share */
const within = (share) => Math.min(1, Math.max(0, share));
