// @ts-check
// The wiring: what one panel reports is told to the others. Panels know no other panel.

import { api, Refusal, ServerGone } from './api.js';
import { createBeside } from './beside.js';
import { calculate, NO_DETAILS } from './calculation.js';
import { activeProfile } from './curves.js';
import { methodsToCompute, withMethod, withTable, withValue } from './design.js';
import { watchEscape } from './escape.js';
import { openFile, saveFile, watchDrops } from './files.js';
import { createFleet } from './fleet.js';
import { historyKey } from './history_keys.js';
import { memory } from './memory.js';
import { sortMessages } from './messages.js';
import { SHOWN_AT_FIRST } from './methods.js';
import { newestWins } from './newest.js';
import { createOpening } from './opening.js';
import { createOutOfReach } from './out_of_reach.js';
import { createAxes } from './panels/axes/axes.js';
import { createDevice } from './panels/device/device.js';
import { createExport } from './panels/export/export.js';
import { createHeader } from './panels/header/header.js';
import { createParameters } from './panels/parameters/parameters.js';
import { createPlots } from './panels/plots/plots.js';
import { createStatus } from './panels/status/status.js';
import { createSummary } from './panels/summary/summary.js';
import { createTable } from './panels/table/table.js';
import { createTabs } from './panels/tabs/tabs.js';
import { withPreset } from './presets.js';
import { shareLink } from './sharing.js';
import { createStop } from './stopping.js';
import { startTheme, switchTheme } from './theme.js';
import { createWorkbench } from './workbench.js';

/** @typedef {import('./types.js').Answer} Answer */
/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Example} Example */
/** @typedef {import('./types.js').MethodName} MethodName */
/** @typedef {import('./workbench.js').State} State */

/** @param {string} id */
const part = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

const shown = new Set(memory.shown() ?? SHOWN_AT_FIRST);
/** What is worked on; null until there is something: kept from the last time, in the address, or the first example.
 * @type {ReturnType<typeof createWorkbench> | null} */
let workbench = null;
let areAllShown = false;
/** What the plots want beside the curves themselves. */
let details = NO_DETAILS;
const beside = createBeside();
/** @type {Answer | null} */
let answer = null;
/** What the plots show of all axes together.
 * @type {import('./beside.js').AllAxes} */
const ONE_AXIS = { moves: null, messages: [] };
let allAxes = ONE_AXIS;
/** What was wrong with the newest design asked about.
 * @type {import('./types.js').Rejection[]} */
let rejections = [];
/** @type {Example[]} */
let examples = [];
/** @type {import('./types.js').Staleness} */
let staleness = null;
/** What has to be read before all else: a STOP that failed, a device out of reach that may
 * move, a link that can't be opened.
 * @type {Map<string, string>} */
const urgent = new Map();

// ---- what is worked on ----

const design = () => workbench?.design() ?? null;

/** @param {Design} changed @param {string} [gesture] changes in a row with the same one are undone together */
function edit(changed, gesture) {
  // A method that is chosen is shown; it may be hidden again.
  if (changed.method.name !== design()?.method.name) memory.keepShown(shown.add(changed.method.name));
  workbench?.edit(changed, gesture);
}

/** @param {(present: Design) => Design} changed @param {string} [gesture] */
function change(changed, gesture) {
  const present = design();
  if (present) edit(changed(present), gesture);
}

/** @param {State} state */
function begin(state) {
  workbench = createWorkbench(state, changed);
  changed();
}

function changed() {
  if (!workbench) return;
  urgent.delete('opening');
  const state = workbench.state();
  // The question first: the server works on it while the panels are brought up to date.
  compute();
  status.showKept(memory.keepState(state));
  showWork(state);
  showDevices();
}

const opening = createOpening({
  state: () => workbench?.state() ?? null,
  isOwn: () => !examples.some((one) => JSON.stringify([one.design]) === JSON.stringify(workbench?.work().axes)),
  put: (work) => {
    table.forget();
    areAllShown = false;
    if (workbench) workbench.replace(work);
    else begin({ ...work, active: 0, kept: null });
    offerExamples();
  },
  say: (text, hasFailed) => {
    if (hasFailed) urgent.set('opening', text);
    tell(text, hasFailed);
    showMessages();
  },
});

// ---- panels ----

/** What the plots show of a running move.
 * @type {import('./types.js').Samples | null} */
let live = null;

