// @ts-check
// Building elements.

/** @typedef {import('../model/messages.js').Message} Message */
/** @typedef {Node | string | null | undefined | false} Child */

const ICONS = {
  theme: 'M8 2.5a5.5 5.5 0 1 0 0 11a5.5 5.5 0 0 0 0-11',
  down: 'M4 6l4 4 4-4',
  plus: 'M8 3v10M3 8h10',
  more: 'M3.5 8h.01M8 8h.01M12.5 8h.01',
  ok: 'M3.5 8.5l3 3 6-7',
  warning: 'M8 2.5l6 11H2zM8 6.5v3.2M8 11.7v.1',
  error: 'M8 2.2a5.8 5.8 0 1 0 0 11.6a5.8 5.8 0 0 0 0-11.6M8 5v3.5M8 10.8v.1',
  paste: 'M5 3.5h-.5a1 1 0 0 0-1 1v8a1 1 0 0 0 1 1h7a1 1 0 0 0 1-1v-8a1 1 0 0 0-1-1H11M6 2.5h4v2.5H6z',
  copy: 'M5.5 5.5h7v7h-7zM3.5 10.5v-7h7',
  fit: 'M2.5 12.5h3v-4h3.5v-3h4.5M2.5 9.5C5 5 8 3.5 13.5 3',
  pin: 'M6 2.5h4v4l2 2.5H4L6 6.5zM8 9v4.5',
  pulses: 'M2 12.5h2v-9h3v9h3v-9h2.5v9H14',
  remove: 'M4.5 4.5l7 7M11.5 4.5l-7 7',
  refresh: 'M13 8a5 5 0 1 1-1.5-3.6M13 2.8v3h-3',
  undo: 'M6 3.5L2.5 7L6 10.5M2.5 7h7a3.5 3.5 0 0 1 0 7H7',
  redo: 'M10 3.5L13.5 7L10 10.5M13.5 7h-7a3.5 3.5 0 0 0 0 7H9',
  open: 'M2.5 12.5v-9h4l1.5 2h5.5v2M2.5 12.5l2-5h10l-2 5z',
  save: 'M3 3h8l2 2v8H3zM5.5 3v3.5h4.5V3M5 13V9.5h6V13',
  share: 'M8 10V2.5M5 5.2L8 2.5l3 2.7M5 7.5H3.5v6h9v-6H11',
  export: 'M8 2.5V10M5 7.2L8 10l3-2.8M3 10.5v3h10v-3',
  keys: 'M6.2 6.2a1.8 1.8 0 1 1 2.6 1.6c-.6.3-.8.7-.8 1.4M8 11.4v.1M8 2.2a5.8 5.8 0 1 0 0 11.6a5.8 5.8 0 0 0 0-11.6',
  listen: 'M5.5 11.5c0 3 4 2.5 4-.2 0-1.8 2.5-2 2.5-5a4 4 0 0 0-8 0M6.2 6.3a1.8 1.8 0 0 1 3.6 0c0 1.2-1.3 1.3-1.3 2.4',
  left: 'M10 3.5L5.5 8l4.5 4.5',
  right: 'M6 3.5L10.5 8L6 12.5',
  gear: 'M3 4.5h6M12 4.5h1M3 11.5h1M7 11.5h6M10.5 3v3M5.5 10v3',
  send: 'M8 13V3.5M4.5 6.5L8 3l3.5 3.5',
  link: 'M6.5 9.5l3-3M7.5 4.5l1-1a2.8 2.8 0 0 1 4 4l-1 1M8.5 11.5l-1 1a2.8 2.8 0 0 1-4-4l1-1',
};

/**
 * Make an element. Properties that the element knows are set as properties, all others as attributes.
 * @template {keyof HTMLElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Record<string, unknown>} [properties]
 * @param {...Child} children
 * @returns {HTMLElementTagNameMap[Tag]}
 */
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in made) Reflect.set(made, name, value);
    else if (value !== null && value !== undefined && value !== false) made.setAttribute(name, String(value));
  }
  made.append(...children.filter(isPresent));
  return made;
}

