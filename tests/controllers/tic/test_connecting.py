"""Connecting to a Tic, which moves nothing, and to what is none."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from controllers.bench import POLL_S, PlugIn, by
from controllers.tic.bench import TARGET_FAR_AWAY, Bench
from controllers.tic.emulator import SOFT_ERROR
from designs import design
from stepramp.controllers.contract import Activity
from stepramp.controllers.tic import conversation
from stepramp.controllers.tic.controller import TicController
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState
from stepramp.errors import DeviceLost, Refused
from stepramp.link.serial_port import SerialPort

RUN_ON = bytes([0xE3, 0, 0, 0, 0x10, 0])
"""At 104.9 steps/s."""


@pytest.mark.parametrize("for_commands", [False, True])
@pytest.mark.parametrize("for_responses", [False, True])
def test_connecting_with_and_without_crcs(bench: Bench, for_commands: bool, for_responses: bool) -> None:
    bench.tic.crc_for_commands, bench.tic.crc_for_responses = for_commands, for_responses
    bench.controller.connect()
    assert bench.told() == []
    bench.controller.prepare_push([design()], 0, "try")()
    bench.controller.move_by(by(100))
    assert bench.rest().axes[0].position_steps == bench.tic.position == 100
    assert not bench.tic.out_of_range


def test_connecting_moves_and_energizes_nothing(bench: Bench) -> None:
    bench.controller.connect()
    for _ in range(10):
        status = bench.controller.status()
        bench.pass_time(POLL_S)
    assert bench.told() == []
    assert (bench.tic.steps, bench.tic.energized, bench.tic.state) == (0, False, SOFT_ERROR)
    assert (status.activity, status.motors_on, status.on_trial, status.trouble) == (Activity.READY, False, False, None)


def test_what_an_earlier_program_left_is_not_gone_on_with(bench: Bench) -> None:
    """Without safe start, a Tic goes on with what it was told before as soon as its timeout is reset."""
    tic = bench.tic
    tic.disable_safe_start = True
    tic.power_up()
    bench.exchange(TARGET_FAR_AWAY)
    bench.pass_time(5)
    steps = tic.steps
    assert steps > 0
    assert (tic.state, tic.velocity) == (SOFT_ERROR, 0)
    bench.controller.connect()
    for _ in range(20):
        bench.controller.status()
        bench.pass_time(POLL_S)
    assert tic.steps == steps


@pytest.mark.parametrize(("told", "answer"), [(TARGET_FAR_AWAY, []), (RUN_ON, [0xE3])])
def test_what_runs_when_a_device_is_connected_is_slowed_down(
    bench: Bench, plug_in: PlugIn, told: bytes, answer: list[int]
) -> None:
    """Nobody is there any more who asked for it; what is on its way to a target goes on to that."""
    tic = bench.tic
    tic.disable_safe_start, tic.command_timeout_ms = True, 0
    tic.power_up()
    bench.exchange(told)
    bench.pass_time(1)
    tic.commands.clear()
    devices = Devices()
    device = devices.connect(plug_in(bench), "tic")
    assert device.view.state is (DeviceState.STOPPING if answer else DeviceState.MOVING)
    assert bench.told() == answer
    devices.close()


def test_a_stop_that_is_owed_comes_first_and_leaves_no_target(bench: Bench) -> None:
    tic = bench.tic
    tic.disable_safe_start, tic.command_timeout_ms = True, 0
    tic.power_up()
    bench.exchange(TARGET_FAR_AWAY)
    bench.pass_time(1)
    bench.controller.connect(bench.controller.stop)
    assert bench.told() == [0xE0, 0xE3]
    bench.pass_time(5)
    assert tic.velocity == 0


def test_a_tic_that_takes_its_targets_from_elsewhere_is_refused(bench: Bench) -> None:
    bench.tic.control_mode = 2
    with pytest.raises(Refused, match="set its control mode to 'Serial / I²C / USB'"):
        bench.controller.connect()
    assert bench.told() == []


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
        (lambda _: b"", DeviceLost, "Nothing answers at .* as a Tic does: .* A controller of another family"),
        (lambda _: b"error:20\r\n", Refused, "Something talks at .*, but it is no Tic"),
        (lambda _: b"Grbl 1.1h ['$' for help]\r\n", Refused, "Something talks at .*, but it is no Tic"),
        (lambda heard: heard, Refused, "Something talks at .*, but it is no Tic"),
        (lambda _: bytes(14), Refused, "Something talks at .*, but it is no Tic"),
    ],
    ids=["silent", "grbl", "a banner", "a cable that leads back", "a line that is held low"],
)
def test_what_is_no_tic(
    plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch, answer: Callable[[bytes], bytes], error: type, words: str
) -> None:
    monkeypatch.setattr(conversation, "ANSWER_S", 0.03)
    with pytest.raises(error, match=words):
        TicController(SerialPort(plug_in(Answering(answer)))).connect()


def test_a_stepramp_controller_is_no_tic(plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(conversation, "ANSWER_S", 0.03)
    with pytest.raises(DeviceLost, match="A controller of another family is to be connected as that"):
        TicController(SerialPort(plug_in(VirtualController()))).connect()
