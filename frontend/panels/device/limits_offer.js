// @ts-check
// Soft limits that are remembered of a port and not in force, as after the server was started anew: offered, never set unasked.

import { element, icon, showText } from '../../ui/dom.js';
import { otherPlacesText } from '../../devices/kept_limits.js';
import { atScale } from '../../model/units.js';
import { limitsText } from './limits.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').KeptLimits} KeptLimits */
/** @typedef {import('../../model/types.js').Situation} Situation */
/** @typedef {import('../../model/types.js').SoftLimits} SoftLimits */

/** @param {{limitAgain: (device: Device, axes: SoftLimits[]) => void}} act */
export function createLimitsOffer(act) {
  const words = element('span');
  const set = element('button', { className: 'button small', id: 'set-limits', type: 'button', textContent: 'Set' });
  const message = element('p', { className: 'message warning' }, icon('warning'), words);
  const offer = element('div', { className: 'others', id: 'limits-offer', role: 'status' }, message, set);
  return {
    element: offer,
    /** Of each axis that has others or none. Those that would be at other places are said, and not offered.
     * @param {Device | null} present null: none that can be given any @param {KeptLimits[]} kept of its port
     * @param {Situation} situation */
    show(present, kept, situation) {
      const missing = present === null ? [] : missingOn(present, kept);
      offer.hidden = missing.length === 0;
      if (present === null || missing.length === 0) return;
      showText(words, offerText(present, missing, situation));
      const isConnecting = present.state === 'connecting';
      const same = missing.filter((one) => otherPlacesText(one, present.axes[one.axis]) === '');
      set.hidden = same.length === 0 && !isConnecting;
      set.disabled = situation.isBusy || isConnecting;
      const limits = same.map(({ axis, lowest_steps, highest_steps }) => ({ axis, lowest_steps, highest_steps }));
      set.onclick = () => act.limitAgain(present, limits);
    },
  };
}

/** Those of axes that have others or none.
 * @param {Device} device @param {KeptLimits[]} kept */
function missingOn({ axes }, kept) {
  return kept.filter(({ axis, lowest_steps, highest_steps }) => {
    const one = axes[axis];
    return one && (one.lowest_steps !== lowest_steps || one.highest_steps !== highest_steps);
  });
}

/** @param {Device} device @param {KeptLimits[]} missing @param {Situation} situation */
function offerText({ axes, state }, missing, { scaled, units }) {
  const spans = missing.map((kept) => {
    const { steps_per_mm: stepsPerMm = null, microsteps = null } = kept;
    // In lengths they are what they were when they were set.
    const span = limitsText(units, atScale(scaled[kept.axis], { stepsPerMm, microsteps }), kept);
    return axes.length === 1 ? span : `axis ${kept.axis} ${span}`;
  });
  // While it connects its scale may not have been told yet.
  const others = state === 'connecting' ? [] : missing.flatMap((kept) => {
    const why = otherPlacesText(kept, axes[kept.axis]);
    const which = axes.length === 1 ? 'They' : `Those of axis ${kept.axis}`;
    return why === '' ? [] : [`${which} ${why}: set them anew in the device settings.`];
  });
  return [`Soft limits of this port, ${spans.join(', ')}, are not in force.`, ...others].join(' ');
}
