"""Both clients against a real server: the same methods, answers and refusals."""

from __future__ import annotations

import asyncio
import json
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import httpx2
import numpy as np
import pytest

import stepramp
from designs import design, document
from event_loop import run
from stepramp.client import AsyncClient, Client, design_calls, device_calls
from stepramp.client.calls import Call, Pause, get
from stepramp.client.clients import Requests
from stepramp.client.design_calls import stall_map
from stepramp.client.servers import Server
from stepramp.errors import (
    NoServer,
    NotFound,
    Outdated,
    Overloaded,
    Refused,
    Rejected,
    StepRampError,
    TooOften,
    Unauthorized,
)
from stepramp.http_api import idempotency
from stepramp.http_api.access import Access, Role
from stepramp.http_api.app import create_app
from stepramp.http_api.error_items import in_body
from stepramp.http_api.jobs_models import JobAnswer
from stepramp.http_api.stall_map_models import StartedAnswer
from stepramp.ramp.profile import profile_of

TOO_SLOW = {"ramp__acceleration_steps_per_s2": 0.001, "move__steps": 10_000_000}


def a_motor(**changes: Any) -> dict[str, Any]:
    preset = stepramp.MOTORS["NEMA 17 · 17HS19-2004S1"]
    return document(schema="stepramp/2", **changes) | {"motor": preset.motor.model_dump(), "drive": {"supply_v": 24}}


def test_a_profile_is_the_one_of_one_s_own_process(client: Any) -> None:
    answer = client.profile(design())
    own = profile_of(design())
    np.testing.assert_array_equal(answer.intervals_ticks, own.intervals_ticks)
    assert answer.summary.duration_s == own.duration_s
    assert len(client.profile(document(), max_points=50).step) < 100


def test_what_the_server_refuses_is_raised_as_in_one_s_own_process(client: Any) -> None:
    with pytest.raises(Rejected) as told:
        client.profile(document(**TOO_SLOW))
    with pytest.raises(Rejected) as own:
        profile_of(design(**TOO_SLOW))
    assert told.value.rejections == in_body(own.value).rejections


def test_what_can_t_be_sent_is_refused_with_field_value_and_what_is_allowed(client: Any) -> None:
    with pytest.raises(Rejected) as caught:
        client.fit(document(), rows=0)
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value, rejection.allowed) == ("rows", 0, "a whole number from 1 to 1,000 rows")
    with pytest.raises(Rejected, match=r"design.timer.frequency_hz is 0; allowed: a number from 1,000"):
        client.errors(document(timer__frequency_hz=0), ["newton"])


@pytest.mark.parametrize("key", ["ü\n", "", "a b", "a" * 201])
def test_a_key_that_no_server_takes_is_refused(client: Any, key: str) -> None:
    assert device_calls.MOST_KEY == idempotency.MOST_KEY
    with pytest.raises(Rejected, match="allowed: 1 to 200 visible ASCII characters"):
        client.move("1", axes=[{"axis": 0, "by_steps": 1}], key=key)


