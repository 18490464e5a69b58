// @ts-check
// Where an axis is and how fast it moves.

import { agoText } from '../../devices/ages.js';
import { SET_POSITION, shownState, shuttleText } from '../../devices/state_words.js';
import { element, messageLine, showText } from '../../ui/dom.js';
import { formatFigures, formatFixed } from '../../model/numbers.js';
import { lengthFigures } from '../../model/places.js';
import { shownValue, unitsFor, unitWord } from '../../model/units.js';
import { limitsText } from './limits.js';

/** @typedef {import('./section.js').Context} Context */

export function createLive() {
  const position = readout('Current position', 'position');
  const speed = readout('Speed', 'speed');
  const limits = element('p', { className: 'reason', id: 'live-limits' });
  const unknown = element(
    'div',
    { id: 'unknown-position' },
    messageLine({
      text: `Since it was lost, restarted, homed by others or in part only, this is what the controller counts, and may not be where it is. ${SET_POSITION}`,
      isWarning: true,
    }),
  );
  const beyond = element(
    'div',
    { id: 'beyond-limits', role: 'status' },
    messageLine({
      text: 'It is beyond its soft limits: only moves that end within them, and runs towards them, are taken.',
      isWarning: true,
    }),
  );
  const old = element('div', { id: 'old-state' });
  const shuttle = element('p', { className: 'reason', id: 'live-shuttle', role: 'status' });
  const readouts = element('div', { className: 'live' }, position.element, speed.element);
  return {
    element: element('div', { className: 'live-box' }, readouts, old, shuttle, limits, beyond, unknown),
    /** @param {Context} context */
    show({ known: device, axis, situation }) {
      const state = device?.axes[axis] ?? null;
      const isLost = device?.state === 'lost';
      const restarts = shownState(device) === 'restarting';
      const isOld = state !== null && (isLost || restarts || situation.link !== 'there' || situation.age !== null);
      readouts.classList.toggle('old', isOld);
      old.hidden = !isOld;
      const when = situation.age === null ? 'a moment ago' : agoText(situation.age);
      const oldText = !isOld ? '' : restarts ? 'It restarts: this is where it was.' : `Nothing is heard of it: this is how it was ${when}.`;
      if (old.textContent !== oldText) old.replaceChildren(messageLine({ text: oldText, isWarning: true }));
      showText(shuttle, isLost ? '' : shuttleText(device));
      shuttle.hidden = shuttle.textContent === '';
      const { units } = situation;
      const design = situation.scaled[axis];
      const isInSteps = unitsFor(units, design).length === 'steps';
      const length = (/** @type {number} */ steps) => lengthFigures(units, design, steps);
      // Without a place its speed is what is known of it.
      const place = state?.position_told ? state : null;
      const notes = [
        state && !place ? 'not told' : '',
        place && !isInSteps ? `${formatFixed(place.position_steps)} steps` : '',
        place && place.target_steps !== place.position_steps ? `to ${length(place.target_steps)}` : '',
      ];
      position.show(place ? length(place.position_steps) : '–', unitWord(units, design, 'length'), notes.filter(Boolean).join(' · '));
      const shown = state ? shownValue(units, design, 'speed', state.speed_steps_per_s) : 0;
      speed.show(state && !isLost && !restarts ? (isInSteps ? formatFixed(shown) : formatFigures(shown)) : '–', unitWord(units, design, 'speed'), '');
      const span = state ? limitsText(units, design, state) : '';
      const isUnknown = device?.unknown_positions.includes(axis) ?? false;
      // Nobody knows where the limits are of what isn't where it counts: the server lets nothing move it.
      const text = span && `Soft limits: ${span}${isUnknown ? '. It moves once its position is set' : ''}`;
      if (limits.textContent !== text) limits.textContent = text;
      limits.hidden = text === '';
      unknown.hidden = !isUnknown || isLost || device?.state === 'connecting' || (state?.homing ?? false);
      beyond.hidden = isUnknown || !state?.is_beyond_limits;
    },
  };
}

/** @param {string} label @param {string} name */
function readout(label, name) {
  const value = element('b', { id: `live-${name}` });
  const more = element('small', { className: 'target' });
  const unit = element('small');
  return {
    element: element('div', {}, element('span', {}, label, more), value, ' ', unit),
    /** @param {string} text @param {string} word @param {string} note */
    show(text, word, note) {
      if (value.textContent !== text) value.textContent = text;
      if (unit.textContent !== word) unit.textContent = word;
      if (more.textContent !== note) more.textContent = note;
    },
  };
}
