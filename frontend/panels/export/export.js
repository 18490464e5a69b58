// @ts-check
// The dialog that exports a design: the formats, what the chosen one gives, copy and download.

import { announce } from '../../app/commands/told.js';
import { axisOf, designOf, machineOf } from '../../app/selectors.js';
import { createQuestion, laterText } from '../../app/effects/question.js';
import { whenChanged, whenever } from '../../app/state.js';
import { api } from '../../server/api.js';
import { copyText } from '../../ui/clipboard.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, icon, messageLine, picker } from '../../ui/dom.js';
import { download as saveFile } from '../../ui/download.js';
import { AXIS_LETTERS, beginning, EXPORT_FORMATS, EXPORT_GROUPS, formatBytes } from '../../documents/exports.js';
import { methodsToCompute } from '../../model/design.js';
import { createPlayed } from './played.js';
import { pushRefusals, refusalText } from '../../model/messages.js';
import { parseEntry } from '../../model/numbers.js';
import { mapKey, OVERS } from '../../model/stall_map.js';
import { inShownUnits, sentencesInUnits } from '../../model/told.js';
import { unitsFor } from '../../model/units.js';

/** @typedef {import('../../documents/exports.js').ExportFormat} ExportFormat */
/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').MethodName} MethodName */

const MOST_LINES = 400;
/** Of the options those with a field here; methods are chosen at the legend.
 * @type {('name' | 'arithmetic' | 'segment_bound_ticks' | 'axis_letter')[]} */
const OPTIONS_SHOWN = ['name', 'arithmetic', 'segment_bound_ticks', 'axis_letter'];

/** @param {Pick<import('../../app/state.js').Store, 'state' | 'dispatch'>} store
 * @param {Pick<typeof api, 'report' | 'exportDesign' | 'machine'>} [server]
 * @param {typeof api.ownRamp} [askOwn] */
export function createExport({ state, dispatch }, server = api, askOwn = api.ownRamp) {
  let format = EXPORT_FORMATS[0];
  /** What can be copied and saved.
   * @type {{file: Blob, name: string, text: string | null, remarks: string[], unplayed?: string | null} | null} */
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
  const remarks = element('ul', { className: 'export-remarks', id: 'export-remarks', hidden: true, tabIndex: 0, 'aria-label': 'What is lost of the design' });
  const played = createPlayed({ state, dispatch }, askOwn);
  const copy = element(
    'button',
    { className: 'button', id: 'export-copy', type: 'button', onclick: takeText },
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
      element('div', { className: 'export-file' }, help, options.element, remarks, played.element, preview, note),
    ),
    dialogFoot(null, copy, download),
  );
  options.showFor(format);
  dialog.element.addEventListener('close', () => {
    question.cancel();
    played.hide();
    show('');
  });

  const question = createQuestion({
    ask: async (/** @type {{format: ExportFormat, body: {design: Design}}} */ { format: asked, body }, ended) => {
      if (asked.isOfMachine) {
        const { file_name, text, remarks: said, remarks_told, unplayed } = await server.machine(asked.name, { ...body }, ended);
        const lost = sentencesInUnits(state().units, [body.design], said, remarks_told);
        return { file: new Blob([text], { type: 'text/plain' }), name: file_name, text, remarks: lost, unplayed };
      }
      const { file, name } = await (asked.report ? server.report(asked.report, body, ended) : server.exportDesign(asked.name, { ...body }, ended));
      return { file, name, text: asked.kind === 'text' ? await file.text() : null, remarks: [] };
    },
    take(found, { format: asked }) {
      made = found;
      showMade(asked);
      const design = designOf(state());
      if (made.unplayed !== undefined && design !== null) played.show(asked, design, made.unplayed);
      dialog.element.dataset.shown = asked.name;
    },
    refuse: ({ rejections }, { format: asked, body }) => showProblems(asked, rejections.map(inShownUnits(state().units, [body.design])).map(problemText)),
    miss: ({ format: asked }, error) => showProblems(asked, [laterText(error)]),
    isOnlyNewest: true,
  });

  /** @param {ExportFormat} asked @param {string[]} texts */
  function showProblems(asked, texts) {
    made = null;
    show('', ...texts.map((text) => messageLine({ text, isWarning: false })));
    dialog.element.dataset.shown = asked.name;
  }

  function refresh() {
    help.textContent = format.help;
    note.textContent = 'It is being made …';
    dialog.element.dataset.shown = '';
    made = null;
    // What is being made for an earlier one would be waited for.
    question.cancel();
    played.hide();
    enable();
    const design = designOf(state());
    if (design === null) return;
    const body = format.report ? reportOf(state(), design) : { design, ...options.wanted(format, state().shown) };
    question.want({ format, body });
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
      const src = URL.createObjectURL(made.file);
      show(`${size}.`, element('img', { src, alt: 'Velocity, delay and error of the methods shown' }));
      pictureUrl = src;
    } else {
      const text = asked.report === 'pdf' ? 'It is made: download it.' : 'It is made: download it and open it in a browser. It needs no internet.';
      show(`${size}.`, element('p', { className: 'export-page', textContent: text }));
    }
  }

  /** @param {string} text @param {...HTMLElement} shown */
  function show(text, ...shown) {
    preview.replaceChildren(...shown);
    const lost = made?.remarks ?? [];
    remarks.replaceChildren(...lost.map((one) => element('li', { textContent: one })));
    remarks.hidden = lost.length === 0;
    // The browser keeps a picture for as long as it has an address.
    URL.revokeObjectURL(pictureUrl);
    pictureUrl = '';
    note.textContent = text;
    enable();
  }

  function enable() {
    download.disabled = made === null;
    copy.disabled = made?.text === null || made === null;
  }

  async function takeText() {
    const taken = made;
    if (taken?.text == null) return;
    const isCopied = await copyText(taken.text);
    // Meanwhile another may be shown: the words beneath that are its own.
    if (taken === made) note.textContent = isCopied ? `Copied ${taken.name}.` : 'The browser does not let this page copy: use Download.';
    if (isCopied) dispatch(announce, `Copied ${taken.name}`);
  }

  function save() {
    if (made === null) return;
    saveFile(made.file, made.name);
    note.textContent = `Saved as ${made.name}.`;
  }

  const shows = [
    whenever(
      (present) => [machineOf(present), present.shown, present.units],
      () => dialog.isOpen() && refresh(),
    ),
    whenChanged(
      (present) => [present.devices.link],
      (link) => {
        if (link !== 'there') return;
        question.again();
        played.again();
      },
    ),
  ];

  return {
    /** @param {string} [wanted] a format; the one chosen last */
    open(wanted = format.name) {
      format = list.choose(wanted);
      options.showFor(format);
      dialog.open(list.chosen());
      refresh();
    },
    /** What is exported goes with the design and the methods that are shown. */
    show(/** @type {import('../../app/state.js').State} */ present) {
      for (const one of shows) one(present);
    },
  };
}

