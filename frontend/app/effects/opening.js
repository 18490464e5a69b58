// @ts-check
// Documents that come and go: files, links, examples.

import { openCaptureFile, openFile, saveFile, watchDrops, watchPastes } from '../../documents/files.js';
import { createOpening } from '../../documents/opening.js';
import { shareLink } from '../../documents/sharing.js';
import { unnamed } from '../../model/design.js';
import { remarksOf } from '../../model/imported.js';
import { duplicateOf } from '../../model/workbench.js';
import { api, Refusal, ServerGone } from '../../server/api.js';
import { openCapture } from '../commands/capture.js';
import { setAside, showLink, showTableText, tell, urge } from '../commands/told.js';
import { open } from '../commands/work.js';
import { isAllKept } from '../library.js';
import { designOf, isOwnWork, machineOf } from '../selectors.js';
import { whenever } from '../state.js';

/** @typedef {import('../../model/workbench.js').Work} Work */

/** @param {import('../state.js').Store} store */
export function createDocuments({ state, dispatch, subscribe }) {
  const opening = createOpening({
    state: () => machineOf(state()),
    // What is a revision of the library is there, and takes the place of nothing that is nowhere else.
    isOwn: () => isOwnWork(state()) && !isAllKept(state()),
    aside: () => state().replaced,
    putAside: (machine) => dispatch(setAside, machine),
    put: (work) => dispatch(open, work),
    tell(text, hasFailed) {
      dispatch(tell, text, hasFailed);
      if (hasFailed) dispatch(urge, 'opening', text);
    },
  });
  /** What is in hand, as it is saved and shared.
   * @param {(work: Work) => void} act */
  function withWork(act) {
    const machine = machineOf(state());
    if (machine) act({ axes: machine.axes, together: machine.together });
  }

  /** What is in hand, or was brought: what comes back later must not take the place of something newer.
   * @param {import('../state.js').State} now */
  const present = (now) => [machineOf(now), now.capture?.file, now.told.tableText];
  // What could not be opened is over once something else is done.
  subscribe(whenever(present, () => dispatch(urge, 'opening', ''), state()));
  const onCapture = (/** @type {File} */ file) => dispatch(openCapture, file);
  /** The listings that were brought so far. */
  let listings = 0;
  /** Designs of what a controller lists of itself take the place of what is in hand, which says what it doesn't.
   * @param {string} text */
  async function openSettings(text) {
    const [before, listing] = [present(state()), (listings += 1)];
    try {
      const { family, axes } = await api.importText(text, designOf(state()));
      if (listing !== listings) return;
      if (present(state()).some((one, index) => one !== before[index])) {
        dispatch(tell, 'The settings were not opened, since something else was opened or changed meanwhile: bring them again.', true);
        return;
      }
      const title = state().devices.families.find(({ name }) => name === family)?.title ?? family;
      const document = { axes: axes.map(({ design }) => design), together: /** @type {const} */ ('independent') };
      opening.open({ document, problem: null }, `the settings of ${title}`, remarksOf(axes, state().units));
    } catch (error) {
      if (!(error instanceof Refusal || error instanceof ServerGone)) throw error;
      opening.open({ document: null, problem: error.message }, 'the settings');
    }
  }

  const takers = { onDocument: opening.open, onTable: (/** @type {string} */ text) => dispatch(showTableText, text), onCapture, onSettings: openSettings };
  watchPastes(takers);
  addEventListener('hashchange', opening.openAddress);
  watchDrops(() => designOf(state())?.name ?? '', takers);

  return {
    openAddress: opening.openAddress,
    goBack: opening.goBack,
    /** @param {Work} work such as an example's */
    openWork: opening.replace,
    replacing: opening.replacing,
    /** An unnamed design as at first; nothing happens until the examples are there. */
    startNew() {
      const [first] = state().examples;
      if (first) opening.replace({ axes: [unnamed(first.design)], together: 'independent' });
    },
    duplicate: () => withWork((work) => opening.replace(duplicateOf(work))),
    openFile: () => openFile(takers),
    openCaptureFile: () => openCaptureFile(onCapture),
    saveFile: () => withWork((work) => dispatch(tell, `Saved as ${saveFile(work)}`, false)),
    shareLink: () =>
      withWork((work) =>
        shareLink(work, {
          tell: (text, hasFailed) => dispatch(tell, text, hasFailed),
          showLink: (link) => dispatch(showLink, link),
        }),
      ),
  };
}