@pytest.mark.skipif(sys.platform == "win32", reason="files without an end of Unix")
def test_a_capture_without_an_end_is_refused(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(design_calls, "MOST_FILE_BYTES", 1000)
    with pytest.raises(Rejected, match=r"content is '/dev/zero'; allowed: a file of up to 1,000 bytes"):
        client.capture(Path("/dev/zero"))


def test_what_is_awaited_is_refused_as_it_is_awaited() -> None:
    """Whoever gathers several has the answers of the others."""

    async def gathered() -> list[Any]:
        transport = httpx2.MockTransport(lambda _: httpx2.Response(200, content=b"{}"))
        async with AsyncClient("http://a", transport=transport) as client:
            called = []
            for name in dir(Requests):
                method = getattr(client, name)
                if not name.startswith("_"):
                    # None of them takes that.
                    called.append(method(nothing=1))
            refused = await asyncio.gather(
                client.profile({"bad": 1}), client.run_for("1", 0, 0.0, 1.0), return_exceptions=True
            )
            assert [type(each) for each in refused] == [Rejected, Rejected]
            return await asyncio.gather(*called, return_exceptions=True)

    told = run(gathered())
    assert len(told) > 40
    assert {type(each) for each in told} == {TypeError}


def test_designs_are_computed_with(client: Any) -> None:
    assert [each.method for each in client.errors(document(), ["newton"]).methods] == ["newton"]
    assert client.fit(document(), rows=4).rows == 4
    assert client.play_table({"rows": [[10, 5000]]}, 100, [(0, 20)]).stops[0].position == 20
    assert client.schedule([document(), document(move__steps=100)], "line").leader == 0
    assert client.torque(a_motor(), [0, 300]).pull_out_nm[0] > 0
    assert client.simulate(a_motor(), with_proposals=False).verdict == "safe"
    assert b"#include" in client.export(document(), "c_newton")
    captured = b"Time [s],step\n" + b"".join(b"%.6f,%d\n" % (n * 0.001, n % 2) for n in range(20))
    assert client.capture(captured, document(), edge="rising").steps == 10


def test_a_job_is_awaited_and_told_of(client: Any) -> None:
    told: list[float] = []
    answer = client.stall_map(a_motor(), cells=8, tell=told.append)
    assert len(answer.verdicts) == 9
    assert not any(-1 in row for row in answer.verdicts)
    assert told == sorted(told)
    assert told[-1] == 1


@pytest.mark.parametrize("where", ["while asked", "in a pause", "to the end"])
def test_a_run_is_over_once_its_program_was_silent(monkeypatch: pytest.MonkeyPatch, where: str) -> None:
    """It is never begun a second time, and no renewal begins one."""
    now_s = [100.0]
    monkeypatch.setattr(device_calls, "monotonic", lambda: now_s[0])
    script = device_calls.run_for("1", 0, 400, 30, stops=7)
    begun = next(script)
    assert isinstance(begun, Call)
    assert json.loads(begun.body or b"")["renews"] is False
    now_s[0] += 5.0 if where == "while asked" else 0.0
    assert isinstance(script.send(SimpleNamespace()), Pause)
    if where != "while asked":
        now_s[0] += 0.5
        renewed = script.send(None)
        assert isinstance(renewed, Call)
        told = [json.loads(each.body or b"") for each in (begun, renewed)]
        assert [each["renews"] for each in told] == [False, True]
        assert told[0]["name"] == told[1]["name"] != ""
        assert isinstance(script.send(SimpleNamespace()), Pause)
        now_s[0] += 5.0 if where == "in a pause" else 60.0
    with pytest.raises(Refused, match=r"The run was given up, since this program was silent for (5|60) s"):
        script.send(None)


@pytest.mark.parametrize("for_s", [0.05, 0.3, 0.5, 0.501, 0.52, 1.0, 1.004, 1.7, 2.0, 2.3, 7.777, 30.1])
@pytest.mark.parametrize("answer_s", [0.0, 0.013, 0.2])
def test_a_run_is_held_to_its_end_and_never_renewed_as_it_ends(
    monkeypatch: pytest.MonkeyPatch, for_s: float, answer_s: float
) -> None:
    now_s = [1000.0]
    monkeypatch.setattr(device_calls, "monotonic", lambda: now_s[0])
    script = device_calls.run_for("1", 0, 400, for_s, stops=7)
    step, held_until_s = next(script), 0.0
    while isinstance(step, Pause) or step.path.endswith("/run"):
        if isinstance(step, Pause):
            now_s[0] += step.pause_s
            step = script.send(None)
        else:
            lease_s = json.loads(step.body or b"")["for_s"]
            # A renewal comes well before what it renews runs out.
            assert held_until_s == 0 or now_s[0] + answer_s < held_until_s - 0.2
            held_until_s = now_s[0] + lease_s
            now_s[0] += answer_s
            step = script.send(SimpleNamespace())
    assert held_until_s == pytest.approx(1000 + for_s)
    assert now_s[0] >= 1000 + for_s - 1e-6


@pytest.mark.parametrize("refusal", [TooOften("Too often."), Overloaded("Too much.")])
@pytest.mark.parametrize("for_s", [0.7, 1.2, 2.3, 2.9, 9.0])
@pytest.mark.parametrize("times", [1, 2, 3, 100])
def test_a_renewal_that_is_refused_for_now_is_asked_for_again_while_the_run_lasts(
    monkeypatch: pytest.MonkeyPatch, refusal: StepRampError, for_s: float, times: int
) -> None:
    """It is told to have lasted only when it did."""
    now_s, begun_s = [1000.0], 1000.0
    monkeypatch.setattr(device_calls, "monotonic", lambda: now_s[0])
    script = device_calls.run_for("1", 0, 400, for_s, stops=7)
    with pytest.raises(type(refusal)):
        next(script) and script.throw(refusal)
    script = device_calls.run_for("1", 0, 400, for_s, stops=7)
    step, held_until_s, refused = next(script), 0.0, 0
    try:
        while isinstance(step, Pause) or step.path.endswith("/run"):
            if isinstance(step, Pause):
                now_s[0] += step.pause_s
                step = script.send(None)
            elif held_until_s > 0 and refused < times:
                refused += 1
                step = script.throw(refusal)
            else:
                assert held_until_s == 0 or now_s[0] <= held_until_s, "what has slowed down isn't renewed"
                held_until_s = now_s[0] + json.loads(step.body or b"")["for_s"]
                step = script.send(SimpleNamespace())
        assert held_until_s == pytest.approx(begun_s + for_s)
    except type(refusal):
        assert times == 100
        assert now_s[0] <= held_until_s < begun_s + for_s


@pytest.mark.parametrize("refusal", [TooOften("Too often."), Overloaded("Too much.")])
def test_who_is_asked_too_much_is_asked_again_until_what_moves_rests(
    monkeypatch: pytest.MonkeyPatch, refusal: StepRampError
) -> None:
    now_s = [100.0]
    monkeypatch.setattr(device_calls, "monotonic", lambda: now_s[0])
    script = device_calls.until_rest("1", within_s=3)
    asked = next(script)
    for _ in range(2):
        assert script.throw(refusal) == Pause(0.5)
        assert script.send(None) == asked
    with pytest.raises(StopIteration) as end:
        script.send(SimpleNamespace(state="ready", shuttle=None))
    assert end.value.value.state == "ready"
    script = device_calls.until_rest("1", within_s=3)
    next(script)
    now_s[0] += 3.1
    with pytest.raises(type(refusal)):
        script.throw(refusal)


def test_a_job_whose_client_gives_up_is_cancelled() -> None:
    script = stall_map(a_motor(), cells=8)
    asked = next(script)
    assert isinstance(asked, Call)
    assert (asked.method, asked.path) == ("POST", "motor/map")
    assert script.send(StartedAnswer(id="7")) == get("jobs/7", JobAnswer)
    cancelled = script.throw(KeyboardInterrupt())
    assert isinstance(cancelled, Call)
    assert (cancelled.method, cancelled.path) == ("DELETE", "jobs/7")
    with pytest.raises(KeyboardInterrupt):
        script.send(None)


def test_a_device_from_connecting_to_letting_go(client: Any) -> None:
    device = client.connect("sim://").id
    try:
        assert [each.id for each in client.devices().devices] == [device]
        wanted = document(ramp__slew_speed_steps_per_s=500)
        assert client.preview_push(device, wanted).segments == client.preview_push(device, axes=[wanted]).segments
        pushed = client.push(device, axes=[wanted], mode="try")
        assert client.preview_push(device, wanted).same
        assert (pushed.verified, pushed.kept) == (True, False)
        assert client.keep(device).on_trial is False
        client.trace_moves(device)
        before = client.device(device).position_steps
        assert client.move(device, by_steps=100).state == "moving"
        with pytest.raises(Refused):
            client.push(device, document())
        assert client.until_rest(device).position_steps == before + 100
        assert client.trace(device).step == list(range(1, 101))
        rested = client.run_for(device, 0, 400, 0.2)
        assert (rested.state, rested.position_steps > before + 100) == ("ready", True)
        client.move(device, by_steps=1_000_000)
        stopped = client.stop(device)
        assert stopped.stops > rested.stops
        client.halt(device, [0])
        assert client.until_rest(device).state == "ready"
        assert [each.id for each in client.stop_all().devices] == [device]
    finally:
        client.until_rest(device)
        client.disconnect(device)
    with pytest.raises(NotFound, match="There is no device"):
        client.device(device)


def test_motions_are_waited_for_and_made_once_for_a_key(client: Any) -> None:
    device = client.connect("sim://").id
    try:
        for _ in range(2):
            assert client.push(device, document(ramp__slew_speed_steps_per_s=2000), key=f"push-{device}").verified
        begin = client.device(device).position_steps
        for _ in range(3):
            assert client.move(device, by_steps=100, wait_s=60, key=f"move-{device}").state == "ready"
        assert client.device(device).position_steps == begin + 100
        line = client.line(device, [{"axis": 0, "by_steps": -40}], wait_s=60)
        assert line.position_steps == begin + 60
        assert client.there_and_back(device, 30, times=2, wait_s=60).position_steps == begin + 60
        limits = [{"axis": 0, "lowest_steps": begin, "highest_steps": begin + 100}]
        assert client.set_soft_limits(device, limits).axes[0].highest_steps == begin + 100
        with pytest.raises(Rejected, match=r"by_steps is 41"):
            client.move(device, by_steps=41)
        with pytest.raises(Rejected, match="a key of its own for each request"):
            client.line(device, [{"axis": 0, "by_steps": 1}], key=f"move-{device}")
        with pytest.raises(StepRampError, match="steps is 0; allowed: a whole number from 1 to 65,535 steps"):
            client.zero(device, 0)
    finally:
        client.set_soft_limits(device, [{"axis": 0}])
        client.disconnect(device)


def test_what_runs_is_not_set_in_motion_again_after_a_stop(client: Any, url: str) -> None:
    device = client.connect("sim://").id
    client.push(device, document())

    def stop_once(_: object) -> None:
        with Client(url) as other:
            other.stop(device)

    with pytest.raises(Refused):
        client.run_for(device, 0, 400, 3.0, tell=stop_once)
    client.until_rest(device)
    client.disconnect(device)


def test_the_library_s_designs(client: Any) -> None:
    kept = client.add_design(document(), name="Stage", tags=["gauge"])
    assert kept.id in [each.id for each in client.search_designs("stage", ["gauge"]).designs]
    newer = client.save_revision(kept.id, kept.version, document(move__steps=7), note="shorter")
    with pytest.raises(Outdated):
        client.save_revision(kept.id, kept.version, document())
    [difference] = client.differences(kept.id, 1, 2).differences
    assert (difference.field, difference.before, difference.after) == ("move.steps", 2000, 7)
    assert client.describe_design(kept.id, newer.version, "Axis").name == "Axis"
    assert client.revision(kept.id, 2).design["move"] == {"steps": 7}
    assert client.duplicate_design(kept.id, "Copy").id != kept.id
    assert [each.number for each in client.kept_design(kept.id).history] == [2, 1]


def test_a_token_is_shown() -> None:
    access = Access({Role.OPERATE: "o" * 24, Role.VIEW: "v" * 24})
    transport = httpx2.ASGITransport(create_app(access=access))

    async def asked(token: str | None) -> int:
        async with AsyncClient(server=Server("http://shop.local", token), transport=transport) as client:
            return len((await client.devices()).devices)

    assert run(asked("v" * 24)) == 0
    with pytest.raises(Unauthorized, match="wants a token"):
        run(asked(None))


def test_what_is_no_stepramp_is_told() -> None:
    transport = httpx2.MockTransport(lambda _: httpx2.Response(200, content=json.dumps({"status": "fine"})))
    with Client("http://127.0.0.1:1", transport=transport) as client, pytest.raises(NoServer, match="no StepRamp"):
        client.health()
    with Client("http://127.0.0.1:1") as client, pytest.raises(NoServer, match="No server answers at"):
        client.health()
    with pytest.raises(Rejected, match="url is 'ftp://x'; allowed: the address of a server"):
        Client("ftp://x")
