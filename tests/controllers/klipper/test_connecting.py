from __future__ import annotations

import json

import pytest

from controllers.conftest import Clock
from controllers.klipper.bench import Bench, by
from controllers.klipper.printer import CONFIG, MACROS
from designs import design
from stepramp.controllers.klipper import controller, conversation
from stepramp.errors import DeviceLost, Refused

HANDSHAKE = ["server.info", "printer.info", "server.files.roots", "printer.objects.query", "printer.objects.subscribe"]


def test_connecting_only_asks(bench: Bench) -> None:
    bench.controller.connect()
    assert bench.moonraker.methods == HANDSHAKE
    assert bench.printer.scripts == []
    controller = bench.controller
    assert (controller.most_axes, controller.firmware_version) == (3, "v0.12.0-85-gd785b396")
    assert (controller.clocks_hz, controller.timer_hz) == ((), None)
    status = controller.status()
    assert [axis.steps_per_mm for axis in status.axes] == [80, 160, 400]
    assert [axis.position_steps for axis in status.axes] == [8000, 16000, 40000]
    assert (status.on_trial, status.motors_on, status.trouble) == (False, False, None)


@pytest.mark.parametrize(
    ("state", "words"),
    [("disconnected", "Klipper doesn't run: start it first"), ("startup", "still starting: connect it again")],
)
def test_a_klipper_that_is_not_there_is_told(bench: Bench, state: str, words: str) -> None:
    bench.printer.state = state
    with pytest.raises(Refused, match=words):
        bench.controller.connect()


def test_a_klipper_that_is_starting_is_waited_for(bench: Bench) -> None:
    bench.printer.state = "startup"
    asked = []

    def is_asked() -> None:
        asked.append(1)
        if len(asked) == 2:
            bench.printer.state = "ready"

    bench.before_write = is_asked
    bench.controller.connect()
    assert bench.controller.most_axes == 3


def test_one_that_is_shut_down_is_shown_and_moves_nothing(bench: Bench) -> None:
    bench.printer.state, bench.printer.message = "shutdown", "MCU 'mcu' shutdown:\nTimer too close"
    bench.controller.connect()
    status = bench.controller.status()
    assert status.trouble == "Klipper isn't ready: MCU 'mcu' shutdown: Timer too close"
    assert [axis.position_told for axis in status.axes] == [False]
    with pytest.raises(Refused, match="Timer too close"):
        bench.controller.move_by([by(10)])
    bench.printer.restart()
    with pytest.raises(DeviceLost, match="was restarted"):
        bench.controller.status()


@pytest.mark.parametrize("printer_cfg", ["", "[printer]\nkinematics: cart", "no section: 1\n", CONFIG[:250]])
def test_one_that_does_not_start_for_its_configuration_can_be_given_it_back(clock: Clock, printer_cfg: str) -> None:
    whole = Bench(clock)
    saved = whole.connected().backup()
    bench = Bench(clock)
    bench.printer.files["printer.cfg"] = printer_cfg
    bench.printer.state, bench.printer.message = "error", "Option 'max_accel' is missing"
    bench.controller.connect()
    status = bench.controller.status()
    assert status.trouble == "Klipper isn't ready: Option 'max_accel' is missing"
    remarks = bench.controller.use_backup(saved)
    assert bench.printer.files["printer.cfg"] == CONFIG
    assert any("FIRMWARE_RESTART" in remark for remark in remarks)
    assert bench.printer.scripts == []
    assert bench.printer.restarts == 0


