"""The client of a Tic, against an emulator whose clock tests set."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import count

import pytest

from controllers.conftest import Clock
from controllers.tic_emulator import (
    DEENERGIZE,
    GO_TO_POSITION,
    HALT_AND_HOLD,
    HALTED,
    NORMAL,
    READ,
    SOFT_ERROR,
    STARTING_UP,
    VELOCITY,
    TicEmulator,
)
from designs import design
from stepramp.controllers.contract import Activity, AnswerUnknown, Asked, ControllerStatus
from stepramp.controllers.tic import conversation
from stepramp.controllers.tic.controller import TicController
from stepramp.controllers.tic.variables import TARGET_VELOCITY, UP_TIME
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.errors import DeviceLost, Refused, Rejected
from stepramp.link.protocol_sim import VirtualDevice
from stepramp.link.serial_port import SerialPort

PlugIn = Callable[[VirtualDevice], str]
POLL_S = 0.3
LONG_S = 60.0
TARGET_FAR_AWAY = bytes([0xE0, 0, 0, 0, 0x7F, 0])
"""8,323,072 steps."""
RUN_BACKWARDS = bytes([0xE3, 0x0E, 0x00, 0x7B, 0x61, 0x7F])
AT_REST = (Activity.READY,)
DAMAGED = "is its serial line disturbed"


def by(steps: int, axis: int = 0) -> list[Asked]:
    return [Asked(axis, steps, "by_steps")]


def to(position: int) -> list[Asked]:
    return [Asked(0, position, "to_steps")]


def at(speed: float) -> list[Asked]:
    return [Asked(0, speed, "speed_steps_per_s")]


class Bench:
    """A Tic, its clock, and a client of it. lasts_s: how long each exchange takes by that clock."""

    def __init__(self, clock: Clock, plug_in: PlugIn) -> None:
        self.clock = clock
        self.lasts_s = 0.002
        self.tic = TicEmulator(clock)
        self.port = SerialPort(plug_in(self))
        self.interrupt: Callable[[], None] = lambda: None
        self.controller = TicController(self.port, self.give_way)
        self.way: list[int] = []
        """All positions that the motor was seen at."""

    def opened(self) -> None:
        self.tic.opened()

    def exchange(self, sent: bytes) -> bytes:
        if sent:
            self.clock.now_s += self.lasts_s
        said = self.tic.exchange(sent)
        self.way.append(self.tic.position)
        return said

    def give_way(self, pause_s: float) -> None:
        self.clock.now_s += pause_s
        self.interrupt()

    def pass_time(self, time_s: float) -> None:
        """Let time go on with nobody asking."""
        until_s = self.clock.now_s + time_s
        while self.clock.now_s < until_s:
            self.clock.now_s += 0.01
            self.exchange(b"")

    def wait_until(self, *activities: Activity) -> ControllerStatus:
        """Ask as often as a device does while it moves, until it does so."""
        for _ in range(int(LONG_S / POLL_S)):
            status = self.controller.status()
            if status.activity in activities:
                return status
            self.pass_time(POLL_S)
        raise AssertionError(status)

    def rest(self) -> ControllerStatus:
        return self.wait_until(Activity.READY)

    def told(self) -> list[int]:
        """Return the first bytes of the commands that are no questions."""
        return [each[0] for each in self.tic.commands if each[0] not in READ]


class Interruption:
    """Does something at a place, counted from 0, of those that are passed."""

    def __init__(self, place: int, act: Callable[[], None]) -> None:
        self._place, self._act = place, act
        self._passed = 0
        self.came = False

    def passed(self) -> None:
        self._passed += 1
        if self._passed == self._place + 1:
            self.came = True
            self._act()


@pytest.fixture
def bench(clock: Clock, plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    monkeypatch.setattr(conversation, "ANSWER_S", 0.03)
    bench = Bench(clock, plug_in)
    yield bench
    bench.port.close()


@pytest.fixture
def tic(bench: Bench) -> TicEmulator:
    return bench.tic


@pytest.fixture
def controller(bench: Bench) -> TicController:
    """Return a client that is connected, with a ramp of 1000 steps/s and 5000 steps/s² in use."""
    bench.controller.connect()
    bench.controller.prepare_push([design()], 0, "try")()
    bench.tic.commands.clear()
    return bench.controller


def only_rejection(ask: Callable[[], object]) -> tuple[str, object, str]:
    with pytest.raises(Rejected) as caught:
        ask()
    [rejection] = caught.value.rejections
    return rejection.field, rejection.value, rejection.allowed


# ---- connecting ----


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


# ---- the ramp ----


def test_a_push_is_sent_read_back_and_told(bench: Bench) -> None:
    bench.controller.connect()
    asked = design(ramp__base_speed_steps_per_s=12.34567, ramp__deceleration_steps_per_s2=2500.125)
    preview = bench.controller.preview_push([asked], 0)
    assert bench.told() == []
    report = bench.controller.prepare_push([asked], 0, "try")()
    assert bench.tic.ramp == [123_456, 10_000_000, 250_012, 500_000]
    figures = [(item.name, item.unit, item.requested, item.sent, item.read_back) for item in report.items]
    assert figures == [
        ("Starting speed", "steps/s", 12.34567, 12.3456, 12.3456),
        ("Full speed", "steps/s", 1000, 1000, 1000),
        ("Acceleration", "steps/s²", 5000, 5000, 5000),
        ("Deceleration", "steps/s²", 2500.125, 2500.12, 2500.12),
    ]
    assert (report.verified, report.kept, report.bytes, report.segments) == (True, False, 24, None)
    assert (report.largest_deviation_us, report.sequence) == (None, 0)
    assert "the method 'exact'" in report.warnings[0]
    assert "switched off" in report.warnings[1]
    # What a Tic has when it is new.
    assert [(item.on_device, item.to_send) for item in preview.items] == [
        (0, 12.3456), (200, 1000), (400, 5000), (400, 2500.12)
    ]  # fmt: skip
    assert not preview.same
    assert bench.controller.preview_push([asked], 0).same
    assert bench.controller.status().on_trial
    assert bench.tic.steps == 0


def test_a_table_is_lost_and_that_is_said(controller: TicController) -> None:
    preview = controller.preview_push([design(method__name="table")], 0)
    assert "the lookup table" in preview.warnings[0]


def test_rolling_back_brings_the_ramp_of_the_settings(bench: Bench, controller: TicController) -> None:
    controller.roll_back()
    assert bench.tic.ramp == [0, 2_000_000, 40_000, 40_000]
    assert not controller.status().on_trial
    with pytest.raises(Refused, match="Nothing is on trial"):
        controller.roll_back()


def test_a_ramp_that_was_changed_at_the_usb_port_is_seen(tic: TicEmulator, controller: TicController) -> None:
    assert controller.preview_push([design()], 0).same
    before = controller.status().ramp
    tic.exchange(bytes([0xE6, 0, 0, 0x2D, 0x31, 0x01]))
    assert controller.status().ramp != before
    changed = {item.name: item.on_device for item in controller.preview_push([design()], 0).items if item.differs}
    assert changed == {"Full speed": 2000}


@pytest.mark.parametrize(
    ("designs", "first_axis", "rejected"),
    [(2, None, ("axes", "2 designs")), (1, 1, ("to_axis", 1)), (0, None, ("axes", "0 designs"))],
)
def test_a_tic_has_one_axis(
    controller: TicController, designs: int, first_axis: int | None, rejected: tuple[str, object]
) -> None:
    *found, allowed = only_rejection(lambda: controller.prepare_push([design()] * designs, first_axis, "try"))
    assert (tuple(found), allowed.endswith("a Tic has one axis")) == (rejected, True)


def test_no_push_while_the_motor_moves(bench: Bench, controller: TicController) -> None:
    push = controller.prepare_push([design(ramp__slew_speed_steps_per_s=20)], 0, "try")
    controller.move_by(by(5000))
    before = bench.tic.ramp
    for refused in (
        push,
        controller.roll_back,
        lambda: controller.set_position(to(0)),
        lambda: controller.zero([0], 5),
    ):
        with pytest.raises(Refused, match="The motor moves: stop it first"):
            refused()
    assert bench.tic.ramp == before
    assert bench.rest().axes[0].position_steps == 5000


# ---- motion ----


def test_moving(bench: Bench, controller: TicController) -> None:
    controller.move_by(by(3000))
    # Target, then leaving safe start; its motor was never switched off on purpose.
    assert bench.told() == [0xE0, 0x83]
    assert controller.status().activity is Activity.MOVING
    bench.pass_time(0.5)
    [axis] = controller.status().axes
    assert (axis.activity, axis.target_steps) == (Activity.MOVING, 3000)
    # 0.2 s up to 1000 steps/s take 100 steps, then 0.3 s, and what asking took.
    assert axis.position_steps == pytest.approx(400, abs=80)
    assert axis.steps_made == axis.position_steps
    assert axis.speed_steps_per_s == pytest.approx(1000)
    status = bench.rest()
    assert (status.axes[0].position_steps, status.axes[0].target_steps, status.trouble) == (3000, 3000, None)
    assert (status.motors_on, status.axes[0].steps_made, bench.tic.steps) == (True, 3000, 3000)
    controller.move_to(to(-1000))
    assert bench.rest().axes[0].position_steps == bench.tic.position == -1000
    assert controller.status().axes[0].steps_made == 4000


def test_a_move_counts_as_begun_once_the_tic_acts_on_it(bench: Bench, controller: TicController) -> None:
    """It does so a moment after it was told; until then it looks as if it rested at the target before."""
    controller.move_by(by(100))
    bench.rest()
    bench.lasts_s = 0.0
    controller.move_by(by(-100))
    assert controller.status().activity is Activity.MOVING
    controller.run(at(-100))
    [axis] = controller.status().axes
    assert axis.target_steps == axis.position_steps


def test_moves_count_from_the_target(bench: Bench, controller: TicController) -> None:
    controller.move_by(by(1000))
    bench.pass_time(0.3)
    controller.move_by(by(-400))
    assert bench.rest().axes[0].position_steps == 600
    controller.run(at(-300))
    with pytest.raises(Refused, match="it isn't known yet where it comes to rest"):
        controller.move_by(by(5))


def test_a_move_is_kept_from_timing_out_as_long_as_somebody_asks(bench: Bench, controller: TicController) -> None:
    controller.move_by(by(20_000))
    bench.pass_time(0.1)
    assert bench.rest().axes[0].position_steps == 20_000
    # And is held, for the next one to begin at once.
    for _ in range(20):
        controller.status()
        bench.pass_time(POLL_S)
    assert (bench.tic.state, bench.tic.energized) == (NORMAL, True)


def test_a_tic_that_nobody_asks_stops_by_itself_and_says_why(bench: Bench, controller: TicController) -> None:
    bench.tic.disable_safe_start = True
    controller.run(at(1000))
    bench.pass_time(3)
    assert (bench.tic.velocity, bench.tic.state) == (0, SOFT_ERROR)
    steps = bench.tic.steps
    # 1 s, and 0.2 s of slowing down, which takes 100 steps.
    assert 900 < steps < 1100
    status = controller.status()
    assert status.trouble == "The Tic has stopped by itself: it heard no command for longer than its command timeout."
    for _ in range(10):
        controller.status()
        bench.pass_time(POLL_S)
    assert bench.tic.steps == steps
    controller.move_by(by(10))
    assert bench.rest().trouble is None
    assert bench.tic.steps == steps + 10


@pytest.mark.parametrize("speed", [1000, -1000, 0.0007, -0.00079, 12.34567])
def test_running(bench: Bench, controller: TicController, speed: float) -> None:
    controller.run(at(speed))
    assert bench.tic.told == (VELOCITY, int(speed * 10_000))
    bench.pass_time(0.5)
    [axis] = controller.status().axes
    assert (axis.activity, axis.target_steps) == (Activity.MOVING, axis.position_steps)
    controller.run(at(0))
    assert bench.rest().axes[0].position_steps == bench.tic.position


@pytest.mark.parametrize("speed", [1000.0002, -1001, 0.0006, -1e-9])
def test_speeds_that_a_tic_would_not_run_at(bench: Bench, controller: TicController, speed: float) -> None:
    field, value, allowed = only_rejection(lambda: controller.run(at(speed)))
    assert (field, value) == ("speed_steps_per_s", speed)
    assert allowed.startswith(
        "from -1,000 to 1,000 steps/s, the full speed of the ramp in use, and 0 or at least 0.0007"
    )
    assert bench.told() == []


@pytest.mark.parametrize("ask", ["move_by", "move_to", "run", "set_position"])
def test_other_axes_are_not_there(controller: TicController, ask: str) -> None:
    for field, named in (("by_steps", "axis"), ("axes.0.by_steps", "axes.0.axis")):
        rejected = only_rejection(lambda field=field: getattr(controller, ask)([Asked(2, 5, field)]))
        assert rejected == (named, 2, "0: a Tic has one axis")
    twice = [Asked(0, 5, "axes.0.by_steps"), Asked(0, 6, "axes.1.by_steps")]
    assert only_rejection(lambda: getattr(controller, ask)(twice)) == ("axes.1.axis", 0, "each axis once")


def test_positions_that_a_tic_cant_count_to(bench: Bench, controller: TicController) -> None:
    controller.set_position(to(2**31 - 1))
    assert only_rejection(lambda: controller.move_by(by(1)))[:2] == ("by_steps", 1)
    assert only_rejection(lambda: controller.set_position(to(-(2**31) - 1)))[:2] == ("to_steps", -(2**31) - 1)
    # A Tic would go there the other way, past the last position to the first.
    field, value, allowed = only_rejection(lambda: controller.move_to(to(-(2**31))))
    assert (field, value) == ("to_steps", -(2**31))
    assert "the shorter way round" in allowed
    assert bench.told() == [0xEC]
    assert bench.tic.steps == 0


def test_setting_the_position_and_zeroing(bench: Bench, controller: TicController) -> None:
    controller.set_position(to(-70_000))
    assert (bench.tic.position, bench.tic.position_uncertain, bench.tic.steps) == (-70_000, False, 0)
    assert controller.status().axes[0].position_steps == -70_000
    controller.zero([0], 40)
    assert bench.rest().axes[0].position_steps == 0
    assert bench.tic.steps == 40


def test_a_limit_switch_on_the_way(bench: Bench, controller: TicController) -> None:
    controller.move_by(by(1000))
    bench.pass_time(0.3)
    bench.tic.press("forward_limit")
    status = bench.rest()
    assert status.axes[0].target_steps == status.axes[0].position_steps < 1000


# ---- stopping ----


@pytest.mark.parametrize("begin", ["move_by", "run"])
def test_a_stop_slows_down_with_the_ramp(bench: Bench, controller: TicController, begin: str) -> None:
    getattr(controller, begin)([Asked(0, -1000, "value")])
    bench.pass_time(0.4)
    at_stop = bench.tic.position
    controller.stop()
    [axis] = controller.status().axes
    assert axis.activity is Activity.STOPPING
    # v² / (2 d) = 1000² / (2 · 5000), and what asking took.
    assert axis.target_steps == pytest.approx(at_stop - 100, abs=10)
    bench.pass_time(5)
    assert bench.rest().axes[0].position_steps == pytest.approx(axis.target_steps, abs=2)
    assert (bench.tic.told, bench.tic.state) == ((VELOCITY, 0), SOFT_ERROR)


def test_a_halt_makes_no_further_step(bench: Bench, controller: TicController) -> None:
    controller.run(at(1000))
    bench.pass_time(0.4)
    controller.halt()
    steps = bench.tic.steps
    bench.pass_time(5)
    assert (bench.tic.steps, bench.tic.told) == (steps, (HALTED, 0))
    assert controller.status().axes[0].position_steps == bench.tic.position == steps


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("begin", ["move_by", "move_to", "run", "zero"])
@pytest.mark.parametrize("guarded", [True, False])
def test_a_stop_at_any_place_of_a_motion_is_final(
    bench: Bench, controller: TicController, stop: str, begin: str, guarded: bool
) -> None:
    """At each place where it gives way, one after the other, until there is no further one. It is looked at, too."""
    bench.tic.disable_safe_start, bench.lasts_s = not guarded, 0.02

    def stop_and_look() -> None:
        getattr(controller, stop)()
        controller.status()

    for place in count():
        interruption = Interruption(place, stop_and_look)
        bench.interrupt = interruption.passed
        with suppress(AnswerUnknown):
            controller.zero([0], 500) if begin == "zero" else getattr(controller, begin)([Asked(0, 900, "value")])
        bench.interrupt = lambda: None
        if not interruption.came:
            break
        bench.pass_time(3)
        assert bench.tic.told in ((VELOCITY, 0), (HALTED, 0)), place
        assert bench.tic.velocity == 0, place
        controller.set_position(to(0))
    assert place > 5


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("lost", range(16))
def test_a_stop_gets_through_though_bytes_are_lost(
    bench: Bench, controller: TicController, stop: str, lost: int
) -> None:
    controller.run(at(1000))
    bench.pass_time(0.3)
    bench.tic.on_the_way_in = losing(lost)
    getattr(controller, stop)()
    bench.pass_time(0.5)
    assert bench.tic.velocity == 0
    assert bench.tic.told in ((VELOCITY, 0), (HALTED, 0))


def test_a_stop_ends_what_the_tic_does_in_error(bench: Bench, controller: TicController) -> None:
    """A Tic may be set to go somewhere when there is an error, whatever it was told last."""
    bench.tic.soft_error_response, bench.tic.soft_error_position = GO_TO_POSITION, 100_000
    controller.run(at(-200))
    bench.pass_time(0.3)
    bench.tic.press("kill_switch")
    bench.pass_time(0.5)
    assert bench.tic.velocity > 0
    controller.stop()
    bench.pass_time(1)
    assert bench.tic.velocity == 0


def test_a_tic_that_obeys_no_stop_is_told_so(bench: Bench, controller: TicController) -> None:
    controller.run(at(1000))
    bench.tic.control_mode = 1
    for stop, word in ((controller.stop, "stop"), (controller.halt, "halt")):
        with pytest.raises(Refused, match=f"doesn't {word} when it is told to: cut the power of its motor"):
            stop()


# ---- errors ----


@pytest.mark.parametrize(
    ("condition", "words"),
    [
        ("low_vin", "the supply of its motor is off or too low \\(low VIN\\)"),
        ("driver_fault", "its motor driver reports a fault"),
        ("kill_switch", "its kill switch is active"),
        ("err_line_high", "its ERR line is high"),
    ],
)
def test_what_keeps_a_tic_from_moving_is_told(
    bench: Bench, controller: TicController, condition: str, words: str
) -> None:
    bench.tic.press(condition)
    for ask in (lambda: controller.move_by(by(5)), lambda: controller.run(at(5)), lambda: controller.zero([0], 5)):
        with pytest.raises(Refused, match=f"^The Tic can't move: {words}"):
            ask()
    assert not {0xE0, 0xE3, 0x83, 0x85} & set(bench.told())
    assert controller.status().trouble is not None
    bench.tic.press(condition, False)
    assert controller.status().trouble is None
    controller.move_by(by(5))
    assert bench.rest().axes[0].position_steps == 5


@pytest.mark.parametrize("response", [DEENERGIZE, HALT_AND_HOLD, 2])
@pytest.mark.parametrize("condition", ["low_vin", "kill_switch", "err_line_high"])
@pytest.mark.parametrize("begin", ["move_by", "run"])
def test_what_an_error_cut_short_is_not_gone_on_with(
    bench: Bench, controller: TicController, response: int, condition: str, begin: str
) -> None:
    """Not even by a Tic whose own precautions are switched off."""
    tic = bench.tic
    tic.disable_safe_start, tic.command_timeout_ms, tic.soft_error_response = True, 0, response
    getattr(controller, begin)([Asked(0, 1000, "value")])
    bench.pass_time(0.3)
    tic.press(condition)
    status = bench.rest()
    assert status.trouble is not None
    steps = tic.steps
    tic.press(condition, False)
    for _ in range(5):
        status = controller.status()
        bench.pass_time(POLL_S)
    assert tic.steps == steps
    assert status.trouble is not None
    assert status.trouble.startswith("The Tic has stopped by itself: ")


def test_what_a_failing_supply_cut_short_is_told_though_it_is_over(bench: Bench, controller: TicController) -> None:
    """Without safe start a Tic would go on by itself as soon as its driver is ready again."""
    bench.tic.disable_safe_start, bench.lasts_s = True, 0.0
    controller.run(at(1000))
    bench.pass_time(0.3)
    bench.tic.press("low_vin")
    bench.tic.press("low_vin", False)
    assert bench.tic.state == STARTING_UP
    bench.lasts_s = 0.002
    assert controller.status().trouble == "The Tic has stopped by itself: its driver was started anew."
    bench.pass_time(1)
    assert bench.tic.velocity == 0


def test_a_motor_that_was_switched_off_on_purpose_is_switched_on_by_a_move_alone(
    bench: Bench, controller: TicController
) -> None:
    bench.tic.exchange(bytes([0x86]))
    controller.status()
    controller.stop()
    controller.set_position(to(7))
    assert not bench.tic.energized
    controller.move_to(to(9))
    assert bench.told()[-3:] == [0xE0, 0x85, 0x83]
    assert bench.rest().axes[0].position_steps == 9


@pytest.mark.parametrize("guarded", [True, False])
def test_an_old_target_is_never_set_out_for(bench: Bench, controller: TicController, guarded: bool) -> None:
    """Switched on, or out of safe start, a Tic heads for what it was told last: that must be the new target."""
    bench.lasts_s = 0.02
    bench.tic.exchange(TARGET_FAR_AWAY)
    bench.tic.exchange(bytes([0x86]))
    bench.tic.disable_safe_start = not guarded
    controller.move_to(to(-50))
    assert bench.rest().axes[0].position_steps == -50
    assert max(bench.way) == 0


def test_a_tic_that_stays_in_error_is_left_without_a_target(bench: Bench, controller: TicController) -> None:
    bench.tic.on_the_way_in = lambda data: b"" if data[:1] == b"\x83" else data
    with pytest.raises(Refused, match=r"^The Tic can't move: it stays in safe start\.$"):
        controller.move_by(by(500))
    bench.tic.on_the_way_in = lambda data: data
    assert bench.tic.told == (VELOCITY, 0)


def test_a_byte_without_a_stop_bit_ends_a_motion_and_is_told(bench: Bench, controller: TicController) -> None:
    controller.run(at(1000))
    bench.pass_time(0.3)
    bench.tic.frame_badly()
    trouble = bench.rest().trouble
    assert trouble == "The Tic has stopped by itself: bytes on its serial line were damaged or lost (serial error)."


# ---- bad lines ----


class SlowLine:
    """A connection with a clock of its own. Answers come in their order, each so long after its question [s]."""

    def __init__(self, tic: TicEmulator) -> None:
        self.name = "slow"
        self.now_s = 0.0
        self.answers_after_s = iter([0.0])
        self._tic = tic
        self._on_the_way: list[tuple[float, bytes]] = []

    def write(self, data: bytes) -> None:
        last_s = self._on_the_way[-1][0] if self._on_the_way else 0.0
        due_s = max(self.now_s + next(self.answers_after_s, 0.0), last_s) + 0.01
        self._on_the_way.append((due_s, self._tic.exchange(data)))

    def read(self, timeout_s: float) -> bytes:
        if self._on_the_way and self._on_the_way[0][0] <= self.now_s + timeout_s:
            due_s, answer = self._on_the_way.pop(0)
            self.now_s = max(self.now_s, due_s)
            return answer
        self.now_s += timeout_s
        return b""

    def pending(self) -> bytes:
        come = b""
        while self._on_the_way and self._on_the_way[0][0] <= self.now_s:
            come += self._on_the_way.pop(0)[1]
        return come

    def close(self) -> None:
        pass


def losing(place: int) -> Callable[[bytes], bytes]:
    """Return what loses one byte on the way, the one at a place, counted from now on."""
    left = [place]

    def lose(data: bytes) -> bytes:
        at_byte, left[0] = left[0], left[0] - len(data)
        return data[:at_byte] + data[at_byte + 1 :] if 0 <= at_byte < len(data) else data

    return lose


def flipping(place: int, bit: int) -> Callable[[bytes], bytes]:
    """Return what flips a bit of one byte on the way."""
    left = [place]

    def flip(data: bytes) -> bytes:
        at_byte, left[0] = left[0], left[0] - len(data)
        flipped = bytearray(data)
        if 0 <= at_byte < len(data):
            flipped[at_byte] ^= 1 << bit
        return bytes(flipped)

    return flip


@pytest.mark.parametrize("lost", range(30))
def test_a_push_gets_through_though_a_byte_is_lost(bench: Bench, lost: int) -> None:
    bench.controller.connect()
    push = bench.controller.prepare_push([design()], 0, "try")
    bench.tic.on_the_way_in = losing(lost)
    assert push().verified
    assert bench.tic.ramp == [0, 10_000_000, 500_000, 500_000]


@pytest.mark.parametrize("way", ["on_the_way_in", "on_the_way_out"])
@pytest.mark.parametrize("lost", range(0, 90, 3))
def test_a_move_gets_through_though_a_byte_is_lost_or_says_why_not(
    bench: Bench, controller: TicController, way: str, lost: int
) -> None:
    """A Tic that moves and misses a byte slows down: that can't be helped."""
    setattr(bench.tic, way, losing(lost))
    controller.move_by(by(700))
    status = bench.rest()
    assert status.axes[0].position_steps == bench.tic.position
    if bench.tic.position != 700:
        assert way == "on_the_way_in"
        assert status.trouble is not None
        assert "bytes on its serial line were damaged or lost (serial error)" in status.trouble