const fleet = createFleet({
  onChange: () => {
    stop.follow(fleet.devices());
    outOfReach.follow(fleet.devices());
    showDevices();
  },
  onPorts: (known) => devicePanel.showPorts(known),
  onRejected: (list) => devicePanel.showRejections(list),
  onMeasured: (measured) => plots.showMeasured(measured),
  say: announce,
  onLink: (link) => {
    status.showServer(link);
    announce({ there: 'The server is back', silent: 'The server is silent', gone: 'The server is gone' }[link]);
    if (link !== 'there') return;
    urgent.delete('stop');
    refresh();
  },
});
const stop = createStop(fleet, (text, hasFailed) => {
  if (hasFailed) urgent.set('stop', text);
  else urgent.delete('stop');
  announce(text);
  showMessages();
  showDevices();
});
const outOfReach = createOutOfReach();
const header = createHeader(part('header'), {
  onName: (name) => change((present) => ({ ...present, name }), 'name'),
  onExample: (example) => opening.replace({ axes: [example.design], together: 'independent' }),
  onBack: opening.goBack,
  onUndo: () => stepHistory('undo'),
  onRedo: () => stepHistory('redo'),
  onOpen: () => openFile(opening.open),
  onSave: () => {
    if (workbench) tell(`Saved as ${saveFile(workbench.work())}`, false);
  },
  onShare: () => {
    if (workbench) shareLink(workbench.work(), { say: tell, showLink: header.showLink });
  },
  onStop: pressStop,
  onExport: () => exporting.open(),
  onTheme: () => {
    switchTheme();
    plots.redraw();
  },
});
const exporting = createExport({ design, methods: () => [...shown], say: announce });
createTabs(part('tabs'), (name) => name === 'table' && plots.showRows());
const axes = createAxes(part('axes'), {
  onChoose: (axis) => workbench?.choose(axis),
  onAdd: () => workbench?.addAxis(),
  onRemove: (axis) => workbench?.removeAxis(axis),
  onTogether: (together) => workbench?.setTogether(together),
  onAll: (all) => {
    areAllShown = all;
    changed();
  },
});
const parameters = createParameters(part('parameters'), {
  onEdit: (path, value, gesture) => change((present) => withValue(present, path, value), gesture),
  onMethod: (name) => change((present) => withMethod(present, name)),
  onPreset: (part, preset) => {
    change((present) => withPreset(present, part, preset));
    tell(`${preset.name}: set`, false);
  },
  onUnits: (units) => {
    memory.keepUnits(units);
    showUnits(units);
  },
  onSliding: (isMoving) => {
    if (details.isMoving === isMoving) return;
    details = { ...details, isMoving };
    if (!isMoving) compute();
    plots.showSliding(isMoving);
  },
});
const summary = createSummary(part('summary'));
const status = createStatus(part('status'));
const plots = createPlots(part('figure'), shown, {
  onSwitch: switchMethod,
  onReading: (reading) => status.showReading(reading, answer?.design.method.name ?? ''),
  onRange: (range) => {
    details = { ...details, range };
    compute();
  },
  onDetails: (wanted) => {
    details = { ...details, ...wanted };
    compute();
  },
  onKeep: () => workbench?.keep(),
  onForget: () => workbench?.forget(),
  onRows: (rows, gesture) =>
    change((present) => withTable(present, rows, present.table?.interval_unit ?? 'us'), gesture),
  onSelectRow: (row) => table.select(row),
});
const table = createTable(part('table'), {
  onEdit: (rows, unit, gesture) => change((present) => withTable(present, rows, unit), gesture),
  onSelect: (row) => plots.selectRow(row),
  ask: api,
});
const devicePanel = createDevice(part('device'), fleet, showDevices);

// ---- computing ----

const compute = newestWins(async () => {
  const asked = design();
  if (asked === null) return;
  try {
    answer = await calculate(asked, methodsToCompute(asked, shown), details);
    rejections = [];
    staleness = null;
    plots.show(answer);
    summary.show(answer);
    await showBeside();
  } catch (error) {
    if (!(error instanceof Refusal || error instanceof ServerGone)) throw error;
    // Without an answer the same is asked again once the server is back.
    rejections = error instanceof Refusal ? error.rejections : [];
    staleness = error instanceof Refusal ? 'refused' : 'unanswered';
  }
  showMessages();
  showDevices();
});

async function showBeside() {
  if (!workbench) return;
  const state = workbench.state();
  const kept = await beside.kept(state.kept);
  plots.showKept(kept);
  summary.showKept(kept);
  allAxes = areAllShown && state.axes.length > 1 ? await beside.axes(state, memory.units()) : ONE_AXIS;
  plots.showAxes(allAxes.moves);
}

/** @param {MethodName} name */
function switchMethod(name) {
  if (!shown.delete(name)) shown.add(name);
  memory.keepShown(shown);
  plots.redraw();
  exporting.showChanged();
  compute();
}

