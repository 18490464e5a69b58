"""The three examples, pushed through the HTTP API and a serial port to the real firmware, judged by its pin edges."""

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


def moves_of(example: dict[str, Any]) -> list[int]:
    """Return moves that reach slew speed, one each way, and short ones that don't."""
    steps = example["design"]["move"]["steps"]
    return [steps, -steps, 61, -2, 1]


@pytest.mark.parametrize("example", all_examples(), ids=lambda example: example["title"])
def test_every_edge_of_a_move_comes_when_the_profile_says(
    server: ServerProcess, controller: SimulatedController, example: dict[str, Any], record_property: Any
) -> None:
    design = example["design"]
    device = server.ask("POST", "devices", {"port": controller.port})["id"]
    pushed = server.ask("POST", f"devices/{device}/push", {"design": design})
    assert pushed["verified"]
    moves, position = moves_of(example), 0
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
        plan = server.ask("POST", "profile", {"design": {**design, "move": {"steps": steps}}})
        predicted = np.array(plan["intervals_ticks"][:-1]) / design["timer"]["frequency_hz"]
        deviation = np.abs(np.diff(made) / CYCLES_PER_S - predicted)
        largest = max(largest, float(deviation.max(initial=0)))
    record_property("largest_deviation_us", largest * 1e6)
    print(f"\n{example['title']}: the largest deviation of an interval is {largest * 1e6:.3f} µs")
    assert largest <= TOLERANCE_S