@pytest.mark.parametrize("bit", range(7))
@pytest.mark.parametrize("byte", range(1, 6))
def test_a_target_that_arrives_damaged_is_never_set_out_for(
    bench: Bench, controller: TicController, byte: int, bit: int
) -> None:
    bench.lasts_s = 0.02

    def flip(data: bytes) -> bytes:
        if data[0] == 0xE0:
            bench.tic.on_the_way_in = lambda data: data
            return flipping(byte, bit)(data)
        return data

    bench.tic.on_the_way_in = flip
    controller.move_to(to(300))
    assert bench.rest().axes[0].position_steps == 300
    assert (min(bench.way), max(bench.way)) == (0, 300)


def test_noise_before_between_and_in_answers(bench: Bench) -> None:
    noise = iter(range(10**6))

    def add(data: bytes) -> bytes:
        # Every fifth answer comes with a byte that nobody sent.
        return data[:2] + b"\xa5" + data[2:] if next(noise) % 5 == 0 else data

    bench.tic.on_the_way_out = add
    bench.controller.connect()
    bench.controller.prepare_push([design()], 0, "try")()
    bench.controller.move_by(by(321))
    assert bench.rest().axes[0].position_steps == 321


@pytest.mark.parametrize("bit", [0, 6])
@pytest.mark.parametrize("place", range(0, 150, 2))
def test_a_move_counts_from_where_the_motor_is_though_an_answer_was_damaged(
    bench: Bench, controller: TicController, place: int, bit: int
) -> None:
    controller.set_position(to(5000))
    bench.tic.on_the_way_out = flipping(place, bit)
    refused = False
    try:
        controller.move_by(by(70))
    except (Refused, DeviceLost):
        refused = True
    bench.tic.on_the_way_out = lambda data: data
    bench.pass_time(2)
    assert bench.tic.position == (5000 if refused else 5070)


