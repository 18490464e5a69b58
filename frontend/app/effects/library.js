// @ts-check
// What goes to and comes from the library: designs are opened from it and saved in it, what was measured is kept in it, and
// revisions are laid beside the design in hand. Nothing of a motor, and nothing of what is in hand, waits for it.

import { readDocument } from '../../documents/documents.js';
import { areEqual } from '../../model/equal.js';
import { RECORD_NAMES, thinnedTrace } from '../../model/library.js';
import { quoted } from '../../model/quoted.js';
import { MOST_AXES } from '../../model/workbench.js';
import { CHANGED_MEANWHILE, isForLater, Refusal, ServerGone } from '../../server/api.js';
import { calculate, NO_DETAILS } from '../../server/calculation.js';
import { library } from '../../server/library.js';
import { besideCame, layBeside, link, relink } from '../commands/library.js';
import { tell } from '../commands/told.js';
import { addAxis, openInPlace } from '../commands/work.js';
import { linkOf } from '../library.js';
import { axisOf, designOf, machineOf } from '../selectors.js';
import { whenChanged } from '../state.js';
import { createQuestion } from './question.js';

/** @typedef {import('../../model/library.js').About} About */
/** @typedef {import('../../model/library.js').Kept} Kept */
/** @typedef {import('../../model/library.js').KeptWithRevisions} KeptWithRevisions */
/** @typedef {import('../../model/library.js').Link} Link */
/** @typedef {import('../../model/library.js').RecordKind} RecordKind */
/** @typedef {import('../../model/types.js').Answer} Answer */
/** @typedef {import('../../model/types.js').Design} Design */
/** What somebody wants to save: an axis by its id, its design, and the revision that it began with.
 * @typedef {{axis: number, design: Design, linked: Link | null}} Mine */
/** Where a design is opened to: in the place of all that is in hand, of the axis in hand, or as another axis.
 * @typedef {'all' | 'axis' | 'beside'} Where */

/** @param {number} count */
const thousands = (count) => count.toLocaleString('en-US');

/** @param {import('../state.js').Store} store
 * @param {Pick<ReturnType<typeof import('./opening.js').createDocuments>, 'openWork' | 'replacing'>} documents
 * @param {typeof library} [ask] @param {typeof calculate} [compute] */
