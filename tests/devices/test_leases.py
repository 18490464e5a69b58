"""Leases, without which no run goes on."""

from __future__ import annotations

import time
from contextlib import suppress
from itertools import product
from typing import Any

import pytest

from designs import design
from devices.bench import MOTIONS, Bench, by, run
from devices.motion import wait_for
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp import tracing
from stepramp.controllers.stepramp.messages.motion import RunRequest, StopRequest
from stepramp.controllers.stepramp.messages.settings import ReadSettingsRequest
from stepramp.devices.leases import JOG_S, Lease, Leases
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState
from stepramp.errors import Refused, StepRampError

ENDS = ("lapses", "stopped", "moved", "run by another")


def test_a_lease_runs_out_and_is_not_brought_back() -> None:
    lease = Lease({0: 400.0})
    assert lease.renew()
    time.sleep(JOG_S + 0.05)
    assert not lease.holds
    assert not lease.renew()
    ended = Lease({0: 400.0})
    ended.end()
    assert not ended.renew()


def test_a_jog_that_was_let_go_of_before_it_began(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    device.push([design()])
    lease = Lease({0: 400.0})
    device.end_run(lease)
    with pytest.raises(Refused, match="before it began"):
        device.run([AxisCommand(0, 400.0, "speed_steps_per_s")], lease)
    assert device.view.state is DeviceState.READY


@pytest.mark.parametrize("lost", [0, 1, 2])
def test_a_jog_that_is_let_go_of_while_it_sets_out(bench: Bench, lost: int) -> None:
    """Wherever that is, also between a run whose answer was lost and its repetition: none is sent from then on but what
    is on its way, and a stop comes after that."""
    place, moved = 0, 0
    while let_go_at(bench, place, lost):
        seen = bench.witness.seen
        bench.poll()
        if RunRequest.KIND in seen:
            moved += 1
            assert StopRequest.KIND in seen[len(seen) - seen[::-1].index(RunRequest.KIND) :], place
        place += 1
    assert place > moved > 0


def let_go_at(bench: Bench, place: int, lost: int) -> bool:
    """Begin a jog, and let go of it where its port's thread gives way for that time; return whether it came to that."""
    bench.reset()
    bench.witness.unanswered[RunRequest.KIND] = lost
    lease = Lease({0: 400.0}, 1e6)
    sent_before: list[int] = []

    def let_go() -> None:
        bench.device.end_run(lease)
        sent_before.append(bench.witness.seen.count(RunRequest.KIND))

    bench.places.choose(place, let_go)
    with suppress(StepRampError):
        bench.device.run([AxisCommand(0, 400.0, "speed_steps_per_s")], lease)
    bench.places.chosen = None
    bench.witness.unanswered.clear()
    assert bench.witness.seen.count(RunRequest.KIND) - (sent_before or [lost])[0] <= 1, place
    return bool(sent_before)


def test_a_jog_that_nobody_renews_slows_down(devices: Devices, port: str) -> None:
    device = devices.connect(port)
    device.push([design()])
    device.run([AxisCommand(0, 400.0, "speed_steps_per_s")], Lease({0: 400.0}))
    wait_for(device, DeviceState.READY)
    position = device.view.position_steps
    # 400 steps/s for 0.4 s, and what it takes to slow down: 16 steps with 5,000 steps/s².
    assert 20 < position < 400
    time.sleep(0.3)
    assert device.view.position_steps == position


def test_a_run_goes_on_for_as_long_as_its_lease_holds(devices: Devices, port: str) -> None:
    """The controller ends a run that nobody asks about for 1.3 s."""
    device = devices.connect(port)
    device.push([design()])
    device.run([AxisCommand(0, 100.0, "speed_steps_per_s")], Lease({0: 100.0}, 60))
    time.sleep(3.0)
    assert device.view.state is DeviceState.MOVING
    assert device.view.position_steps > 200
    device.stop()
    wait_for(device, DeviceState.READY)


@pytest.mark.parametrize(
    ("ends", "when"),
    # The thread of the port does motions one after the other: none comes in the midst.
    [*product(ENDS, ("before", "after")), ("lapses", "in the midst"), ("stopped", "in the midst")],
)
def test_a_renewal_begins_nothing_whenever_the_lease_ends(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, ends: str, when: str
) -> None:
    bench.reset()
    lease = Lease({0: 400.0}, 1e6, name="mine")
    bench.device.run([AxisCommand(0, 400.0, "speed_steps_per_s")], lease)

    def end() -> None:
        if ends == "lapses":
            lease.end()
        elif ends == "stopped":
            bench.device.stop()
        elif ends == "moved":
            bench.device.move_to([AxisCommand(0, 10, "to_steps")])
        else:
            bench.device.run([AxisCommand(0, 300.0, "speed_steps_per_s")], Lease({0: 300.0}, 1e6, name="other"))

    def renew() -> None:
        bench.device.renew_run(Lease({0: 400.0}, 1e6, name="mine"))

    if when == "in the midst":
        held_by = Leases.named

        def named(*asked: Any) -> Lease | None:
            held = held_by(*asked)
            end()
            return held

        with monkeypatch.context() as patch, suppress(Refused):
            patch.setattr(Leases, "named", named)
            renew()
    elif when == "before":
        end()
    else:
        renew()
        end()
    begun = [kind for kind in bench.witness.seen if kind in MOTIONS]
    bench.poll()
    with pytest.raises(Refused):
        renew()
    bench.poll()
    assert [kind for kind in bench.witness.seen if kind in MOTIONS] == begun
    if ends in ("lapses", "stopped"):
        assert StopRequest.KIND in bench.witness.seen


def test_what_was_refused_takes_no_lease_away(bench: Bench) -> None:
    """A move that is refused must not let a run go on for ever."""
    bench.reset()
    lease = Lease({0: 400.0}, 1e6)
    bench.device.run([AxisCommand(0, 400.0, "speed_steps_per_s")], lease)
    with pytest.raises(StepRampError):
        bench.device.move_by([by(2**40)])
    with pytest.raises(StepRampError):
        bench.device.run([AxisCommand(0, 5e5, "speed_steps_per_s")], Lease({0: 5e5}, 1e6))
    lease.end()
    bench.poll()
    assert bench.witness.seen[-1] not in MOTIONS
    assert StopRequest.KIND in bench.witness.seen


def test_a_lease_of_one_axis_outlives_a_move_of_another(bench: Bench) -> None:
    bench.reset()
    lease = Lease({0: 400.0}, 1e6)
    bench.device.run([AxisCommand(0, 400.0, "speed_steps_per_s")], lease)
    bench.device.move_by([by(60, 1)])
    lease.end()
    bench.poll()
    assert StopRequest.KIND in bench.witness.seen
    bench.settle()


def test_a_run_s_lease_ends_while_answers_are_lost(bench: Bench) -> None:
    bench.reset()
    lease = Lease({0: 400.0}, 1e6)
    bench.device.run([AxisCommand(0, 400.0, "speed_steps_per_s")], lease)
    bench.witness.seen.clear()
    bench.witness.unanswered[ReadSettingsRequest.KIND] = 3
    lease.end()
    bench.device.settings()
    assert bench.witness.seen[:2] == [StopRequest.KIND, ReadSettingsRequest.KIND]
    assert bench.witness.seen.count(StopRequest.KIND) == 1


def test_a_mistake_after_a_run_was_granted_lets_it_not_run_on(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """It has no lease yet that would end it."""
    bench.reset()

    def fail(*_: object) -> None:
        raise ZeroDivisionError("a mistake of ours")

    monkeypatch.setattr(tracing.Tracing, "runs", fail)
    with pytest.raises(ZeroDivisionError):
        run(bench, bench.devices.order.next())
    sent = bench.witness.seen
    assert StopRequest.KIND in sent[sent.index(RunRequest.KIND) :]
    bench.look()
    assert bench.device.view.axes[0].state is not DeviceState.MOVING
