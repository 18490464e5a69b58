"""Where rows of tables come from, without a page."""

from designs import document
from frontend.modules import Modules


def test_fits_of_rows_that_can_not_come_back_are_forgotten(modules: Modules) -> None:
    script = """async ([design, other]) => {
        const {createOrigins} = await import('/panels/table/origins.js');
        const origins = createOrigins();
        const isKnown = () => origins.staleWish(other) !== null;
        origins.note(design.table, design, null);
        const seen = [isKnown()];
        origins.prune([null, design.table]);
        seen.push(isKnown());
        origins.prune([null]);
        return [...seen, isKnown()]; }"""
    changed = document(ramp__acceleration_steps_per_s2=1234)
    assert modules.evaluate(script, [document(), changed]) == [True, True, False]
