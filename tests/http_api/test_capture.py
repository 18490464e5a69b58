"""Captured files over HTTP."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from capture.writers import instants_of, pulses, saleae_csv, vcd
from designs import design, document
from stepramp.http_api import bodies
from stepramp.ramp.profile import profile_of

NAMES = ("Step", "Dir")
TYPE = {"content-type": "application/octet-stream"}
INSTANTS = [each // 2 for each in instants_of(profile_of(design()).intervals_ticks, 2000)]
"""[µs]; rounded down from half microseconds."""
PATIENCE_S = 120
PLAYED = vcd(pulses(INSTANTS, 5), NAMES).encode()


def ask(client: TestClient, content: bytes | Iterator[bytes], **wanted: Any) -> Any:
    if "design" in wanted:
        wanted["design"] = json.dumps(wanted["design"])
    return client.post("/api/v1/capture", content=content, params=wanted, headers=TYPE)


def answer_of(client: TestClient, content: bytes, **wanted: Any) -> dict[str, Any]:
    answered = ask(client, content, **wanted)
    assert answered.status_code == 200, answered.text
    return answered.json()  # type: ignore[no-any-return]


def refusal(answered: Any, status: int = 422) -> dict[str, Any]:
    assert answered.status_code == status, answered.text
    return answered.json()["errors"][0]  # type: ignore[no-any-return]


def test_a_move_without_a_design(client: TestClient) -> None:
    found = answer_of(client, saleae_csv([*pulses([100, 150, 175], 4), (10, 1, 1)], NAMES).encode())
    assert found["format"] == "saleae_csv"
    assert found["channels"] == [{"name": "Step", "edges": 6}, {"name": "Dir", "edges": 1}]
    assert (found["step_channel"], found["direction_channel"], found["edge"]) == ("Step", "Dir", "rising")
    assert (found["steps"], found["move_count"], found["sample_rate_hz"]) == (3, 1, None)
    assert found["longest_wait_us"] == 200_000
    listed = {"move": 1, "steps": 3, "begin_s": 0.0001, "duration_s": 0.000075, "direction_level": 1}
    assert found["moves"] == [listed]
    move = found["move"]
    assert {name: move[name] for name in listed} == pytest.approx(listed)
    assert move["step"] == [1, 2, 3]
    assert move["time_s"] == pytest.approx([0, 0.00005, 0.000075])
    assert move["interval_us"] == [pytest.approx(50), pytest.approx(25), None]
    assert move["speed_steps_per_s"] == [pytest.approx(20_000), pytest.approx(40_000), None]
    assert (move["short_pulses"], move["deviation"]) == (None, None)


def test_a_move_next_to_its_design(client: TestClient) -> None:
    made = sorted({*INSTANTS} - {INSTANTS[700]} | {INSTANTS[900] + 300})
    content = vcd(pulses(made, 5), NAMES).encode()
    move = answer_of(client, content, design=document(), shortest_pulse_us=5.5, max_points="null")["move"]
    deviation = move["deviation"]
    assert (deviation["planned_steps"], deviation["matched_steps"]) == (2000, 1999)
    # The last wait is in neither: no capture shows where it ends.
    assert (move["duration_s"], deviation["planned_duration_s"]) == (
        pytest.approx((INSTANTS[-1] - INSTANTS[0]) / 1e6),
        pytest.approx(profile_of(design()).intervals_ticks[:-1].sum() / 2e6),
    )
    assert (deviation["missing"]["count"], deviation["missing"]["step"]) == (1, [701])
    assert (deviation["extra"]["count"], deviation["extra"]["step"]) == (1, [901])
    assert deviation["planned_step"][899:902] == [901, 0, 902]
    assert deviation["deviation_us"][900] is None
    planned_us = np.array(INSTANTS) - INSTANTS[0]
    late = planned_us - profile_of(design()).time_s * 1e6
    assert deviation["deviation_us"][:700] == pytest.approx(late[:700], abs=1e-6)
    assert deviation["figures"]["largest_us"] == pytest.approx(0.5)
    assert deviation["figures"]["mean_us"] == pytest.approx(np.delete(late, 700).mean(), abs=1e-6)
    assert deviation["figures"]["rms_us"] == pytest.approx(np.sqrt((np.delete(late, 700) ** 2).mean()), abs=1e-6)
    assert move["short_pulses"]["count"] == 2000
    assert len(move["short_pulses"]["step"]) == 1000
    assert set(move["short_pulses"]["pulse_us"]) == {5.0}


def test_best_fit_and_thinning(client: TestClient) -> None:
    found = answer_of(client, PLAYED, design=document(), alignment="best_fit", max_points=200)["move"]
    assert found["deviation"]["figures"]["mean_us"] == pytest.approx(0, abs=1e-6)
    assert 100 < len(found["step"]) < 400
    assert (found["step"][0], found["step"][-1]) == (1, 2000)
    assert {len(found[name]) for name in ("time_s", "interval_us", "speed_steps_per_s")} == {len(found["step"])}
    assert len(found["deviation"]["deviation_us"]) == len(found["step"])


@pytest.mark.parametrize(
    ("wanted", "field", "told"),
    [
        ({"shortest_pulse_us": -1}, "shortest_pulse_us", "is -1; allowed: a number from 0 to 1,000,000 µs."),
        ({"shortest_pulse_us": "short"}, "shortest_pulse_us", "is 'short'; allowed: a number"),
        ({"shortest_pulse_us": "nan"}, "shortest_pulse_us", "allowed: a number"),
        ({"shortest_pulse_us": "inf"}, "shortest_pulse_us", "is 'inf'; allowed: a number"),
        ({"shortest_pulse_us": "1e999"}, "shortest_pulse_us", "is '1e999'; allowed: a number"),
        ({"shortest_pulse_us": ""}, "shortest_pulse_us", "is ''; allowed: a number"),
        ({"shortest_pulse_us": " 5"}, "shortest_pulse_us", "is ' 5'; allowed: a number"),
        ({"shortest_pulse_us": "1_000"}, "shortest_pulse_us", "is '1_000'; allowed: a number"),
        ({"shortest_pulse_us": "\uff15"}, "shortest_pulse_us", "is '\uff15'; allowed: a number"),
        ({"longest_wait_us": "9" * 5000}, "longest_wait_us", "allowed: a number from 1 to"),
        ({"max_points": "1_000"}, "max_points", "is '1_000'; allowed: a whole number from 10"),
        ({"move_number": "\u0661"}, "move_number", "is '\u0661'; allowed: a whole number"),
        ({"edge": ["rising", "falling"]}, "edge", 'is ["rising", "falling"]; allowed: one value, given once.'),
        ({"longest_wait_us": 0}, "longest_wait_us", "allowed: a number from 1 to"),
        ({"max_points": 1}, "max_points", "allowed: a whole number from 10"),
        ({"move_number": 2}, "move_number", "a whole number from 1 to 1"),
        ({"move_number": 1.5}, "move_number", "allowed: a whole number"),
        ({"edge": "up"}, "edge", "allowed: rising, falling, both"),
        ({"alignment": "middle"}, "alignment", "allowed: first_step, best_fit"),
        ({"step_channel": "X"}, "step_channel", "one of the file's channels: Step, Dir"),
        ({"direction_channel": "Step"}, "direction_channel", "another channel than the step channel, or none"),
        ({"channel": "Step"}, "channel", "there is no such field"),
        ({"design": document(move__steps=0)}, "design.move.steps", "but not 0"),
        ({"design": document(method__name="table", table=None)}, "design.table", "a table"),
    ],
)  # fmt: skip
def test_refused_parameters(client: TestClient, wanted: dict[str, Any], field: str, told: str) -> None:
    item = refusal(ask(client, PLAYED, **wanted))
    assert item["field"] == field
    assert told in item["message"]


def test_plain_numbers_are_taken(client: TestClient) -> None:
    found = answer_of(client, PLAYED, longest_wait_us="2.5e5", move_number="1e0", max_points="1000")
    assert (found["longest_wait_us"], found["move"]["move"]) == (250_000, 1)


def test_refused_files(client: TestClient) -> None:
    assert refusal(ask(client, b""))["field"] == "file"
    assert (
        "Line 202 of the file has the level '?'; allowed: 0, 1"
        in refusal(ask(client, b"Time [s],A\n" + b"0,1\n" * 200 + b"1,?\n"))["message"]
    )
    design_text = client.post("/api/v1/capture", content=PLAYED, params={"design": "{"}, headers=TYPE)
    assert refusal(design_text)["field"] == "design"
    twice = client.post("/api/v1/capture", content=PLAYED, params={"design": '{"own": 1, "own": 2}'}, headers=TYPE)
    assert refusal(twice)["message"] == "design.own is [1, 2]; allowed: one value, given once."


def test_another_type(client: TestClient) -> None:
    answered = client.post("/api/v1/capture", files={"file": ("a.csv", b"0,1")})
    assert "allowed: application/octet-stream" in refusal(answered, 415)["message"]


def test_a_file_that_is_too_large(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is taken to its end, since browsers show no earlier answer, unless that is far too much."""
    monkeypatch.setattr(bodies, "MOST_FILE_BYTES", 100_000)
    monkeypatch.setattr(bodies, "MOST_TAKEN_BYTES", 400_000)
    sent: list[int] = []

    def parts(count: int) -> Iterator[bytes]:
        sent.clear()
        for number in range(count):
            sent.append(number)
            yield bytes(10_000)

    for count in (11, 40, 50):
        assert "allowed: up to 100,000 bytes" in refusal(ask(client, parts(count)), 413)["message"]
        assert len(sent) == count
    assert ask(client, parts(10)).status_code == 422


