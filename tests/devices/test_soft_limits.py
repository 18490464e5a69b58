"""Soft limits: what is kept to them, and what becomes of them when a device is lost or let go of."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pytest

from controllers.conftest import Clock
from controllers.grbl.emulator import GrblEmulator
from controllers.marlin.emulator import MarlinEmulator
from controllers.tic.emulator import TicEmulator
from controllers.tmcl.emulator import RESOLUTION, TmclEmulator
from designs import design
from devices.bench import MOTIONS, Bench, by, push
from devices.boards import WAITED_FOR_S, UnpluggedAt
from devices.motion import PATIENCE_S
from stepramp.controllers.contract import Activity, AxisCommand, AxisStatus, ControllerStatus
from stepramp.controllers.stepramp.messages.motion import ZeroRequest
from stepramp.controllers.stepramp.messages.session import HelloRequest
from stepramp.controllers.stepramp.messages.settings import ReadSettingsRequest
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices import attachment, limit_checks, setting_out, watch
from stepramp.devices import registry as devices_module
from stepramp.devices.backups import Source, unmarked
from stepramp.devices.leases import Lease
from stepramp.devices.registry import Devices
from stepramp.devices.shuttle import Shuttle
from stepramp.devices.soft_limits import FREE, Span
from stepramp.devices.view import DeviceState, DeviceView
from stepramp.errors import DeviceLost, Refused, Rejected
from stepramp.link.ports import Port


def held(bench: Bench, *calls: Callable[[], object]) -> list[Future[object]]:
    """Let calls wait for the port's thread, one after the other, and return what comes of them."""
    with ThreadPoolExecutor(1 + len(calls)) as pool:
        begun, go_on = threading.Event(), threading.Event()
        pool.submit(bench.worker.call, lambda: (begun.set(), go_on.wait(PATIENCE_S)))
        assert begun.wait(PATIENCE_S)
        results = []
        for count, call in enumerate(calls, 1):
            results.append(pool.submit(call))
            while len(bench.worker._waiting) < count and not results[-1].done():
                time.sleep(0.001)
        go_on.set()
    return results


def test_limits_that_were_answered_hold_for_a_zero_that_was_asked_before(bench: Bench) -> None:
    bench.reset()
    limited, zeroed = held(bench, lambda: bench.device.limit({0: Span(-10, 1000)}), lambda: bench.device.zero([0], 900))
    assert limited.result() is None
    with pytest.raises(Rejected, match="axes without soft limits"):
        zeroed.result()
    assert ZeroRequest.KIND not in bench.witness.seen
    bench.device.limit({0: FREE})