def test_files_that_take_long_end_connecting_within_5_s(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(controller, "monotonic", clock)
    monkeypatch.setattr(conversation, "monotonic", clock)
    files = {"printer.cfg": "[include many/*.cfg]\n"} | {f"many/{each}.cfg": "[printer]\n" for each in range(50)}
    bench = Bench(clock, files)
    bench.printer.state, bench.file_lasts_s = "error", 1.0
    with pytest.raises(DeviceLost, match="doesn't give its files"):
        bench.controller.connect()
    assert clock.now_s < 5
    # Once it is connected, a file may take longer.
    bench.reopen()
    bench.file_lasts_s = 0.01
    bench.controller.connect()
    bench.file_lasts_s = 4.9
    assert "many/49.cfg" in bench.controller.backup()


def test_kinematics_in_which_no_motor_is_an_axis(clock: Clock) -> None:
    bench = Bench(clock, {"printer.cfg": CONFIG.replace("cartesian", "delta"), "macros/start.cfg": MACROS})
    with pytest.raises(Refused, match="kinematics are delta"):
        bench.controller.connect()
    bench = Bench(clock, {"printer.cfg": CONFIG.replace("cartesian", "corexy"), "macros/start.cfg": MACROS})
    bench.controller.connect()
    assert any("no motor is an axis" in each for each in bench.controller.preview_push([design()], 0).warnings)


@pytest.mark.parametrize(
    ("said", "error", "words"),
    [
        ("", DeviceLost, "Nothing answers at moonraker://printer:7125 as Moonraker does"),
        ("hello", Refused, "Something talks at moonraker://printer:7125, but it is no Moonraker"),
        ('{"jsonrpc": "2.0", "id": 1, "result": {"state": "ready"}}', Refused, "it is no Moonraker"),
        ('{"jsonrpc": "2.0", "id": 1, "result": ["ready"]}', Refused, "it is no Moonraker"),
        ('{"jsonrpc": "2.0", "id": "1"}', Refused, "it is no Moonraker"),
        ("[" * 5000, Refused, "it is no Moonraker"),
        ('{"jsonrpc":"2.0","id":1,"error":{"code":-32601,"message":"Method not found"}}', Refused, "Method not found"),
    ],
)
def test_what_is_no_moonraker(bench: Bench, said: str, error: type[Exception], words: str) -> None:
    bench.moonraker.message = lambda _: [said] if said else []  # type: ignore[method-assign]
    with pytest.raises(error, match=words):
        bench.controller.connect()


@pytest.mark.parametrize(
    ("name", "field", "value"),
    [
        ("toolhead", "max_velocity", None),
        ("toolhead", "max_velocity", float("nan")),
        ("toolhead", "max_accel", 0),
        ("toolhead", "position", [1, 2]),
        ("motion_report", "live_position", [1e308, 0, 0]),
        ("toolhead", "homed_axes", 7),
        ("motion_report", "live_position", "here"),
        ("webhooks", "state", 3),
    ],
)
def test_a_state_that_makes_no_sense(bench: Bench, name: str, field: str, value: object) -> None:
    controller = bench.connected()
    answer = bench.moonraker.message

    def damaged(text: str) -> list[str]:
        [said, *_] = answer(text)
        told = json.loads(said)
        told["result"]["status"][name][field] = value
        return [json.dumps(told)]

    bench.moonraker.message = damaged  # type: ignore[method-assign]
    with pytest.raises(DeviceLost, match=f"tells of {name}.{field}.* makes no sense"):
        controller.status()


def test_a_restart_is_noticed(bench: Bench) -> None:
    controller = bench.connected()
    bench.hear(['{"jsonrpc": "2.0", "method": "notify_klippy_disconnected"}'])
    with pytest.raises(DeviceLost, match="was restarted: its position is no longer known"):
        controller.status()


def test_news_come_unasked(bench: Bench) -> None:
    controller = bench.connected()
    assert controller.listen() is None
    bench.printer.prints = "printing"
    bench.clock.now_s += 0.3
    status = controller.listen()
    assert status is not None
    assert status.trouble == "The printer can't be moved: it prints, or has paused that."
    assert bench.moonraker.methods == []


def test_news_without_end_leave_time_for_a_stop(bench: Bench) -> None:
    controller = bench.connected()
    status = json.dumps({"method": "notify_status_update", "params": [{"toolhead": {}}, 1.0]}).encode()
    bench.pending = lambda: status  # type: ignore[method-assign]
    assert controller.listen() is not None
