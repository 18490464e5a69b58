// @ts-check
// The page: creates the store, what goes on by itself, and the panels, and connects them. A panel gets `show(state)`,
// `dispatch` and what can be asked for; it knows no other panel.

import { createJog } from '../devices/jogging.js';
import { forgetOldTabs, openTab } from '../documents/tab.js';
import { createAxes } from '../panels/axes/axes.js';
import { createCapture } from '../panels/capture/capture.js';
import { createDevice } from '../panels/device/device.js';
import { createBackups } from '../panels/backups/backups.js';
import { createExport } from '../panels/export/export.js';
import { createFlight } from '../panels/flight/flight.js';
import { createGuide } from '../panels/guide/guide.js';
import { createHeader } from '../panels/header/header.js';
import { createLibraryPanel } from '../panels/library/library.js';
import { createMotorDialogs } from '../panels/motor/motor.js';
import { createOffer } from '../panels/offer/offer.js';
import { createParameters } from '../panels/parameters/parameters.js';
import { createPlots } from '../panels/plots/plots.js';
import { createAnnouncements } from '../panels/status/announcements.js';
import { createStatus } from '../panels/status/status.js';
import { createSummary } from '../panels/summary/summary.js';
import { createTable } from '../panels/table/table.js';
import { createTabs } from '../panels/tabs/tabs.js';
import { api } from '../server/api.js';
import { createGestures } from '../server/gestures.js';
import { refused } from './commands/device.js';
import { begin } from './commands/work.js';
import { askForAccess } from './effects/access.js';
import { watchAges } from './effects/ages.js';
import { rememberedState, saveByItself } from './effects/autosave.js';
import { askForBeside } from './effects/beside.js';
import { askForCapture } from './effects/capture.js';
import { askForCurves } from './effects/curves.js';
import { createDeviceActions } from './effects/device_actions.js';
import { createDeviceNews } from './effects/device_news.js';
import { watchErrors } from './effects/errors.js';
import { askForExamples } from './effects/examples.js';
import { guideFirstVisit } from './effects/guide.js';
import { watchKeys } from './effects/keys.js';
import { createDocuments } from './effects/opening.js';
import { watchOtherTabs } from './effects/other_tabs.js';
import { createLibrary } from './effects/library.js';
import { askForMotor } from './effects/motor.js';
import { askForOwnRamp } from './effects/own_ramp.js';
import { askForPreviews } from './effects/previews.js';
import { createStallMaps } from './effects/stall_maps.js';
import { createStopping } from './effects/stop.js';
import { createTheme } from './effects/theme.js';
import { createStore, whenChanged } from './state.js';

/** @param {string} id */
const part = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

// Ids of axes that no tab has given yet: a design that is in two tabs is known by them.
const firstId = crypto.getRandomValues(new Uint32Array(1))[0] * 2 ** 20;
const tab = await openTab();
const store = createStore(rememberedState(tab, firstId), (error) => errors.show(error));
const { dispatch, subscribe } = store;
const errors = watchErrors(store);

// What asks the server comes before the panels: the server works while they are brought up to date.
askForCurves(store);
askForBeside(store);
askForMotor(store);
askForOwnRamp(store);
const capture = askForCapture(store);
const previews = askForPreviews(store);
saveByItself(store, tab.id);

// ---- devices ----

const gestures = createGestures();
const jog = createJog(gestures, (rejections) => dispatch(refused, rejections));
/** @type {Map<string, import('./state.js').TracedMove>} */
const traced = new Map();

/** End what is on its way to set motors moving: nothing more of it is sent. */
function endMotions() {
  gestures.end();
  jog.end();
  previews.forget();
}

askForAccess(store);
watchAges(store);
const devices = createDeviceActions(store, gestures, traced, previews);
const { stop } = createStopping(store, endMotions, gestures.hear);
const news = createDeviceNews(store, gestures, traced, { endJog: jog.end, endMotions });
const keys = watchKeys(store, stop);
const documents = createDocuments(store);
const library = createLibrary(store, documents);
const theme = createTheme(store);

// ---- panels ----

const exporting = createExport(store);
const backups = createBackups(store, devices);
const flight = createFlight(api.playInFlight, dispatch);
const motor = createMotorDialogs(dispatch, { ...createStallMaps(store, tab.id), ...library });
const librarian = createLibraryPanel(store, { ...library, openBackups: backups.open, openMap: motor.openMapOver });
const panels = [
  createHeader(part('header'), dispatch, { ...keys, ...documents, ...theme, stop, openExport: exporting.open, openBackups: backups.open, openLibrary: librarian.open }),
  createTabs(part('tabs'), dispatch),
  createGuide(part('guide'), dispatch, { openExport: exporting.open, saveFile: documents.saveFile }),
  createOffer(part('offer'), dispatch, documents),
  createAxes(part('axes'), dispatch),
  createParameters(part('parameters'), dispatch, { ...motor, openFlight: flight.open }),
  createSummary(part('summary'), dispatch),
  createPlots(part('figure'), dispatch),
  createTable(part('table'), dispatch, api),
  createDevice(part('device'), dispatch, { ...devices, jog, ...library }),
  createCapture(dispatch, { ...documents, ...capture, ...library }),
  createStatus(part('status')),
  createAnnouncements(part('announcements')),
  exporting,
  backups,
  librarian,
  flight,
  motor,
];
for (const panel of panels) subscribe(panel.show);

// ---- the start ----

if (tab.record) dispatch(begin, tab.record.machine);
await documents.openAddress();
guideFirstVisit(store);
// Panels of which nothing is known yet are shown too.
for (const panel of panels) panel.show(store.state());
news.watch();
askForExamples(store);
forgetOldTabs().then(() => watchOtherTabs(store, tab.id));
subscribe(whenChanged(({ devices: { link } }) => [link], (link) => link === 'there' && devices.refreshPorts(), store.state()));
devices.refreshPorts();
