"""What the panel for changes in flight asks, and asks again, without a browser."""

from designs import document
from frontend.dialogs import NOBODY, run
from frontend.modules import Modules


def test_what_is_told_in_flight_is_asked_for_again_and_follows_the_design(modules: Modules) -> None:
    first, then, asked = run(
        modules,
        """const {createFlight} = await import('/panels/flight/flight.js');
        const {createStore, FIRST_STATE} = await import('/app/state.js');
        const {COMMANDS: {work, device}} = await import('/app/commands/commands.js');
        const asked = [];
        let answer = gone;
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        const panel = createFlight((play) => { asked.push([play.design.name, play.commands]); return answer(); });
        store.subscribe(panel.show);
        store.dispatch(work.begin, {axes: [design], together: 'independent'});
        await settled();
        panel.open(); await settled();
        const first = textOf(byId('flight-result'));
        answer = async () => ({timer_hz: 1000, at_ticks: [0], interval_ticks: [100], position_steps: [1],
            direction: [1], rests: [{at_s: 0.1, position_steps: 1}], told_position_steps: [0, 1]});
        store.dispatch(device.linked, 'gone'); store.dispatch(device.linked, 'there'); await settled(); await settled();
        const then = textOf(byId('flight-result'));
        store.dispatch(work.setName, 'Other'); await settled();
        byId('flight-dialog').close(); store.dispatch(work.setName, 'Another'); await settled();
        return [first, then, asked];""",
    )
    assert NOBODY in first
    assert "At rest at 1 step after 100.0 ms" in then
    proposed = [{"at_s": 0, "target_steps": document()["move"]["steps"]}, {"at_s": 0.5, "target_steps": 0}]
    assert asked == [[name, proposed] for name in (document()["name"], document()["name"], "Other")]
