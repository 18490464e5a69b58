"""Orders to a motor in flight."""

from hypothesis import strategies as st

from firmware.motion import OK, Machine, StoredRamp

orders = st.lists(
    st.tuples(
        st.sampled_from(["move", "run", "stop", "halt"]),
        st.integers(-200, 200),
        st.integers(0, 40_000),
    ),
    min_size=1,
    max_size=6,
)


def give_order(machine: Machine, order: str, value: int, ramp: StoredRamp) -> None:
    """Move to a position, run, or stop or halt."""
    if order == "move":
        assert machine.move(value) == (OK, 0)
    elif order == "run":
        interval = ramp.slew + 20 * abs(value)
        assert machine.ask("run", 1, interval if value >= 0 else -interval) == (OK, 0)
    else:
        machine.do(order, 1)
