// @ts-check
// The guide of a first visit: four steps from a motor to a ramp that is played. It stands where the panels at the side
// are, so that the plots show what comes of each answer, and STOP stays in reach; the design is the one that all show.

import { closeGuide, goToStep, takeDrive } from '../../app/commands/guide.js';
import { chooseSection } from '../../app/commands/device.js';
import { chooseTab } from '../../app/commands/view.js';
import { curvesOf, designOf, messagesOf, stalenessOf } from '../../app/selectors.js';
import { whenever } from '../../app/state.js';
import { GUIDE_STEPS } from '../../model/guide.js';
import { element, icon, showText } from '../../ui/dom.js';
import { ONE_PLOT } from '../../ui/layouts.js';
import { createLimitsStep } from './limits.js';
import { createMotorStep } from './motor.js';
import { createRampStep } from './ramp.js';
import { createRefused } from './refused.js';
import { createUseStep } from './use.js';

/** @typedef {import('../../app/state.js').State} State */
/** @typedef {import('../../model/guide.js').GuideStep} GuideStep */

/** What is refused that the guide doesn't ask for.
 * @param {State} state @param {import('./number.js').GuideNumber[]} asked those refused that it asks for */
function refusedElsewhere(state, asked) {
  if (stalenessOf(state) !== 'refused') return [];
  const { fields, rows, others } = messagesOf(state);
  const left = [...fields].flatMap(([path, message]) => (asked.some((one) => one.path === path) ? [] : message));
  return [...left, ...rows.values(), ...others].flatMap(({ text, isWarning }) => (isWarning ? [] : text));
}

/** @param {HTMLElement} root @param {import('../../app/state.js').Dispatch} dispatch
 * @param {{openExport: (format: string) => void, saveFile: () => void}} act */
export function createGuide(root, dispatch, act) {
  /** @type {GuideStep} */
  let step = 'motor';
  const use = createUseStep({ ...act, goToDevice, choosePlayer: () => goTo('ramp') });
  const steps = { motor: createMotorStep(dispatch), limits: createLimitsStep(dispatch), ramp: createRampStep(dispatch), use };
  const tabs = GUIDE_STEPS.map(({ name, label }, at) =>
    element('button', { type: 'button', 'data-value': name, onclick: () => goTo(name) }, `${at + 1} ${label}`),
  );
  const heading = element('h2', { tabIndex: -1 });
  const closing = element(
    'button',
    { className: 'button quiet square small', id: 'guide-close', type: 'button', 'aria-label': 'Close the guide', title: 'Close it; the menu opens it again', onclick: close },
    icon('remove'),
  );
  const refused = createRefused();
  const body = element('div', { className: 'guide-body' }, refused.element, ...Object.values(steps).map((one) => one.element));
  const back = element('button', { className: 'button', id: 'guide-back', type: 'button', textContent: 'Back', onclick: () => go(-1) });
  const next = element('button', { className: 'button primary', id: 'guide-next', type: 'button', textContent: 'Next', onclick: takeAndGo });
  const skip = element('button', { className: 'button quiet', id: 'guide-skip', type: 'button', textContent: 'Skip', title: 'Leave all as it is', onclick: () => go(1) });
  root.replaceChildren(
    element('div', { className: 'panel-head' }, heading, closing),
    element('div', { className: 'segmented fill', role: 'group', 'aria-label': 'Steps of the guide' }, ...tabs),
    body,
    element('div', { className: 'guide-foot' }, back, element('span', { className: 'grow' }), skip, next),
  );
  root.hidden = true;

  const place = () => GUIDE_STEPS.findIndex(({ name }) => name === step);

  /** @param {1 | -1} direction beyond the last step the guide is over */
  function go(direction) {
    const to = GUIDE_STEPS[place() + direction];
    if (to) goTo(to.name);
    else close();
  }

  /** What is shown is the answer. */
  function takeAndGo() {
    if (step === 'motor') dispatch(takeDrive);
    go(1);
  }

  /** @param {GuideStep} name */
  function goTo(name) {
    dispatch(goToStep, name);
    body.scrollTop = 0;
    heading.focus();
  }

  function close() {
    dispatch(closeGuide);
    document.getElementById('examples')?.focus();
  }

  function goToDevice() {
    dispatch(chooseTab, 'device', ONE_PLOT.matches);
    dispatch(chooseSection, 'push');
    document.getElementById('device')?.focus();
  }

  /** Mark the steps that have something refused; tell what is that of the steps before, and in the last one all there is.
   * @param {State} state */
  function showRefused(state) {
    const ofSteps = GUIDE_STEPS.map(({ name }) => steps[name].numbers.filter((number) => number.refused() !== null));
    ofSteps.forEach((numbers, at) => mark(at, numbers.length > 0));
    const before = ofSteps.slice(0, place()).flatMap((numbers, at) => numbers.map((number) => refusalOf(number, at)));
    const others = step === 'use' ? refusedElsewhere(state, ofSteps.flat()) : [];
    refused.show([...before, ...others.map((text) => ({ text, button: 'Close the guide to correct it', act: close }))]);
  }

  /** @param {number} at @param {boolean} isRefused */
  function mark(at, isRefused) {
    const tab = tabs[at];
    if (isRefused === tab.classList.contains('refused')) return;
    tab.classList.toggle('refused', isRefused);
    const marks = isRefused ? [icon('error'), element('span', { className: 'unseen', textContent: ', with values that are refused' })] : [];
    tab.replaceChildren(`${at + 1} ${GUIDE_STEPS[at].label}`, ...marks);
  }

  /** @param {import('./number.js').GuideNumber} number @param {number} at the place of its step
   * @returns {import('./refused.js').Refused} */
  function refusalOf(number, at) {
    const { label = '', text = '' } = number.refused() ?? {};
    const { name, label: called } = GUIDE_STEPS[at];
    const act = () => {
      goTo(name);
      number.focus();
    };
    return { text: `Step ${at + 1}, ${called}: ${text}`, button: `Go to “${label}”`, act };
  }

  /** @param {State} state */
  function draw(state) {
    const { guide } = state;
    step = guide.step;
    root.hidden = !guide.isOpen;
    document.body.dataset.guide = guide.isOpen ? 'open' : 'closed';
    if (!guide.isOpen) return;
    const at = place();
    showText(heading, `${at + 1} of ${GUIDE_STEPS.length}: ${GUIDE_STEPS[at].title}`);
    for (const tab of tabs) tab.setAttribute('aria-pressed', String(tab.dataset.value === step));
    for (const [name, one] of Object.entries(steps)) one.element.hidden = name !== step;
    // What is refused of the others is told here, too; the last one asks the server for what it shows.
    for (const { name } of GUIDE_STEPS) if (name === step || name !== 'use') steps[name].show(state);
    // Whether what was typed is refused is known in a moment.
    if (stalenessOf(state) !== 'awaited') showRefused(state);
    back.disabled = at === 0;
    const isLast = at === GUIDE_STEPS.length - 1;
    skip.hidden = isLast;
    showText(next, isLast ? 'Done' : 'Next');
  }

  return {
    show: whenever((state) => {
      const { guide, units } = state;
      if (!guide.isOpen) return [guide];
      return [guide, designOf(state), units, messagesOf(state), curvesOf(state), stalenessOf(state)];
    }, draw),
  };
}
