// @ts-check
// The head of the page: whose design it is, examples, theme, what the device does, and STOP.

import { element, icon, messageLine, svgElement } from '../../dom.js';

/** @typedef {import('../../types.js').Device} Device */
/** @typedef {import('../../types.js').Example} Example */

/**
 * @param {HTMLElement} root
 * @param {object} handlers
 * @param {(name: string) => void} handlers.onName
 * @param {(example: Example) => void} handlers.onExample
 * @param {() => void} handlers.onBack
 * @param {() => void} handlers.onTheme
 * @param {() => void} handlers.onStop
 */
export function createHeader(root, handlers) {
  const name = element('input', {
    className: 'design-name',
    'aria-label': 'Design name',
    spellcheck: false,
    autocomplete: 'off',
    oninput: () => handlers.onName(name.value),
  });
  const menu = createMenu(handlers);
  const theme = element(
    'button',
    {
      className: 'button quiet square not-phone',
      type: 'button',
      'aria-label': 'Switch between light and dark',
      title: 'Light or dark',
      onclick: handlers.onTheme,
    },
    icon('theme'),
  );
  const who = element('span', { className: 'who not-phone' });
  const word = element('span');
  const pill = element('span', { className: 'pill', id: 'device-pill' }, who, word);
  const stopText = element('span');
  const stop = element(
    'button',
    { className: 'stop', id: 'stop', type: 'button', onclick: handlers.onStop },
    stopText,
    element('kbd', { className: 'not-phone', 'aria-hidden': 'true', textContent: 'Esc' }),
  );
  root.replaceChildren(
    brand(),
    element('span', { className: 'rule not-phone' }),
    name,
    menu.element,
    element('span', { className: 'grow not-phone' }),
    theme,
    pill,
    stop,
  );
  showStopping(false);

  /** @param {boolean} isStopping */
  function showStopping(isStopping) {
    stopText.textContent = isStopping ? 'HALT' : 'STOP';
    stop.setAttribute(
      'aria-label',
      isStopping ? 'Halt at once without slowing down (Escape)' : 'Stop every motor (Escape)',
    );
  }

  return {
    /** @param {string} text */
    showName(text) {
      if (document.activeElement !== name) name.value = text;
      document.title = text === '' ? 'StepRamp' : `${text} · StepRamp`;
    },
    showExamples: menu.showExamples,
    /** @param {Device | null} device @param {boolean} isStopping whether a second press halts */
    showDevice(device, isStopping) {
      pill.dataset.state = device?.state ?? 'none';
      who.textContent = device ? `${device.name} ·` : '';
      word.textContent = device ? device.state : 'no device';
      showStopping(isStopping);
    },
  };
}

function brand() {
  const drawing = svgElement('svg', {
    viewBox: '0 0 24 24',
    'aria-hidden': 'true',
    fill: 'none',
    'stroke-width': 2.6,
    'stroke-linejoin': 'round',
    'stroke-linecap': 'round',
  });
  drawing.append(svgElement('path', { d: 'M2 20h4v-5h4v-5h4V5h8' }));
  return element(
    'div',
    { className: 'brand' },
    drawing,
    element('span', { className: 'not-phone', textContent: 'StepRamp' }),
  );
}

/** @param {{onExample: (example: Example) => void, onBack: () => void, onTheme: () => void}} handlers */
function createMenu(handlers) {
  const large = icon('more');
  large.classList.add('large', 'phone-only');
  const arrow = icon('down');
  arrow.classList.add('not-phone');
  const list = element('div', { className: 'menu-list', id: 'menu-list', hidden: true });
  const opener = element(
    'button',
    {
      className: 'button quiet',
      id: 'examples',
      type: 'button',
      'aria-label': 'Examples',
      'aria-expanded': 'false',
      'aria-controls': 'menu-list',
      onclick: () => open(Boolean(list.hidden)),
    },
    element('span', { className: 'not-phone', textContent: 'Examples' }),
    arrow,
    large,
  );
  const whole = element('div', { className: 'menu' }, opener, list);

  /** @param {boolean} isOpen */
  function open(isOpen) {
    list.hidden = !isOpen;
    opener.setAttribute('aria-expanded', String(isOpen));
    if (isOpen) list.querySelector('button')?.focus();
  }

  /** @param {string} title @param {string} text @param {() => void} onChoose @param {string} [className] */
  function item(title, text, onChoose, className = '') {
    const choose = () => {
      open(false);
      opener.focus();
      onChoose();
    };
    return element(
      'button',
      { type: 'button', className, onclick: choose },
      element('b', { textContent: title }),
      text !== '' && element('span', { textContent: text }),
    );
  }

  whole.addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && !list.hidden) {
      open(false);
      opener.focus();
    }
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step === undefined || list.hidden) return;
    event.preventDefault();
    const items = [...list.querySelectorAll('button')].filter((one) => one.offsetParent !== null);
    const at = items.findIndex((one) => one === document.activeElement);
    items[(at + step + items.length) % items.length].focus();
  });
  addEventListener('pointerdown', (event) => {
    if (!list.hidden && event.target instanceof Node && !whole.contains(event.target)) open(false);
  });

  return {
    element: whole,
    /** @param {Example[]} examples @param {string | null} replaced name of the design that can be had back */
    showExamples(examples, replaced) {
      list.replaceChildren(
        ...examples.map((example) => item(example.title, example.description, () => handlers.onExample(example))),
        ...(examples.length === 0
          ? [messageLine({ text: 'The examples come with the server, which does not answer.', isWarning: true })]
          : []),
        ...(replaced === null
          ? []
          : [
              element('hr'),
              item(
                `Back to your “${replaced || 'unnamed'}”`,
                'The design that an example took the place of.',
                handlers.onBack,
              ),
            ]),
        element('hr', { className: 'phone-only' }),
        item('Light or dark', '', handlers.onTheme, 'phone-only'),
      );
    },
  };
}
