// @ts-check
// The dialog that exports a design: the formats, what the chosen one gives, copy and download.

import { api, Refusal, ServerGone } from '../../api.js';
import { createDialog, dialogFoot } from '../../dialog.js';
import { element, icon, messageLine, picker } from '../../dom.js';
import { beginning, EXPORT_FORMATS, EXPORT_GROUPS, formatBytes } from '../../exports.js';
import { newestWins } from '../../newest.js';
import { parseEntry } from '../../numbers.js';

/** @typedef {import('../../exports.js').ExportFormat} ExportFormat */
/** @typedef {import('../../types.js').Design} Design */
/** @typedef {import('../../types.js').MethodName} MethodName */

const MOST_LINES = 400;

/**
 * @param {object} handlers
 * @param {() => Design | null} handlers.design
 * @param {() => MethodName[]} handlers.methods those that are shown, for reports and pictures
 * @param {(text: string) => void} handlers.say
 */
export function createExport(handlers) {
  let format = EXPORT_FORMATS[0];
  /** What can be copied and saved.
   * @type {{file: Blob, name: string, text: string | null} | null} */
  let made = null;
  let pictureUrl = '';

  const list = formatList((chosen) => {
    format = chosen;
    options.showFor(format);
    refresh();
  });
  const options = createOptions(refresh);
  const help = element('p', { className: 'export-help', id: 'export-help' });
  const note = element('p', { className: 'export-note muted', 'aria-live': 'polite' });
  const preview = element('div', { className: 'export-preview', id: 'export-preview' });
  const copy = element(
    'button',
    { className: 'button', id: 'export-copy', type: 'button', onclick: copyText },
    icon('paste'),
    'Copy',
  );
  const download = element(
    'button',
    { className: 'button primary', id: 'export-download', type: 'button', onclick: save },
    icon('down'),
    'Download',
  );
  const dialog = createDialog(
    { id: 'export-dialog', title: 'Export' },
    element(
      'div',
      { className: 'export-body' },
      list.element,
      element('div', { className: 'export-file' }, help, options.element, preview, note),
    ),
    dialogFoot(null, copy, download),
  );
  options.showFor(format);

  const ask = newestWins(async () => {
    const design = handlers.design();
    if (design === null) return;
    const asked = format;
    const body = { design, ...options.wanted(asked, handlers.methods()) };
    try {
      const { file, name } = await api.exportDesign(asked.name, body);
      made = { file, name, text: asked.kind === 'text' ? await file.text() : null };
      showMade(asked);
    } catch (error) {
      if (!(error instanceof Refusal || error instanceof ServerGone)) throw error;
      made = null;
      const texts = error instanceof Refusal ? error.rejections.map((each) => each.message) : [error.message];
      show('', ...texts.map((text) => messageLine({ text, isWarning: false })));
    }
    dialog.element.dataset.shown = asked.name;
  });

  function refresh() {
    help.textContent = format.help;
    dialog.element.dataset.shown = '';
    made = null;
    enable();
    ask();
  }

  /** @param {ExportFormat} asked */
  function showMade(asked) {
    if (made === null) return;
    const size = `${made.name}, ${formatBytes(made.file.size)}`;
    if (made.text !== null) {
      const { shown, lines, shownLines } = beginning(made.text, MOST_LINES);
      const part = shownLines < lines ? ` Shown: the first ${shownLines} of ${lines.toLocaleString('en')} lines.` : '';
      const text = element('pre', { textContent: shown, tabIndex: 0, role: 'region', 'aria-label': made.name });
      show(`${size}.${part}`, text);
    } else if (asked.kind === 'picture') {
      pictureUrl = URL.createObjectURL(made.file);
      show(`${size}.`, element('img', { src: pictureUrl, alt: 'Velocity, delay and error of the methods shown' }));
    } else {
      const text = 'The report is made. Download it and open it in a browser: it needs no internet.';
      show(`${size}.`, element('p', { className: 'export-page', textContent: text }));
    }
  }

  /** @param {string} text @param {...HTMLElement} shown */
  function show(text, ...shown) {
    const before = pictureUrl;
    preview.replaceChildren(...shown);
    if (before !== '' && !preview.querySelector(`img[src="${before}"]`)) {
      URL.revokeObjectURL(before);
      pictureUrl = '';
    }
    note.textContent = text;
    enable();
  }

  function enable() {
    download.disabled = made === null;
    copy.disabled = made?.text === null || made === null;
  }

  async function copyText() {
    if (made?.text == null) return;
    try {
      await navigator.clipboard.writeText(made.text);
      note.textContent = `Copied ${made.name}.`;
      handlers.say(`Copied ${made.name}`);
    } catch {
      note.textContent = 'The browser does not let this page copy: use Download.';
    }
  }

  function save() {
    if (made === null) return;
    const url = URL.createObjectURL(made.file);
    element('a', { href: url, download: made.name }).click();
    URL.revokeObjectURL(url);
    note.textContent = `Saved as ${made.name}.`;
  }

  return {
    open() {
      dialog.open(list.chosen());
      refresh();
    },
    /** The design or the methods have changed. */
    showChanged() {
      if (dialog.isOpen()) refresh();
    },
  };
}

