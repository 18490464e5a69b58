"""Notices without a browser: what stays, and until when."""

from frontend.dialogs import run
from frontend.modules import Modules


def test_a_fault_of_the_page_stays_until_it_is_closed(modules: Modules) -> None:
    seen = run(
        modules,
        """const {createNotice} = await import('/panels/header/notice.js');
        const {watchErrors} = await import('/app/effects/errors.js');
        const {createStore, FIRST_STATE, whenChanged} = await import('/app/state.js');
        const {tell, closeFault} = await import('/app/commands/told.js');
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        const notice = createNotice(() => store.dispatch(closeFault));
        store.subscribe(whenChanged(({told}) => [told.notice],
            (told) => told && notice.show(told.text, told.hasFailed)));
        store.subscribe(whenChanged(({told}) => [told.fault], notice.showFault));
        const look = () => [notice.element.hidden ? '' : textOf(notice.element).trim(), notice.element['aria-hidden']];
        const seen = [];
        store.dispatch(tell, 'Saved', false); seen.push(look()); pass(); seen.push(look());
        const log = console.error; console.error = () => {};
        watchErrors(store).show(new Error('broken')); console.error = log;
        pass(); seen.push(look());
        store.dispatch(tell, 'Saved again', false); seen.push(look()); pass(); seen.push(look());
        find(notice.element, ({tag}) => tag === 'button').onclick(); seen.push(look());
        return seen;""",
    )
    fault = "Something went wrong in the page: broken. Your design is kept; reload the page if anything looks odd."
    assert seen[0] == ["Saved", "true"]
    assert seen[1][0] == ""
    assert seen[2] == [fault, "false"], "and it can be closed by those who don't see it"
    assert [text for text, _ in seen[3:]] == ["Saved again", fault, ""]


def test_what_takes_long_to_read_is_shown_for_longer(modules: Modules) -> None:
    waits = run(
        modules,
        """const {createNotice} = await import('/panels/header/notice.js');
        const notice = createNotice(() => {}), waits = [];
        const own = globalThis.setTimeout;
        globalThis.setTimeout = (_, ms) => waits.push(ms);
        try { for (const text of ['Saved', 'x'.repeat(500)]) notice.show(text, false); }
        finally { globalThis.setTimeout = own; }
        return waits;""",
    )
    assert waits == [6000, 35_000]
