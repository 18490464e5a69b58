// @ts-check
// The choice of the ramp's shape, and the points of a drawn one.

import { CHOICES } from '../../model/fields.js';
import { MOST_POINTS, SHAPES, hasField, shapeOf, shapesFor } from '../../model/shapes.js';
import { element, picker, showMessage } from '../../ui/dom.js';
import { linesOf, pointsOf, pointsText } from '../../model/drawn_points.js';
import { formatFixed } from '../../model/numbers.js';
import { shownValue, unitWord } from '../../model/units.js';
import { createDrawnChart } from './drawn_chart.js';

/** @typedef {import('../../model/types.js').Design} Design */

const POINTS = 'ramp.shape.points';

/**
 * @param {{onEdit: (path: string, value: unknown, gesture?: string) => void, onShape: (name: string) => void,
 *   onSlid: () => void}} handlers
 * @param {ReturnType<typeof import('./info.js').createInfo>} info
 */
export function createShape({ onEdit, onShape, onSlid }, info) {
  const name = picker('Shape', onShape);
  name.element.classList.add('quiet');
  name.select.id = 'shape';
  const title = element('h2', { textContent: 'Ramp' });
  const head = element('div', { className: 'group-head' }, title, name.element);
  const nameBox = element('div');
  const { label, help } = CHOICES[POINTS];
  const text = element('textarea', {
    id: 'drawn-points',
    rows: 5,
    spellcheck: false,
    autocomplete: 'off',
    'aria-label': label,
    'aria-description': help,
    oninput: typed,
  });
  const box = element('div', { className: 'messages' });
  const columns = element('small', { className: 'muted' });
  const caption = element('span', {}, label, columns);
  const chart = createDrawnChart({ onPoints: (drawn, gesture) => onEdit(POINTS, drawn, gesture), onEnd: onSlid });
  const points = element('div', { className: 'drawn-points' }, caption, chart.element, text, box);
  info.explain(
    head,
    () => ({ label: 'Shape', formula: '', help: SHAPES.find((one) => one.name === name.select.value)?.help ?? '' }),
    title,
  );
  info.explain(points, () => CHOICES[POINTS], caption);

  /** Lines that are more than a design may have, and its points meanwhile: it stays as it is, and the text, too.
   * @type {{count: number, points: unknown} | null} */
  let tooMany = null;
  /** @type {Design | null} */
  let present = null;
  /** Of the unit that speeds are shown in. */
  let factor = 1;
  /** @type {import('../../model/messages.js').Message | undefined} */
  let message;

  function typed() {
    // Beside the points there may be a heading. More lines aren't read: thousands take seconds.
    const lines = linesOf(text.value).length;
    const typedPoints = lines > MOST_POINTS + 1 ? null : pointsOf(text.value, factor);
    const count = typedPoints?.length ?? lines;
    tooMany = count > MOST_POINTS ? { count, points: present?.ramp.shape?.points } : null;
    if (typedPoints && tooMany === null) onEdit(POINTS, typedPoints, `type:${POINTS}`);
    tellOfPoints();
  }

  function tellOfPoints() {
    const many = tooMany && {
      text: `${label} are ${formatFixed(tooMany.count)} points; allowed: 2 to ${MOST_POINTS}. The ramp stays as it was.`,
      isWarning: false,
    };
    showMessage(text, box, many ?? message);
  }

  return {
    head,
    nameBox,
    points,
    /** @param {Design} design @param {import('../../model/units.js').Units} units */
    show(design, units) {
      name.offer(
        shapesFor(design).map((shape) => [shape.name, shape.label]),
        shapeOf(design).name,
      );
      points.hidden = !hasField(design, POINTS);
      if (!points.hidden) chart.show(design, units);
      present = design;
      const before = factor;
      factor = shownValue(units, design, 'speed', 1);
      columns.textContent = ` a line each: ${unitWord(units, design, 'speed')}, part of a`;
      if (tooMany?.points !== design.ramp.shape?.points) tooMany = null;
      if (tooMany) return;
      const shown = design.ramp.shape?.points ?? [];
      // What is being typed stays as it is typed.
      const isTyped = factor === before && JSON.stringify(pointsOf(text.value, factor)) === JSON.stringify(shown);
      if (!isTyped) text.value = pointsText(shown, factor);
    },
    /** @param {import('../../model/messages.js').Messages['fields']} messages */
    showMessage(messages) {
      showMessage(name.select, nameBox, messages.get('ramp.shape.name'));
      message = [...messages].find(([path]) => path.startsWith(POINTS))?.[1];
      tellOfPoints();
    },
  };
}
