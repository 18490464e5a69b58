"""The three examples and ramps of other shapes, pushed to the real firmware and judged by its pin edges.

They go through the HTTP API and a serial port.
"""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from server_process import ServerProcess
from simulator.avr import SimulatedController, build_firmware, missing_tools
from stepramp.examples import all_examples
from tools import require

CYCLES_PER_S = 16_000_000
STEP_PIN, DIRECTION_PIN = 2, 5
TOLERANCE_S = 2e-6


@pytest.fixture(scope="module")
def server() -> Iterator[ServerProcess]:
    with ServerProcess(8700) as server:
        yield server


@pytest.fixture
def controller(tmp_path: Path) -> Iterator[SimulatedController]:
    require(*missing_tools())
    with SimulatedController(build_firmware(), tmp_path) as controller:
        yield controller


def wait_until_ready(server: ServerProcess, device: str) -> dict[str, Any]:
    for _ in range(600):
        state = server.ask("GET", f"devices/{device}")
        if state["state"] == "ready":
            return state
        time.sleep(0.05)
    raise AssertionError(f"still {state['state']} after 30 s")


def rising_edges(edges: np.ndarray, pin: int) -> np.ndarray:
    return edges["cycle"][(edges["pin"] == pin) & (edges["value"] == 1)]


def direction_at(edges: np.ndarray, cycle: int) -> int:
    before = edges[(edges["pin"] == DIRECTION_PIN) & (edges["cycle"] < cycle)]
    return int(before["value"][-1]) if before.size else 0


def both_ways(design: dict[str, Any]) -> list[int]:
    """Return moves that reach slew speed, one each way, and short ones that don't."""
    steps = design["move"]["steps"]
    return [steps, -steps, 61, -2, 1]


def stage(shape: dict[str, Any], **move: Any) -> dict[str, Any]:
    """Return the design of a stage whose ramp has a shape."""
    ramp = {"slew_speed_steps_per_s": 4000, "acceleration_steps_per_s2": 20_000, "deceleration_steps_per_s2": 30_000}
    return {
        "schema": "stepramp/2",
        "timer": {"frequency_hz": 2_000_000},
        "ramp": {**ramp, "shape": shape},
        "move": move,
    }


S_CURVE = {"name": "s_curve", "jerk_steps_per_s3": 200_000, "deceleration_jerk_steps_per_s3": 500_000}
DRAWN = {"name": "drawn", "points": [[0, 0.6], [1000, 1], [4000, 0.2]]}
SHAPED = {
    "S-curve, short moves cut out of it": stage(S_CURVE, steps=2500, plan="any_move"),
    "cosine, short moves cut out of it": stage({"name": "cosine"}, steps=2500, plan="any_move"),
    "drawn": stage(DRAWN, steps=4000),
}
PLAYED = [
    *((each["title"], each["design"], both_ways(each["design"])) for each in all_examples()),
    *((title, design, both_ways(design)) for title, design in SHAPED.items()),
    ("S-curve planned for a short move", stage(S_CURVE, steps=300), [300, -300]),
]


@pytest.mark.parametrize(("title", "design", "moves"), PLAYED, ids=[title for title, *_ in PLAYED])
def test_every_edge_of_a_move_comes_when_the_profile_says(
    server: ServerProcess,
    controller: SimulatedController,
    title: str,
    design: dict[str, Any],
    moves: list[int],
    record_property: Any,
) -> None:
    device = server.ask("POST", "devices", {"port": controller.port})["id"]
    pushed = server.ask("POST", f"devices/{device}/push", {"design": design})
    assert pushed["verified"]
    position = 0
    for steps in moves:
        server.ask("POST", f"devices/{device}/move", {"by_steps": steps})
        position += steps
        assert wait_until_ready(server, device)["position_steps"] == position
    server.ask("DELETE", f"devices/{device}")
    controller.stop()

    edges = controller.edges()
    pulses = rising_edges(edges, STEP_PIN)
    assert pulses.size == sum(map(abs, moves))
    largest = 0.0
    for steps in moves:
        made, pulses = pulses[: abs(steps)], pulses[abs(steps) :]
        assert {direction_at(edges, cycle) for cycle in made} == {int(steps > 0)}
        plan = server.ask("POST", "profile", {"design": {**design, "move": {**design["move"], "steps": steps}}})
        predicted = np.array(plan["intervals_ticks"][:-1]) / design["timer"]["frequency_hz"]
        deviation = np.abs(np.diff(made) / CYCLES_PER_S - predicted)
        largest = max(largest, float(deviation.max(initial=0)))
    record_property("largest_deviation_us", largest * 1e6)
    print(f"\n{title}: the largest deviation of an interval is {largest * 1e6:.3f} µs")
    assert largest <= TOLERANCE_S
