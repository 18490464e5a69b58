from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from designs import document


def ask(client: TestClient, commands: list[dict[str, Any]], **more: Any) -> Any:
    return client.post("/api/v1/retarget", json={"design": document(), "commands": commands, **more})


def test_the_steps_of_targets_that_change_in_flight(client: TestClient) -> None:
    answer = ask(client, [{"at_s": 0, "target_steps": 50}, {"at_s": 0.05, "speed_steps_per_s": 0}]).json()
    assert answer["timer_hz"] == 2_000_000
    plan = client.post("/api/v1/profile", json={"design": document(move__steps=50)}).json()["intervals_ticks"]
    # Up to the instant of the second command it is the move of 50 steps; then it slows down.
    before = sum(at <= 100_000 for at in answer["at_ticks"])
    assert answer["at_ticks"][:before] == [sum(plan[:step]) for step in range(before)]
    assert answer["position_steps"] == list(range(1, len(answer["at_ticks"]) + 1))
    [rest] = answer["rests"]
    assert rest["position_steps"] == len(answer["at_ticks"]) < 50
    assert rest["at_s"] > answer["at_ticks"][-1] / 2_000_000
    assert answer["interval_ticks"][:-1] == np.diff(answer["at_ticks"]).tolist()
    assert answer["interval_ticks"][-1] == round(rest["at_s"] * 2_000_000) - answer["at_ticks"][-1]
    assert answer["told_position_steps"] == [0, before]


def test_as_many_points_as_are_wanted_with_every_turn(client: TestClient) -> None:
    there_and_back = [{"at_s": at_s, "target_steps": 20_000 * (at_s % 2)} for at_s in range(30)]
    commands = [*there_and_back, {"at_s": 100, "target_steps": 50_000}, {"at_s": 200, "target_steps": 0}]
    whole, thinned = ask(client, commands).json(), ask(client, commands, max_points=100).json()
    step = {at: place for place, at in enumerate(whole["at_ticks"])}
    kept = [step[at] for at in thinned["at_ticks"]]
    turns = np.flatnonzero(np.diff(whole["direction"]))
    assert len(turns) == 28 + 1  # of the 28 commands after the one that sets out, and on the way home
    assert {*turns.tolist(), *(turns + 1).tolist()} <= set(kept)
    assert 100 <= len(kept) < 250
    assert len(step) > 100_000
    assert max(thinned["position_steps"]) == max(whole["position_steps"])
    for name in ("interval_ticks", "position_steps", "direction"):
        assert thinned[name] == [whole[name][place] for place in kept]
    # At rest from one command to the next: that is no interval.
    assert max(whole["interval_ticks"]) < 2_000_000
    assert (thinned["rests"], thinned["told_position_steps"]) == (whole["rests"], whole["told_position_steps"])


@pytest.mark.parametrize(
    ("commands", "field", "allowed"),
    [
        ([], "commands", "a list of 1 to 10,000 commands"),
        ([{"at_s": 0}], "commands.0.target_steps", "a target or speed_steps_per_s, one of them"),
        ([{"at_s": 0, "target_steps": 1, "speed_steps_per_s": 0}], "commands.0.target_steps", "a target or speed_ste"),
        ([{"at_s": -1, "target_steps": 1}], "commands.0.at_s", "a number from 0 to 1,000,000 s"),
        ([{"at_s": 1, "target_steps": 1}, {"at_s": 0.5, "target_steps": 2}], "commands.1.at_s", "at least 1 s, when"),
        ([{"at_s": 0, "target_steps": 1e9}], "commands.0.target_steps", "a whole number from -10,000,000 to"),
        (
            [{"at_s": 0, "speed_steps_per_s": 1e-300}],
            "commands.0.speed_steps_per_s",
            "0, or from 0.001 to 1,000,000 st",
        ),
        ([{"at_s": 0, "speed_steps_per_s": 10}], "commands.0.speed_steps_per_s", "0 in the last command, or a target"),
    ],
)
def test_what_is_wrong_is_named(client: TestClient, commands: list[Any], field: str, allowed: str) -> None:
    answer = ask(client, commands)
    assert answer.status_code == 422
    [error] = answer.json()["errors"]
    assert error["field"] == field
    assert allowed in error["allowed"]