/** @param {Child} child @returns {child is Node | string} */
function isPresent(child) {
  return child !== null && child !== undefined && child !== false;
}

/** @param {string} tag @param {Record<string, string | number>} [attributes] */
export function svgElement(tag, attributes = {}) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  return made;
}

/** @param {keyof typeof ICONS} name */
export function icon(name) {
  const drawing = svgElement('svg', { class: 'icon', viewBox: '0 0 16 16', 'aria-hidden': 'true' });
  drawing.append(svgElement('path', { d: ICONS[name] }));
  if (name === 'theme') drawing.append(svgElement('path', { d: 'M8 2.5a5.5 5.5 0 0 1 0 11z', fill: 'currentColor' }));
  return drawing;
}

/**
 * A row of buttons of which one is pressed.
 * @template {string} Value
 * @param {string} label
 * @param {[Value, string][]} choices
 * @param {(value: Value) => void} onChoose
 */
export function segmented(label, choices, onChoose) {
  const group = element('span', { className: 'segmented', role: 'group', 'aria-label': label });
  for (const [value, text] of choices) {
    group.append(
      element('button', { type: 'button', textContent: text, 'data-value': value, onclick: () => onChoose(value) }),
    );
  }
  return {
    element: group,
    /** @param {Value} value */
    press(value) {
      for (const button of group.querySelectorAll('button')) {
        button.setAttribute('aria-pressed', String(button.dataset.value === value));
      }
    },
  };
}

/**
 * A drop-down list in the page's own looks.
 * @param {string} label
 * @param {(value: string) => void} onChoose
 */
export function picker(label, onChoose) {
  const select = element('select', { 'aria-label': label, onchange: () => onChoose(select.value) });
  let offered = '[]';
  return {
    element: element('span', { className: 'picker' }, select, icon('down')),
    select,
    /** Show these choices with one chosen; the list is rebuilt only when it differs, so an open one stays open.
     * @param {[string, string][]} choices @param {string} chosen */
    offer(choices, chosen) {
      const wanted = JSON.stringify(choices);
      if (wanted !== offered) {
        offered = wanted;
        select.replaceChildren(...choices.map(([value, text]) => element('option', { value, textContent: text })));
      }
      select.value = chosen;
    },
  };
}

/** Show a text, and leave it in place when it is there already: what is replaced between a press on a button and its letting
 * go makes WebKit take the two for no click.
 * @param {Node} target @param {string} text */
export function showText(target, text) {
  if (target.textContent !== text) target.textContent = text;
}

/** A line that says what is wrong or worth a look.
 * @param {Message} message @param {string} [id] */
export function messageLine({ text, isWarning }, id) {
  return element(
    'p',
    { className: isWarning ? 'message warning' : 'message', ...(id ? { id } : {}) },
    icon(isWarning ? 'warning' : 'error'),
    element('span', { textContent: text }),
  );
}

/** A cross that takes away what it stands in.
 * @param {string} label @param {() => void} onclick */
export function closeButton(label, onclick) {
  const attributes = { className: 'remove', type: /** @type {const} */ ('button'), 'aria-label': label, title: label, onclick };
  return element('button', attributes, icon('remove'));
}

/** Mark a control as wrong and tie its message to it; without a message the mark goes. What explains it in any case, the
 * element that its data-explained-by names, stays tied to it.
 * @param {HTMLElement} control @param {HTMLElement} box where the message is shown
 * @param {Message | undefined} message */
export function showMessage(control, box, message) {
  const id = `${control.id}-message`;
  const isInvalid = String(message !== undefined && !message.isWarning);
  // Nothing new: this is asked of every field whenever a slider moves.
  if (control.getAttribute('aria-invalid') === isInvalid && box.textContent === (message?.text ?? '')) return;
  control.setAttribute('aria-invalid', isInvalid);
  const tied = [message ? id : null, control.getAttribute('data-explained-by')].filter((one) => one !== null).join(' ');
  if (tied === '') control.removeAttribute('aria-describedby');
  else control.setAttribute('aria-describedby', tied);
  if (box.textContent !== (message?.text ?? '')) box.replaceChildren(...(message ? [messageLine(message, id)] : []));
}