// ---- showing ----

/** @param {State} state */
function showWork(state) {
  const present = state.axes[state.active];
  header.showName(present.name);
  header.showHistory(workbench?.canUndo() ?? false, workbench?.canRedo() ?? false);
  axes.show(state, areAllShown);
  parameters.show(present);
  table.show(present);
  plots.showDesign(present);
  exporting.showChanged();
}

/** @param {import('./units.js').Units} units */
function showUnits(units) {
  parameters.showUnits(units);
  plots.showUnits(units);
  summary.showUnits(units);
  showDevices();
  showBeside();
}

function showMessages() {
  const warnings = answer && staleness === null ? activeProfile(answer).warnings : [];
  const messages = sortMessages(rejections, warnings);
  const first = [...urgent.values()].map((text) => ({ text, isWarning: false }));
  parameters.showMessages(messages);
  table.showMessages(messages);
  summary.showMessages([...first, ...messages.others, ...(staleness === null ? allAxes.messages : [])]);
  plots.showStale(staleness);
  summary.showStale(staleness !== null);
}

/** Whether what is plotted is the present design, and sound. */
function isDesignValid() {
  return staleness === null && answer !== null;
}

/** Samples are drawn once, however often devices are shown.
 * @param {import('./types.js').Samples | null} samples */
function showLive(samples) {
  if (samples === live) return;
  live = samples;
  plots.showLive(samples);
}

function showDevices() {
  devicePanel.showDevices(fleet.devices());
  const [chosen, axis] = [devicePanel.device(), devicePanel.axis()];
  if (workbench) {
    const { axes: designs, active } = workbench.state();
    const work = { isDesignValid: isDesignValid(), designs, active, units: memory.units() };
    devicePanel.show(fleet.situation(chosen, axis, work));
  }
  // The head of the page shows whatever moves, be it the chosen device or another.
  const moving = fleet.devices().find((device) => device.state === 'moving' || device.state === 'stopping');
  header.showDevice(moving ?? chosen, stop.isHaltNext(), fleet.isLive());
  const planned = answer ? Math.abs(Number(answer.design.move.steps)) : 0;
  plots.showMove(fleet.runningMove(moving ?? chosen, axis, planned));
  showLive(fleet.samples(moving ?? chosen, axis));
  showOutOfReach();
}

/** Whichever device is chosen: one that is out of reach may move. */
function showOutOfReach() {
  const text = outOfReach.words(fleet.devices(), stop.isStopped);
  if (text === (urgent.get('out of reach') ?? '')) return;
  if (text === '') urgent.delete('out of reach');
  else urgent.set('out of reach', text);
  showMessages();
}

function offerExamples() {
  const replaced = memory.replaced();
  header.showExamples(examples, replaced && replaced.axes[replaced.active].name);
}

function pressStop() {
  const pressed = stop.press();
  showDevices();
  pressed.then(showDevices);
}

/** @param {'undo' | 'redo'} step */
function stepHistory(step) {
  if (workbench?.[step]()) announce(step === 'undo' ? 'Undone' : 'Redone');
}

/** @param {string} text */
function announce(text) {
  part('announcements').textContent = text;
}

/** What nothing else on the page shows is shown for a while.
 * @param {string} text @param {boolean} hasFailed */
function tell(text, hasFailed) {
  announce(text);
  header.showNotice(text, hasFailed);
}

/** Ask the server for all that it knows: at the start, and when it is back. */
async function refresh() {
  try {
    ({ examples } = await api.examples());
  } catch {
    return; // It is asked again once the link to the server is back.
  }
  offerExamples();
  if (workbench !== null) compute();
  else if (examples.length > 0)
    begin({ axes: [examples[0].design], together: 'independent', active: 0, kept: null });
  fleet.refreshPorts();
}

// ---- keys ----

watchEscape(pressStop);
addEventListener(
  'keydown',
  (event) => {
    const step = historyKey(event);
    if (step === null) return;
    event.preventDefault();
    stepHistory(step);
  },
  { capture: true },
);
// A field that is left, a slider that is let go: what comes next is another change.
for (const end of ['focusout', 'pointerup']) addEventListener(end, () => workbench?.endGesture());
addEventListener('hashchange', opening.openAddress);
watchDrops({ present: () => design()?.name ?? '', onReading: opening.open });

// ---- the start ----

startTheme(() => plots.redraw());
showUnits(memory.units());
offerExamples();
const before = memory.state();
if (before) begin(before);
await opening.openAddress();
status.showServer('there');
status.showReading(null, '');
fleet.watch();
refresh();