@pytest.mark.parametrize("late_s", [0.1, 0.195, 0.2, 0.25, 0.39, 0.45, 0.6, 0.75])
def test_an_answer_that_comes_late_is_not_taken_for_the_next_one(
    tic: TicEmulator, monkeypatch: pytest.MonkeyPatch, late_s: float
) -> None:
    """Those of target velocity and up time are of the same length."""
    tic.has_been_up(60)
    line = SlowLine(tic)
    monkeypatch.setattr(conversation, "ANSWER_S", 0.2)
    monkeypatch.setattr(conversation, "monotonic", lambda: line.now_s)
    talk = conversation.Conversation(line, lambda _: None)
    talk.begin()
    line.answers_after_s = iter([late_s])
    (target_velocity,), (up_time_ms,) = talk.read(TARGET_VELOCITY), talk.read(UP_TIME)
    assert (target_velocity, up_time_ms) == (0, 60_000)


def test_crcs_of_answers_are_checked(bench: Bench) -> None:
    bench.tic.crc_for_commands = bench.tic.crc_for_responses = True
    bench.controller.connect()
    answers = iter(range(10**6))
    bench.tic.on_the_way_out = lambda data: flipping(3, 5)(data) if next(answers) % 3 == 0 else data
    bench.controller.prepare_push([design()], 0, "try")()
    bench.controller.move_by(by(321))
    assert bench.rest().axes[0].position_steps == 321