def test_files_are_read_one_at_a_time_and_keep_nobody_waiting(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    from stepramp.http_api import capture

    begun, go_on, together = threading.Semaphore(0), threading.Event(), []
    read = capture.read_file

    def slow(content: bytes) -> Any:
        together.append(1)
        begun.release()
        assert go_on.wait(PATIENCE_S)
        recording = read(content)
        together.pop()
        return recording

    monkeypatch.setattr(capture, "read_file", slow)
    asking = [threading.Thread(target=ask, args=(client, PLAYED)) for _ in range(3)]
    for each in asking:
        each.start()
    assert begun.acquire(timeout=PATIENCE_S)
    assert client.post("/api/v1/profile", json={"design": document(), "max_points": 10}).status_code == 200
    assert client.post("/api/v1/devices/stop").status_code == 200
    assert len(together) == 1
    go_on.set()
    for each in asking:
        each.join()


def test_a_trace_is_read_again_as_a_capture(client: TestClient) -> None:
    device = f"/api/v1/devices/{client.post('/api/v1/devices', json={'port': 'sim://'}).json()['id']}"
    assert "No move has been traced" in refusal(client.get(f"{device}/trace.csv"), 409)["message"]
    small = document(move__steps=200)
    assert client.post(f"{device}/push", json={"design": small}).status_code == 200
    client.put(f"{device}/trace", json={"traced_axis": 0, "every_steps": 1})
    assert client.post(f"{device}/move", json={"by_steps": 200}).status_code == 200
    _wait_for_rest(client, device)
    saved = client.get(f"{device}/trace.csv")
    assert saved.headers["content-type"].startswith("text/csv")
    found = answer_of(client, saved.content, design=small)
    assert (found["edge"], found["steps"], found["move_count"]) == ("both", 200, 1)
    figures = found["move"]["deviation"]["figures"]
    assert figures["largest_us"] == pytest.approx(0, abs=1e-6)
    client.put(f"{device}/trace", json={"traced_axis": 0, "every_steps": 2})
    client.post(f"{device}/move", json={"by_steps": -200})
    _wait_for_rest(client, device)
    lacking = refusal(client.get(f"{device}/trace.csv"), 409)
    assert "lacks 99 of its first 199 steps" in lacking["message"]


def _wait_for_rest(client: TestClient, device: str) -> None:
    for _ in range(2000):
        if client.get(f"{device}/trace").json().get("complete"):
            return
        threading.Event().wait(0.05)
    raise AssertionError("The move doesn't end.")
