"""The dialog that plays a table, without a browser."""

from frontend.dialogs import NOBODY, run
from frontend.modules import Modules


def test_what_is_played_is_asked_for_again_and_follows_the_axis_that_it_was_opened_for(modules: Modules) -> None:
    first, then, asked = run(
        modules,
        """const {createPlayDialog} = await import('/panels/table/play_dialog.js');
        const asked = [];
        let answer = gone;
        const dialog = createPlayDialog((request) => { asked.push(request.table.rows[0][1]); return answer(); });
        const tabled = (delay) => ({...design, table: {rows: [[1, delay]], interval_unit: 'us'}});
        dialog.open(tabled(900), 3); await settled();
        const first = textOf(byId('play-result'));
        answer = async () => ({stops: [{at_us: 1000, position: 7}], steps: {position: [1], at_us: [1]}});
        dialog.again(); await settled();
        const then = textOf(byId('play-result'));
        dialog.show(tabled(800), 3); dialog.show(tabled(700), 4); await settled();
        const removed = {...design, table: null};
        dialog.show(removed, 3); await settled();
        return [first, then, [...asked, textOf(byId('play-result'))]];""",
    )
    assert NOBODY in first
    assert "At rest at step 7" in then
    assert asked[:3] == [900, 900, 800]
    assert "no table" in asked[3]
    assert len(asked) == 4, "another axis is not played"