@pytest.mark.parametrize(
    ("in_the_way", "words"),
    [
        (lambda _: b"", "does not answer"),
        (lambda data: data[:-1], "does not answer"),
        (lambda data: b"\x05" + data[1:], "answers without sense"),
    ],
)
def test_a_tic_that_falls_silent_or_talks_nonsense_is_lost(
    bench: Bench, controller: TicController, in_the_way: Callable[[bytes], bytes], words: str
) -> None:
    bench.tic.on_the_way_out = in_the_way
    with pytest.raises(DeviceLost, match=words):
        controller.status()


def test_a_disturbed_line_is_told(bench: Bench, controller: TicController) -> None:
    bench.tic.on_the_way_in = lambda data: data if data[0] in READ else b""
    for ask in (
        controller.prepare_push([design(ramp__slew_speed_steps_per_s=20)], 0, "try"),
        lambda: controller.set_position(to(5)),
        lambda: controller.move_to(to(5)),
        lambda: controller.run(at(5)),
    ):
        with pytest.raises(Refused, match=DAMAGED):
            ask()


def test_a_tic_that_was_restarted_is_lost(bench: Bench, controller: TicController) -> None:
    controller.move_by(by(100))
    bench.rest()
    bench.pass_time(1)
    bench.tic.power_up()
    with pytest.raises(DeviceLost, match="was restarted: its position is no longer known"):
        controller.status()


def test_a_tic_that_has_been_up_for_seven_weeks_is_not_lost(bench: Bench) -> None:
    bench.tic.has_been_up(2**32 / 1000 - 2)
    bench.controller.connect()
    for _ in range(20):
        bench.controller.status()
        bench.pass_time(POLL_S)
