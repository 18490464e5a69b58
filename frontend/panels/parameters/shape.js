// @ts-check
// The choice of the ramp's shape, and the points of a drawn one.

import { CHOICES } from '../../model/fields.js';
import { SHAPES, hasField, shapeOf } from '../../model/shapes.js';
import { element, picker, showMessage } from '../../ui/dom.js';
import { pointsOf, pointsText } from '../../model/drawn_points.js';
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
    oninput: () => onEdit(POINTS, pointsOf(text.value), `type:${POINTS}`),
  });
  const box = element('div', { className: 'messages' });
  const caption = element('span', { textContent: label });
  const chart = createDrawnChart({ onPoints: (drawn, gesture) => onEdit(POINTS, drawn, gesture), onEnd: onSlid });
  const points = element('div', { className: 'drawn-points' }, caption, chart.element, text, box);
  info.explain(
    head,
    () => ({ label: 'Shape', formula: '', help: SHAPES.find((one) => one.name === name.select.value)?.help ?? '' }),
    title,
  );
  info.explain(points, () => CHOICES[POINTS], caption);

  return {
    head,
    nameBox,
    points,
    /** @param {Design} design @param {import('../../model/units.js').Units} units */
    show(design, units) {
      name.offer(
        SHAPES.map((shape) => [shape.name, shape.label]),
        shapeOf(design).name,
      );
      points.hidden = !hasField(design, POINTS);
      if (!points.hidden) chart.show(design, units);
      const shown = design.ramp.shape?.points ?? [];
      // What is being typed stays as it is typed.
      if (JSON.stringify(pointsOf(text.value)) !== JSON.stringify(shown)) text.value = pointsText(shown);
    },
    /** @param {import('../../model/messages.js').Messages['fields']} messages */
    showMessage(messages) {
      showMessage(name.select, nameBox, messages.get('ramp.shape.name'));
      const ofPoints = [...messages].find(([path]) => path.startsWith(POINTS));
      showMessage(text, box, ofPoints?.[1]);
    },
  };
}