export function createLibrary({ state, dispatch, subscribe }, documents, ask = library, compute = calculate) {
  /** A design as the page has it; a Refusal where it can't be read here.
   * @param {unknown} content */
  function readDesign(content) {
    const { document, problem } = readDocument(JSON.stringify(content));
    if (document === null) throw new Refusal(0, [{ field: 'design', value: null, allowed: null, message: problem ?? '' }]);
    return document.axes[0];
  }

  /** @param {Design} design @param {Where} where */
  function put(design, where) {
    if (where === 'all' || machineOf(state()) === null) documents.openWork({ axes: [design], together: 'independent' });
    else if (where === 'axis') documents.replacing(() => dispatch(openInPlace, design));
    else dispatch(addAxis, design);
  }

  /** The axis in hand is a revision from now on.
   * @param {Kept} kept @param {number} number @param {Design} design */
  function linkInHand({ id, name, version }, number, design) {
    const axis = axisOf(state());
    if (axis !== null) dispatch(link, axis, { id, name, number, version, design });
  }

  /** Save the design of an axis, which is a revision of it from now on.
   * @param {number} axis its id @param {Design} design @param {() => Promise<Kept>} save */
  async function saved(axis, design, save) {
    const kept = await save();
    dispatch(link, axis, { id: kept.id, name: kept.name, number: kept.revisions, version: kept.version, design });
    return kept;
  }

  /** What is to be saved, which may not be in hand by then: its axis as it is now; as it was, where the axis is gone.
   * @param {Mine} mine @returns {Mine} */
  function present(mine) {
    const machine = machineOf(state());
    const place = machine?.ids.indexOf(mine.axis) ?? -1;
    return machine === null || place < 0 ? mine : { axis: mine.axis, design: machine.axes[place], linked: state().library.links[mine.axis] ?? null };
  }

  /** The axis in hand, its design, and the revision that it began with.
   * @returns {Mine} */
  function inHand() {
    const [axis, design] = [axisOf(state()), designOf(state())];
    if (axis === null || design === null) throw new Refusal(0, [{ field: null, value: null, allowed: null, message: 'There is no design in hand yet.' }]);
    return { axis, design, linked: linkOf(state()) };
  }

  /** The revision that a design is: the one it began with while it is as that, else one that is saved for it.
   * @param {number} axis its id @param {Design} design @param {RecordKind} kind what needs it
   * @returns {Promise<{id: string, name: string, number: number, isNew: boolean}>} */
  async function revisionFor(axis, design, kind) {
    const linked = state().library.links[axis];
    if (linked && areEqual(linked.design, design)) return { ...linked, isNew: false };
    const note = `Saved with a ${RECORD_NAMES[kind].toLowerCase()}`;
    const kept = await saved(axis, design, () =>
      linked ? ask.save(linked.id, linked.version, design, note) : ask.add(design, { name: design.name || 'unnamed', notes: '', tags: [], note }),
    );
    return { id: kept.id, name: kept.name, number: kept.revisions, isNew: true };
  }

  /** @param {Design} design @param {AbortSignal} ended @returns {Promise<Answer | null>} null: the server refuses it */
  async function curvesOf(design, ended) {
    try {
      return await compute(design, [design.method.name], { ...NO_DETAILS, motion: true }, ended);
    } catch (error) {
      if (!(error instanceof Refusal) || isForLater(error)) throw error;
      return null;
    }
  }

  const curves = createQuestion({
    ask: (/** @type {{key: string, design: Design}[]} */ wanted, ended) =>
      Promise.all(wanted.map(async ({ key, design }) => /** @type {[string, Answer | null]} */ ([key, await curvesOf(design, ended)]))),
    take: (came) => dispatch(besideCame, Object.fromEntries(came)),
    refuse: ({ message }) => dispatch(tell, message, true),
  });
  subscribe(
    whenChanged(
      ({ library: { beside } }) => [beside.map(({ key }) => key).join('\n')],
      (_) => {
        const lacking = state().library.beside.filter((one) => one.curves === null);
        if (lacking.length > 0) curves.want(lacking);
      },
      state(),
    ),
  );
  subscribe(whenChanged(({ devices: { link: there } }) => [there], (there) => there === 'there' && curves.again()));

  return {
    /** @param {Kept} kept @param {number} number of its revision @param {Where} where */
    async openRevision(kept, number, where) {
      const design = readDesign((await ask.revision(kept.id, number)).design);
      put(design, where);
      linkInHand(kept, number, design);
      dispatch(tell, `Opened from the library: ${quoted(kept.name)}, revision ${number}.`, false);
    },
    /** Open what was pushed: an axis for each design. Where the library has the same, the axis is that revision.
     * @param {string} id of the push */
    async openPush(id) {
      const { designs, axes, device, pushed_at: at } = await ask.push(id);
      const read = designs.slice(0, MOST_AXES).map(({ design }) => readDesign(design));
      const same = axes.slice(0, MOST_AXES).map(({ revisions: [newest] }) => newest ?? null);
      const kept = await Promise.all(same.map((one) => one && ask.design(one.design_id)));
      documents.openWork({ axes: read, together: 'independent' });
      const ids = machineOf(state())?.ids ?? [];
      for (const [index, one] of kept.entries()) {
        if (one) dispatch(link, ids[index], { id: one.id, name: one.name, number: same[index]?.number ?? 1, version: one.version, design: read[index] });
      }
      return { device, at };
    },
    inHand,
    /** Save a design as a new one of the library.
     * @param {Mine} mine @param {About & {note: string}} about */
    async saveNew(mine, about) {
      const { axis, design } = present(mine);
      return saved(axis, design, () => ask.add(design, about));
    },
    /** Save a design as another revision of the one that it began with.
     * @param {Mine} mine @param {string} note @param {Kept} [seen] the newest that a person has seen, if not that it began with
     * @returns {Promise<{kept: Kept} | {conflict: KeptWithRevisions}>} conflict: somebody else changed it meanwhile */
    async saveRevision(mine, note, seen) {
      const { axis, design, linked } = present(mine);
      const of = seen ?? linked;
      if (of === null) return { kept: await this.saveNew(mine, { name: design.name || 'unnamed', notes: '', tags: [], note }) };
      try {
        return { kept: await saved(axis, design, () => ask.save(of.id, of.version, design, note)) };
      } catch (error) {
        if (!(error instanceof Refusal) || error.status !== CHANGED_MEANWHILE) throw error;
        const newest = await ask.design(of.id);
        const { design: theirs } = await ask.revision(of.id, newest.revisions);
        // The answer to one's own save may have been lost, as by a reload: nobody else was quicker then.
        return areEqual(readDesign(theirs), readDesign(design)) ? { kept: await saved(axis, design, async () => newest) } : { conflict: newest };
      }
    },
    /** What is known of a design anew: axes that began with it follow where it is only described otherwise.
     * @param {Kept} kept @param {number} before its version then */
    described(kept, before) {
      for (const [axis, known] of Object.entries(state().library.links)) {
        if (known.id === kept.id && known.version === before) dispatch(relink, Number(axis), { name: kept.name, version: kept.version });
      }
    },
    /** Lay a revision beside the design in hand; the label of the one that gave way to it, null where none did.
     * @param {Kept} kept @param {number} number @returns {Promise<string | null>} */
    async pin(kept, number) {
      const { design } = await ask.revision(kept.id, number);
      const before = state().library.beside;
      dispatch(layBeside, { key: `${kept.id} ${number}`, label: `${kept.name}, revision ${number}`, design: readDesign(design) });
      return before.find(({ key }) => !state().library.beside.some((one) => one.key === key))?.label ?? null;
    },
    readDesign,
    /** Keep what was measured or computed of a design with it; told in words, whatever comes of it.
     * @param {RecordKind} kind @param {object} document @param {{axis: number | null, design: Design | null, note?: string}} of null: in hand */
    async keepRecord(kind, document, { axis, design, note = '' }) {
      const what = RECORD_NAMES[kind];
      try {
        const present = inHand();
        const { id, name, number, isNew } = await revisionFor(axis ?? present.axis, design ?? present.design, kind);
        const kept = kind === 'trace' ? thinnedTrace(document) : document;
        await ask.keepRecord(id, { revision: number, kind, note, document: kept });
        const part = kept === document ? '' : ` Of its ${thousands(/** @type {any} */ (document).step.length)} steps ${thousands(kept.step.length)} are kept, evenly apart.`;
        dispatch(tell, `${what} kept in the library with ${quoted(name)}, revision ${number}${isNew ? ', which was saved for it' : ''}.${part}`, false);
      } catch (error) {
        if (!(error instanceof Refusal || error instanceof ServerGone)) throw error;
        const isOthers = error instanceof Refusal && error.status === CHANGED_MEANWHILE;
        const why = isOthers ? 'Somebody else has changed its design in the library meanwhile: save yours in the library first.' : error.message;
        dispatch(tell, `${what} not kept in the library: ${why}`, true);
      }
    },
  };
}

/** @typedef {ReturnType<typeof createLibrary>} LibraryActions */