def test_a_run_keeps_to_soft_limits_while_answers_are_lost(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever is asked just then, and is answered only after the third repeat: the run is looked after meanwhile."""
    for module in (watch, limit_checks, setting_out):
        monkeypatch.setattr(module, "monotonic", bench.clock)
    reached = []
    for polls in range(20, 90, 5):
        bench.reset()
        bench.device.limit({0: Span(None, 1500)})
        bench.device.run([AxisCommand(0, 900.0, "speed_steps_per_s")], Lease({0: 900.0}, 1e6))
        for _ in range(polls):
            bench.clock.now_s += 0.02
            bench.poll()
        bench.witness.unanswered[ReadSettingsRequest.KIND] = 3
        bench.device.settings()
        for _ in range(200):
            bench.clock.now_s += 0.02
            bench.poll()
        assert bench.device.view.state is DeviceState.READY
        reached.append(bench.device.view.position_steps)
    bench.device.limit({0: FREE})
    assert max(reached) <= 1500
    # It is looked again 0.2 s later at most: no run ends much further away from the limit than it needs to.
    assert min(reached) > 1500 - 900 * (0.5 + WAITED_FOR_S)


def test_a_refused_run_names_the_fastest_that_is_not_refused(bench: Bench) -> None:
    """At 300 of 400 steps 100 are left, which 0.5 s and slowing down along a ramp take at less than 200 steps/s."""
    bench.reset()
    bench.device.set_position([AxisCommand(0, 300, "position_steps")])
    bench.device.limit({0: Span(None, 400)})

    def run(speed_steps_per_s: float) -> None:
        command = AxisCommand(0, speed_steps_per_s, "axes.0.speed_steps_per_s")
        bench.device.run([command], Lease({0: speed_steps_per_s}, 1e6))

    with pytest.raises(Rejected) as caught:
        run(900.0)
    [rejection] = caught.value.rejections
    fastest, end = rejection.told
    assert 100 < fastest.value < 200
    assert rejection.message == (
        f"axes.0.speed_steps_per_s is 900.0; allowed: at most {fastest.value} steps/s that way, as axis 0 has to come "
        "to rest within its soft limits, any position to 400 steps."
    )
    assert (end.value, end.unit) == (400, "steps")
    with pytest.raises(Rejected, match=f"at most {fastest.value} steps/s that way"):
        run(fastest.value + 1)
    run(fastest.value)
    bench.reset()
    bench.device.set_position([AxisCommand(0, 400, "position_steps")])
    with pytest.raises(Rejected, match="allowed: no speed that way, as axis 0"):
        run(900.0)
    bench.device.limit({0: FREE})


def test_an_axis_that_was_heard_of_long_ago_rested_until_it_set_out(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run away from a limit isn't ended at once, however long it is since anything was heard of it."""
    for module in (watch, limit_checks, setting_out):
        monkeypatch.setattr(module, "monotonic", bench.clock)
    bench.reset()
    bench.device.set_position([AxisCommand(0, 50, "position_steps")])
    bench.device.limit({0: Span(-50, 50)})
    bench.clock.now_s += 1.0
    bench.device.run([AxisCommand(0, -100.0, "speed_steps_per_s")], Lease({0: -100.0}, 1e6))
    for _ in range(100):
        bench.clock.now_s += 0.02
        bench.poll()
    bench.device.limit({0: FREE})
    assert bench.device.view.state is DeviceState.READY
    assert -50 <= bench.device.view.position_steps <= 10


def test_limits_are_kept_to_only_where_it_is_known_what_they_are_counted_from(
    clock: Clock, plug_in: Callable, unplugged_at: UnpluggedAt
) -> None:
    board, devices = unplugged_at, Devices()
    device = devices.connect(plug_in(board))
    push(device, clock)
    device.limit({0: Span(0, 1000)})
    device.move_to([AxisCommand(0, 900, "to_steps")])
    board.is_plugged_in = False
    with pytest.raises(DeviceLost):
        device.trace_moves(0, 1)
    board.is_plugged_in = True
    VirtualController.opened(board.controller)  # The board was reset: it counts from 0, and is near 1,000.
    devices.connect(device.view.port)
    assert (device.view.position_steps, device.view.unknown_positions) == (0, (0, 1))
    motions: list[Callable[[], None]] = [
        lambda: device.move_by([by(5, 1), by(900)]),
        lambda: device.move_to([AxisCommand(0, 900, "to_steps")]),
        lambda: device.line([by(900), by(5, 1)]),
        lambda: device.run([AxisCommand(0, 50.0, "speed_steps_per_s")], Lease({0: 50.0}, 1e6)),
        lambda: device.go_there_and_back(Shuttle(0, 50, 1, 0.0), by(50)),
    ]
    for motion in motions:
        with pytest.raises(Refused, match=r"Axis 0 may be elsewhere .* set its position, or take the limits away"):
            motion()
    assert not MOTIONS & set(board.seen[board.seen.index(HelloRequest.KIND, 1) :])
    device.move_by([by(5, 1)])
    device.run([AxisCommand(0, 0.0, "speed_steps_per_s")], Lease({}, 1e6))
    device.stop().result(PATIENCE_S)
    clock.now_s += 100.0
    device.set_position([AxisCommand(0, 900, "position_steps")])
    with pytest.raises(Rejected, match="0 to 1,000 steps, and this leads to 1,800"):
        device.move_by([by(900)])
    device.move_by([by(100)])
    devices.close()


@pytest.mark.parametrize("is_lost", [False, True])
def test_limits_outlive_a_device_that_is_let_go_of(
    clock: Clock, plug_in: Callable, unplugged_at: UnpluggedAt, is_lost: bool
) -> None:
    """Whether it was lost before or not, it may have been moved meanwhile, and count anew."""
    board, devices = unplugged_at, Devices()
    device = devices.connect(plug_in(board))
    push(device, clock)
    device.limit({0: Span(0, 100)})
    if is_lost:
        board.is_plugged_in = False
        with pytest.raises(DeviceLost):
            device.trace_moves(0, 1)
    devices.disconnect(device.view.id)
    board.is_plugged_in = True
    again = devices.connect(device.view.port)
    assert again.view.id != device.view.id
    assert [(axis.lowest_steps, axis.highest_steps) for axis in again.view.axes] == [(0, 100), (None, None)]
    assert again.view.unknown_positions == ((0, 1) if is_lost else (0,))
    with pytest.raises(Refused, match="Axis 0 may be elsewhere"):
        again.move_by([by(50)])
    again.set_position([AxisCommand(0, 90, "position_steps")])
    with pytest.raises(Rejected, match="0 to 100 steps, and this leads to 140"):
        again.move_by([by(50)])
    # Whoever has taken them away meets them no more.
    again.limit({0: Span()})
    devices.disconnect(again.view.id)
    last = devices.connect(again.view.port)
    assert last.view.soft_limits == {}
    assert last.view.unknown_positions == ((1,) if is_lost else ())
    devices.close()


def test_limits_go_with_what_has_a_serial_number(
    clock: Clock, plug_in: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    numbered: dict[str, str] = {}

    def known(port: str) -> Port:
        return Port(port, port, usb=(0x2341, 0x0043, numbered[port]))

    for module in (devices_module, attachment):
        monkeypatch.setattr(module, "known_port", known)
    first, second = plug_in(VirtualController(clock)), plug_in(VirtualController(clock))
    numbered |= {first: "A1", second: "B2"}
    devices = Devices()
    limited, free = devices.connect(first), devices.connect(second)
    limited.limit({0: Span(-5, 5)})
    for device in (limited, free):
        devices.disconnect(device.view.id)
    numbered |= {first: "B2", second: "A1"}
    assert devices.connect(first).view.soft_limits == {}
    assert devices.connect(second).view.soft_limits == {0: Span(-5, 5)}
    devices.close()


@pytest.mark.parametrize("family", ["tic", "tmcl"])
def test_limits_that_were_set_in_other_microsteps_are_to_be_set_anew(
    plug_in: Callable, family: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same number of steps is another place then: 800 eighths of a step were 100 full steps."""
    monkeypatch.setattr(watch, "IDLE_POLL_S", 1000.0)
    board = TicEmulator() if family == "tic" else TmclEmulator(time.monotonic)

    def make_of_a_full_step(power: int) -> None:
        if isinstance(board, TicEmulator):
            board.step_mode = power
            board.has_been_up(10.0)
        else:
            board.motors[0].settings[RESOLUTION] = power

    make_of_a_full_step(3)
    devices = Devices()
    device = devices.connect(plug_in(board), family)
    device.push([design()], mode="try")
    device.limit({0: Span(-800, 800)})
    make_of_a_full_step(0)
    words = (
        r"limits of axis 0 were set while it made 8 steps of a full step, and by now it makes 1 step, .* Set them anew"
    )
    motions: list[Callable[[], None]] = [
        lambda: device.move_to([AxisCommand(0, 800, "to_steps")]),
        lambda: device.move_by([by(1)]),
        lambda: device.run([AxisCommand(0, 50.0, "speed_steps_per_s")], Lease({0: 50.0}, 1e6)),
        lambda: device.go_there_and_back(Shuttle(0, 50, 1, 0.0), by(50)),
    ]
    for motion in motions:
        with pytest.raises(Refused, match="makes 1 step of a full step by now|" + words):
            motion()
        with pytest.raises(Refused, match=words):
            motion()
    assert re.search(words, device.view.message or "")
    assert device.view.target_steps == 0
    # Set back they are where they were.
    make_of_a_full_step(3)
    with pytest.raises(Rejected, match="-800 to 800 steps"):
        device.move_to([AxisCommand(0, 801, "to_steps")])
    assert device.view.message is None
    make_of_a_full_step(0)
    # Also those of a device that was let go of meanwhile.
    devices.disconnect(device.view.id)
    device = devices.connect(device.view.port, family)
    device.set_position([AxisCommand(0, 0, "position_steps")])
    with pytest.raises(Refused, match=words):
        device.move_by([by(100)])
    # They are meant in those that were shown when they were asked for, not in those that it has by then.
    make_of_a_full_step(3)
    device.limit({0: Span(-100, 100)})
    assert "set while it made 1 step of a full step, and by now it makes 8 steps" in (device.view.message or "")
    device.limit({0: Span(-100, 100)})
    assert device.view.message is None
    with pytest.raises(Refused, match="it was changed meanwhile"):
        device.move_to([AxisCommand(0, 100, "to_steps")])
    with pytest.raises(Rejected, match="-100 to 100 steps"):
        device.move_to([AxisCommand(0, 101, "to_steps")])
    device.move_to([AxisCommand(0, 100, "to_steps")])


@pytest.mark.parametrize("family", ["grbl", "marlin"])
def test_limits_that_were_set_by_other_steps_per_mm_are_to_be_set_anew(
    plug_in: Callable, family: str, tmp_path: Path
) -> None:
    """The same number of steps is another length then: 800 steps of 80 per mm, 10 mm, are 5 mm of 160."""
    board = GrblEmulator() if family == "grbl" else MarlinEmulator()
    before, after = ("$100=250.000", "$100=125.000") if family == "grbl" else ("M92 X80.00", "M92 X160.00")
    devices = Devices(data=tmp_path)
    device = devices.connect(plug_in(board), family)
    device.limit({0: Span(-800, 800)})
    device.back_up()
    saved = unmarked(device.saved_text(str(device.view.backup)))
    assert before in saved
    source = Source(f"{family}-some-port", family, "some-port", [])
    device.restore_from(source, "changed", saved.replace(before, after))
    words = r"limits of axis 0 were set while it made (250|80) steps per mm, and by now it makes (125|160), .* Set them"
    assert re.search(words, device.view.message or "")
    motions: list[Callable[[], None]] = [
        lambda: device.move_to([AxisCommand(0, 800, "to_steps")]),
        lambda: device.move_by([by(1)]),
        lambda: device.run([AxisCommand(0, 50.0, "speed_steps_per_s")], Lease({0: 50.0}, 1e6)),
    ]
    for motion in motions:
        with pytest.raises(Refused, match=words):
            motion()
    # Set back they are where they were.
    device.restore_from(source, "before", saved)
    with pytest.raises(Rejected, match="-800 to 800 steps"):
        device.move_to([AxisCommand(0, 801, "to_steps")])
    assert device.view.message is None
    device.restore_from(source, "changed", saved.replace(before, after))
    # Also those of a device that was let go of meanwhile.
    devices.disconnect(device.view.id)
    device = devices.connect(device.view.port, family)
    device.set_position([AxisCommand(0, 0, "position_steps")])
    with pytest.raises(Refused, match=words):
        device.move_by([by(100)])
    device.limit({0: Span(-400, 400)})
    assert device.view.message is None
    device.move_to([AxisCommand(0, 400, "to_steps")])


def test_limits_of_an_axis_whose_steps_per_mm_somebody_else_sets_are_to_be_set_anew(plug_in: Callable) -> None:
    """At a Marlin's display, which is seen before the next motion, and refused again when that is asked for anew."""
    board = MarlinEmulator()
    device = Devices().connect(plug_in(board), "marlin")
    device.limit({0: Span(-800, 800)})
    board.change_at_the_display("M92", "X", 160.0)
    with pytest.raises(Refused, match=r"M92|Set them anew"):
        device.move_to([AxisCommand(0, 800, "to_steps")])
    with pytest.raises(Refused, match="set while it made 80 steps per mm, and by now it makes 160"):
        device.move_to([AxisCommand(0, 800, "to_steps")])
    assert board.steps == 0


@pytest.mark.parametrize("is_noticed", [True, False], ids=["lost", "not_noticed_yet"])
def test_limits_stay_with_a_lost_board_that_somebody_connects_at_another_port(
    clock: Clock, plug_in: Callable, unplugged_at: UnpluggedAt, monkeypatch: pytest.MonkeyPatch, is_noticed: bool
) -> None:
    """Before it is found there by itself: it is the same device, not one that is free to move."""

    def known(port: str) -> Port:
        return Port(port, port, usb=(0x2341, 0x0043, "A1"))

    for module in (devices_module, attachment):
        monkeypatch.setattr(module, "known_port", known)
    moved = UnpluggedAt(clock)
    moved.controller = unplugged_at.controller
    first, second = plug_in(unplugged_at), plug_in(moved)
    devices = Devices()
    device = devices.connect(first)
    push(device, clock)
    device.limit({0: Span(0, 100)})
    unplugged_at.is_plugged_in = False
    if is_noticed:
        with pytest.raises(DeviceLost):
            device.trace_moves(0, 1)
    assert devices.connect(second) is device
    assert [(view.id, view.port, view.state) for view in devices.views()] == [("1", second, DeviceState.READY)]
    assert (device.view.soft_limits, device.view.unknown_positions) == ({0: Span(0, 100)}, (0, 1))
    with pytest.raises(Refused, match="Axis 0 may be elsewhere than counted"):
        device.move_by([by(50)])
    devices.close()


@pytest.mark.parametrize("is_let_go", [False, True], ids=["lost", "let go of"])
def test_limits_stay_with_a_board_that_is_told_apart_only_once_its_port_is_held(
    plug_in: Callable, unplugged_at: UnpluggedAt, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, is_let_go: bool
) -> None:
    """As where the ports' list missed it just before: it is no device of its own without limits."""
    first, second = plug_in(unplugged_at), plug_in(VirtualController())
    monkeypatch.setattr(attachment, "known_port", lambda port: Port(port, port, usb=(0x2341, 0x0043, "A1")))
    devices = Devices(data=tmp_path)
    limited = devices.connect(first)
    limited.limit({0: Span(0, 100)})
    unplugged_at.is_plugged_in = False
    with pytest.raises(DeviceLost):
        limited.settings()
    if is_let_go:
        devices.disconnect("1")
        again = devices.connect(second)
        assert (again.view.soft_limits, again.view.axes[0].highest_steps) == ({0: Span(0, 100)}, 100)
        with pytest.raises(Refused, match="Axis 0 may be elsewhere than counted"):
            again.move_by([by(50)])
    else:
        with pytest.raises(Refused, match="is device 1, USB 2341:0043, serial number A1: connect it again"):
            devices.connect(second)
        assert [view.id for view in devices.views()] == ["1"]
        monkeypatch.setattr(devices_module, "known_port", attachment.known_port)
        assert devices.connect(second) is limited
        assert limited.view.soft_limits == {0: Span(0, 100)}
    devices.close()


def test_where_an_axis_is_that_somebody_else_has_homed_is_to_be_said_where_it_has_limits() -> None:
    def told(*are_homed: bool) -> ControllerStatus:
        axes = [
            AxisStatus(axis, Activity.READY, 0, 0, 0.0, 0, position_told=is_homed)
            for axis, is_homed in enumerate(are_homed)
        ]
        return ControllerStatus(Activity.READY, tuple(axes), None, on_trial=False, motors_on=False)

    view = DeviceView("1", "a port", "a printer", "klipper").with_status(told(True, False, False))
    view = view.limited({0: Span(0, 10), 2: Span(0, 10)}, ())
    assert view.with_status(told(True, False, False)).unknown_positions == ()
    view = view.with_status(told(True, True, True))
    assert view.unknown_positions == (2,)
    with pytest.raises(Refused, match=r"Axis 2 may be elsewhere than counted.*or by somebody else"):
        limit_checks.refuse_targets(view, [by(1, 2)], relative=True)
    assert view.with_known_positions([2]).with_status(told(True, True, True)).unknown_positions == ()


@pytest.mark.parametrize("numbers", [(None, "A1"), ("A1", None)], ids=["goes", "comes"])
def test_limits_of_a_board_outlive_that_another_one_with_its_number_comes_or_goes(
    plug_in: Callable,
    unplugged_at: UnpluggedAt,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    numbers: tuple[str | None, str | None],
) -> None:
    """A number that two have at the same time tells neither."""
    told = [numbers[0]]
    for module in (devices_module, attachment):
        monkeypatch.setattr(module, "known_port", lambda port: Port(port, port, usb=(0x2341, 0x0043, told[0])))
    devices = Devices(data=tmp_path)
    device = devices.connect(plug_in(unplugged_at))
    device.limit({0: Span(0, 100)})
    known = device.identity
    unplugged_at.is_plugged_in = False
    with pytest.raises(DeviceLost):
        device.settings()
    unplugged_at.is_plugged_in, told[0] = True, numbers[1]
    assert devices.connect(device.view.port) is device
    assert device.identity == known
    devices.disconnect("1")
    again = devices.connect(device.view.port)
    assert (again.view.id, again.view.soft_limits) == ("2", {0: Span(0, 100)})
    devices.close()