/** The formats in their groups: radio buttons, so that arrow keys go from one to the next.
 * @param {(format: ExportFormat) => void} onChoose */
function formatList(onChoose) {
  /** @param {ExportFormat} format */
  const item = (format) =>
    element(
      'label',
      { className: 'export-format' },
      element('input', {
        type: 'radio',
        name: 'export-format',
        value: format.name,
        checked: format === EXPORT_FORMATS[0],
        onchange: () => onChoose(format),
      }),
      element('span', { textContent: format.label }),
    );
  const whole = element(
    'div',
    { className: 'export-formats', role: 'radiogroup', 'aria-label': 'Format' },
    ...EXPORT_GROUPS.flatMap(({ title, formats }) => [
      element('h3', { textContent: title }),
      ...formats.map((format) => item(format)),
    ]),
  );
  return {
    element: whole,
    chosen: () => /** @type {HTMLElement | null} */ (whole.querySelector('input:checked')),
  };
}

/** What can be chosen about the file; only what the format looks at is shown.
 * @param {() => void} onChange */
function createOptions(onChange) {
  const name = element('input', {
    id: 'export-name',
    placeholder: 'as the design',
    spellcheck: false,
    autocomplete: 'off',
    oninput: onChange,
  });
  const bound = element('input', { id: 'export-bound', inputMode: 'numeric', value: '0', oninput: onChange });
  const arithmetic = picker('Numbers that it computes in', onChange);
  const numbers = ['float32', 'float64', 'fixed'].map((each) => /** @type {[string, string]} */ ([each, each]));
  arithmetic.offer([['', 'as the design, or usual'], ...numbers], '');
  const fields = {
    name: field('Names begin with', name),
    arithmetic: field('Computes in', arithmetic.element),
    segment_bound_ticks: field('May be off by, ticks', bound),
  };
  return {
    element: element('div', { className: 'export-options' }, ...Object.values(fields)),
    /** @param {ExportFormat} format */
    showFor(format) {
      fields.name.hidden = !format.options.includes('name');
      fields.arithmetic.hidden = !format.options.includes('arithmetic');
      fields.segment_bound_ticks.hidden = !format.options.includes('segment_bound_ticks');
    },
    /** The part of the request that the format looks at.
     * @param {ExportFormat} format @param {MethodName[]} methods */
    wanted(format, methods) {
      const all = {
        name: name.value.trim() === '' ? null : name.value.trim(),
        arithmetic: arithmetic.select.value === '' ? null : arithmetic.select.value,
        segment_bound_ticks: parseEntry(bound.value),
        methods,
      };
      return Object.fromEntries(format.options.map((option) => [option, all[option]]));
    },
  };
}

/** @param {string} label @param {HTMLElement} control */
function field(label, control) {
  return element('label', {}, element('span', { textContent: label }), control);
}
