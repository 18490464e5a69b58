"""Connecting to a module, which moves nothing, and to what is none."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from controllers.bench import POLL_S, PlugIn, by, to
from controllers.conftest import Clock
from controllers.tmcl.bench import Bench
from controllers.tmcl.emulator import MST, MVP, TmclEmulator
from designs import design
from stepramp.controllers.contract import Activity
from stepramp.controllers.tmcl import conversation
from stepramp.controllers.tmcl.controller import TmclController
from stepramp.controllers.tmcl.modules import MODULES
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState
from stepramp.errors import DeviceLost, Refused
from stepramp.link.serial_port import SerialPort


@pytest.mark.parametrize("tells_its_number", [True, False])
@pytest.mark.parametrize("number", MODULES)
def test_each_module_is_found_and_only_asked(
    clock: Clock, plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch, number: int, tells_its_number: bool
) -> None:
    monkeypatch.setattr(conversation, "ANSWER_S", 0.03)
    axes = MODULES[number].axes
    bench = Bench(clock, plug_in, TmclEmulator(clock, number, axes))
    bench.module.tells_its_number = tells_its_number
    bench.controller.connect()
    for _ in range(3):
        status = bench.controller.status()
        bench.pass_time(POLL_S)
    assert bench.told() == []
    assert [axis.axis for axis in status.axes] == list(range(min(axes, 4)))
    assert (status.activity, status.on_trial, status.trouble) == (Activity.READY, False, None)
    assert bench.controller.most_axes == len(status.axes)
    # 0113 hexadecimal, and 13 in text.
    assert bench.controller.firmware_version == ("1.19" if tells_its_number else "1.13")
    assert not any(motor.chip.steps for motor in bench.module.motors)
    bench.port.close()


def test_a_module_without_a_table_is_refused_by_name(bench: Bench) -> None:
    bench.module.number = 1140
    with pytest.raises(Refused, match=r"is a TMCM-1140, whose parameters StepRamp doesn't know: .* It knows TMCM-1240"):
        bench.controller.connect()
    assert [command[0] for command in bench.module.commands] == [136]


def test_units_that_are_not_known_are_refused(bench: Bench) -> None:
    bench.module.motors[0].settings[255] = 7
    with pytest.raises(Refused, match="unit mode 7"):
        bench.controller.connect()


@pytest.mark.parametrize("resolution", [-1, 9, 2**31 - 1])
def test_a_resolution_that_there_is_not_is_refused(bench: Bench, resolution: int) -> None:
    bench.module.motors[0].settings[140] = resolution
    with pytest.raises(Refused, match=f"microstep resolution {resolution} .*of which there are 0 to 8"):
        bench.controller.connect()


def test_a_stop_that_is_owed_comes_first(bench: Bench) -> None:
    """Before anything else is learnt. What an earlier program had it do ends with that."""
    chip = bench.module.chip
    chip.mode, chip.vmax = 1, 2000
    bench.pass_time(1)
    bench.controller.connect(bench.controller.stop)
    assert bench.told() == [3, 3]
    bench.pass_time(5)
    assert chip.speed == 0


def test_a_halt_that_is_owed_comes_before_its_ramp_is_known(bench: Bench) -> None:
    chip = bench.module.chip
    chip.mode, chip.vmax = 1, 2000
    bench.pass_time(1)
    bench.controller.connect(bench.controller.halt)
    assert chip.speed == 0
    assert bench.module.motors[0].settings[5] == 858


def test_what_moves_when_it_is_connected_is_told_and_not_stopped(bench: Bench) -> None:
    chip = bench.module.chip
    chip.mode, chip.vmax = 1, 2000
    bench.pass_time(1)
    bench.controller.connect()
    [axis] = bench.controller.status().axes
    assert (axis.activity, axis.runs) == (Activity.MOVING, True)
    with pytest.raises(Refused, match="it isn't known yet where it comes to rest"):
        bench.controller.move_by(by(5))
    assert bench.told() == []


def test_what_moves_when_a_device_is_connected_is_slowed_down(bench: Bench, plug_in: PlugIn) -> None:
    """Also what is on its way to a target: it isn't asked what it was told."""
    chip = bench.module.chip
    bench.controller.connect()
    bench.controller.move_to(to(1_000_000))
    bench.pass_time(1)
    assert chip.speed > 0
    bench.module.commands.clear()
    devices = Devices()
    device = devices.connect(plug_in(bench), "tmcl")
    assert device.view.state is DeviceState.STOPPING
    assert set(bench.told()) == {MST}
    devices.close()


def test_a_module_that_was_restarted_is_lost(bench: Bench, controller: TmclController) -> None:
    controller.move_by(by(40))
    bench.rest()
    bench.module.power_up()
    with pytest.raises(DeviceLost, match="was restarted: its positions are no longer known"):
        controller.status()


def test_ticks_that_begin_anew_after_49_days_are_no_restart(bench: Bench) -> None:
    bench.module.has_been_up(2**32 / 1000 - 0.2)
    bench.controller.connect()
    for _ in range(5):
        bench.pass_time(0.1)
        bench.controller.status()


def test_another_program_in_the_module_keeps_it_from_being_moved(bench: Bench, controller: TmclController) -> None:
    bench.module.program = lambda _: None
    assert "A program that is stored in the module runs" in (controller.status().trouble or "")
    push = controller.prepare_push([design()], 0, "try")
    for refused in (lambda: controller.move_by(by(5)), push, controller.keep, controller.roll_back):
        with pytest.raises(Refused, match="A program that is stored in the module runs"):
            refused()
    assert MVP not in bench.told()
    controller.stop()
    assert controller.status().trouble is None
    controller.move_by(by(5))
    assert bench.rest().axes[0].position_steps == 5


class Answering:
    """Something that answers whatever it hears."""

    def __init__(self, answer: Callable[[bytes], bytes]) -> None:
        self._answer = answer

    def opened(self) -> None:
        pass

    def exchange(self, sent: bytes) -> bytes:
        return self._answer(sent) if sent else b""


@pytest.mark.parametrize(
    ("answer", "error", "words"),
    [
        (lambda _: b"", DeviceLost, "Nothing answers at .* as a TMCL module does: .* A controller of another family"),
        (lambda _: b"error:20\r\n", Refused, "Something talks at .*, but it is no TMCL module"),
        (lambda _: b"Grbl 1.1h ['$' for help]\r\n", Refused, "Something talks at .*, but it is no TMCL module"),
        (lambda heard: heard, Refused, "Something talks at .*, but it is no TMCL module"),
        (lambda _: bytes(9), Refused, "Something talks at .*, but it is no TMCL module"),
        (lambda _: b"\x02\x07\x64\x88\x04\xfc\x01\x13\x09", Refused, "of the serial address 1"),
    ],
    ids=["silent", "grbl", "a banner", "a cable that leads back", "a line that is held low", "another address"],
)
def test_what_is_no_module(
    plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch, answer: Callable[[bytes], bytes], error: type, words: str
) -> None:
    monkeypatch.setattr(conversation, "ANSWER_S", 0.03)
    with pytest.raises(error, match=words):
        TmclController(SerialPort(plug_in(Answering(answer)))).connect()


def test_a_stepramp_controller_is_no_module(plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(conversation, "ANSWER_S", 0.03)
    with pytest.raises(DeviceLost, match="A controller of another family is to be connected as that"):
        TmclController(SerialPort(plug_in(VirtualController()))).connect()
