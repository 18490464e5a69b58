// @ts-check
// The wiring: what one panel reports is told to the others. Panels know no other panel.

import { api, Refusal, ServerGone } from './api.js';
import { calculate } from './calculation.js';
import { activeProfile } from './curves.js';
import { methodsToCompute, withMethod, withTable, withValue } from './design.js';
import { createFleet } from './fleet.js';
import { memory } from './memory.js';
import { sortMessages } from './messages.js';
import { SHOWN_AT_FIRST } from './methods.js';
import { newestWins } from './newest.js';
import { createDevice } from './panels/device/device.js';
import { createHeader } from './panels/header/header.js';
import { createParameters } from './panels/parameters/parameters.js';
import { createPlots } from './panels/plots/plots.js';
import { createStatus } from './panels/status/status.js';
import { createSummary } from './panels/summary/summary.js';
import { createTable } from './panels/table/table.js';
import { createTabs } from './panels/tabs/tabs.js';
import { createStop } from './stopping.js';
import { startTheme, switchTheme } from './theme.js';

/** @typedef {import('./types.js').Answer} Answer */
/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Example} Example */
/** @typedef {import('./types.js').MethodName} MethodName */

/** @param {string} id */
const part = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** @type {Design | null} */
let design = memory.design();
const shown = new Set(memory.shown() ?? SHOWN_AT_FIRST);
/** @type {Answer | null} */
let answer = null;
/** What was wrong with the newest design asked about. @type {import('./types.js').Rejection[]} */
let rejections = [];
/** @type {Example[]} */
let examples = [];
/** @type {import('./types.js').Staleness} */
let staleness = null;
let stopProblem = '';

const fleet = createFleet({
  onChange: showDevices,
  onPorts: (ports) => devicePanel.showPorts(ports),
  onRejected: (list) => devicePanel.showRejections(list),
  say: announce,
  onLink: (isThere) => {
    status.showServer(isThere);
    announce(isThere ? 'The server is back' : 'The server is gone');
    if (!isThere) return;
    stopProblem = '';
    refresh();
  },
});
const stop = createStop(fleet.devices, (text, hasFailed) => {
  stopProblem = hasFailed ? text : '';
  announce(text);
  showMessages();
  showDevices();
});
const header = createHeader(part('header'), {
  onName: (name) => design && edit({ ...design, name }),
  onExample: showExample,
  onBack: showReplaced,
  onStop: pressStop,
  onTheme: () => {
    switchTheme();
    plots.redraw();
  },
});
createTabs(part('tabs'));
const parameters = createParameters(part('parameters'), {
  onEdit: (path, value) => design && edit(withValue(design, path, value)),
  onMethod: (name) => design && edit(withMethod(design, name)),
  onSliding: (isMoving) => plots.showSliding(isMoving),
});
const summary = createSummary(part('summary'));
const status = createStatus(part('status'));
const plots = createPlots(part('figure'), shown, {
  onSwitch: switchMethod,
  onReading: (reading) => status.showReading(reading, answer?.design.method.name ?? ''),
});
const table = createTable(part('table'), (rows, unit) => design && edit(withTable(design, rows, unit)));
const devicePanel = createDevice(part('device'), {
  onRefresh: fleet.refreshPorts,
  onPort: showDevices,
  onConnect: fleet.connect,
  onDisconnect: fleet.disconnect,
  onMove: fleet.move,
  onPush: (device) => design && fleet.push(device, design),
});

const compute = newestWins(async () => {
  if (design === null) return;
  const asked = design;
  try {
    answer = await calculate(asked, methodsToCompute(asked, shown));
    rejections = [];
    staleness = null;
    plots.show(answer);
    summary.show(answer);
  } catch (error) {
    if (!(error instanceof Refusal || error instanceof ServerGone)) throw error;
    // Without an answer the same is asked again once the server is back.
    rejections = error instanceof Refusal ? error.rejections : [];
    staleness = error instanceof Refusal ? 'refused' : 'unanswered';
  }
  showMessages();
  showDevices();
});

/** @param {Design} changed */
function edit(changed) {
  // A method that is chosen is shown; it may be hidden again.
  if (changed.method.name !== design?.method.name) memory.keepShown(shown.add(changed.method.name));
  design = changed;
  status.showKept(memory.keepDesign(changed));
  showDesign(changed);
  showDevices();
  compute();
}

/** @param {MethodName} name */
function switchMethod(name) {
  if (!shown.delete(name)) shown.add(name);
  memory.keepShown(shown);
  plots.redraw();
  compute();
}

/** @param {Design} present */
function showDesign(present) {
  header.showName(present.name);
  parameters.show(present);
  table.show(present);
}

function showMessages() {
  const warnings = answer && staleness === null ? activeProfile(answer).warnings : [];
  const messages = sortMessages(rejections, warnings);
  const urgent = stopProblem === '' ? [] : [{ text: stopProblem, isWarning: false }];
  parameters.showMessages(messages);
  table.showMessages(messages);
  summary.showMessages([...urgent, ...messages.others]);
  plots.showStale(staleness);
  summary.showStale(staleness !== null);
}

/** Whether what is plotted is the present design, and sound. */
function isDesignValid() {
  return staleness === null && answer !== null;
}

function showDevices() {
  devicePanel.showDevices(fleet.devices());
  const chosen = devicePanel.device();
  if (design) devicePanel.show(fleet.situation(chosen, design, isDesignValid()));
  // The head of the page shows whatever moves, be it the chosen device or another.
  const moving = fleet.devices().find((device) => device.state === 'moving' || device.state === 'stopping');
  header.showDevice(moving ?? chosen, stop.isUnderWay());
  plots.showMove(fleet.runningMove(moving ?? chosen, answer ? Math.abs(Number(answer.design.move.steps)) : 0));
}

/** @param {Example} example */
function showExample(example) {
  const isOwn = design !== null && !examples.some((one) => JSON.stringify(one.design) === JSON.stringify(design));
  if (design && isOwn) memory.keepReplacedDesign(design);
  table.forget();
  edit(example.design);
  offerExamples();
}

function showReplaced() {
  const replaced = memory.replacedDesign();
  if (!replaced) return;
  table.forget();
  edit(replaced);
}

function offerExamples() {
  header.showExamples(examples, memory.replacedDesign()?.name ?? null);
}

function pressStop() {
  const pressed = stop.press();
  showDevices();
  pressed.then(showDevices);
}

/** @param {string} text */
function announce(text) {
  part('announcements').textContent = text;
}

/** Ask the server for all that it knows: at the start, and when it is back. */
async function refresh() {
  try {
    ({ examples } = await api.examples());
  } catch {
    return; // It is asked again once the link to the server is back.
  }
  offerExamples();
  if (design === null && examples.length > 0) edit(examples[0].design);
  else compute();
  fleet.refreshPorts();
}

startTheme(() => plots.redraw());
// Escape stops wherever the focus is; a key held down is one press.
addEventListener(
  'keydown',
  (event) => {
    if (event.key === 'Escape' && !event.repeat) pressStop();
  },
  { capture: true },
);
offerExamples();
if (design) showDesign(design);
status.showServer(true);
status.showReading(null, '');
status.showKept(true);
fleet.watch();
refresh();