/** What a report is to be about: the design as it is looked at.
 * @param {import('../../app/state.js').State} state @param {Design} design */
function reportOf(state, design) {
  return {
    design,
    pinned: machineOf(state)?.kept ?? null,
    methods: methodsToCompute(design, new Set(state.shown)),
    units: unitsFor(state.units, design),
    maps: mapsOf(state, design),
  };
}

/** The stall maps of the design, as far as they are whole and still its own.
 * @param {import('../../app/state.js').State} state @param {Design} design */
function mapsOf(state, design) {
  if (!design.motor) return [];
  return OVERS.flatMap(({ name: over }) => {
    const known = state.stallMaps[`${axisOf(state)} ${over}`];
    const key = mapKey(design, over);
    const result = known?.pictures.find((one) => one.key === key)?.result;
    if (!result || (known.key === key && known.stage !== 'done')) return [];
    const { over_values, accelerations_steps_per_s2, verdicts } = result;
    return [{ over, over_values, accelerations_steps_per_s2, verdicts }];
  });
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
    /** @param {string} name */
    choose(name) {
      const input = /** @type {HTMLInputElement} */ (whole.querySelector(`input[value="${name}"]`));
      input.checked = true;
      return EXPORT_FORMATS.find((one) => one.name === name) ?? EXPORT_FORMATS[0];
    },
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
  const letter = picker('Axis of the machine', onChange);
  const fields = {
    name: field('Names begin with', name),
    arithmetic: field('Computes in', arithmetic.element),
    segment_bound_ticks: field('May be off by, ticks', bound),
    axis_letter: field('Axis', letter.element),
  };
  return {
    element: element('div', { className: 'export-options' }, ...Object.values(fields)),
    /** @param {ExportFormat} format */
    showFor(format) {
      const letters = format.letters ?? AXIS_LETTERS;
      const chosen = letters.find((each) => each === letter.select.value) ?? letters[0];
      letter.offer(letters.map((each) => [each, each]), chosen);
      for (const option of OPTIONS_SHOWN) fields[option].hidden = !format.options.includes(option);
    },
    /** The part of the request that the format looks at.
     * @param {ExportFormat} format @param {MethodName[]} methods */
    wanted(format, methods) {
      const all = {
        name: name.value.trim() === '' ? null : name.value.trim(),
        arithmetic: arithmetic.select.value === '' ? null : arithmetic.select.value,
        segment_bound_ticks: parseEntry(bound.value),
        axis_letter: letter.select.value,
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

/** What is refused, in words. Which methods a report compares is chosen at the legend.
 * @param {import('../../model/types.js').Rejection} rejection */
function problemText(rejection) {
  const { field: name, allowed, message } = rejection;
  if (name === 'methods') return `The report compares ${allowed}: hide some in the legend.`;
  if (name === 'axis_letter') return refusalText(rejection, 'Axis');
  return name?.startsWith('design.') ? pushRefusals([rejection])[0].text : message;
}
