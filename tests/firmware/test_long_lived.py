"""What counts, past the end of its range: played for 75 minutes, in which micros() comes round as well."""

import itertools
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from firmware import protocol as p
from firmware.controller.client import Controller, messages_of, started
from firmware.controller_host import Driver
from firmware.host import Host, missing_compiler
from firmware.machine.ramps import QUICK, SHARP
from firmware.motion import SLOW_HZ, Machine, build, image_of
from firmware.protocol import Ramp, Report, Status, for_axes
from tools import require

MINUTES = 75
FIRMWARE = Path(__file__).parents[2] / "firmware"
CLOCK = Path(__file__).parent / "clock"
MS_TICKS = SLOW_HZ // 1000
LONGEST_INTERVAL = 2**28 - 1
"""As the protocol has it: 134 s."""
FAST = Ramp([(80_000, 20, -2000)], 16_000, [(80_000, 20, -2000)])
"""1000 steps/s in ticks of the fast clock."""


@pytest.fixture(scope="module")
def machine_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    require(*missing_compiler())
    return build(tmp_path_factory.mktemp("motion"))


@pytest.fixture(scope="module")
def clock_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    require(*missing_compiler())
    program = tmp_path_factory.mktemp("clock") / "clock"
    flags = ["-std=c99", "-g", "-O1", "-Wall", "-Wextra", "-Werror", "-fsanitize=address,undefined"]
    includes = [f"-I{CLOCK}", f"-I{FIRMWARE / 'controller'}", f"-I{FIRMWARE / 'src'}"]
    sources = [str(FIRMWARE / "controller" / "clock.c"), str(CLOCK / "driver.c")]
    subprocess.run(["gcc", *flags, "-fno-sanitize-recover=all", *includes, "-o", str(program), *sources], check=True)
    return program


@pytest.fixture
def driver() -> Iterator[Driver]:
    require(*missing_compiler())
    with Driver() as running:
        yield running


@pytest.mark.parametrize("longest", [1, 150, 255])
def test_the_chips_clock_loses_nothing(clock_program: Path, longest: int) -> None:
    """Its timer comes round each 16 ms, its ticks each 4.2 s, its milliseconds each 65.5 s."""
    asked = f"{MINUTES * 60} {longest}"
    told = subprocess.run([clock_program], input=asked, capture_output=True, text=True, check=True).stdout
    assert told.split() == ["0", "0"]


def test_a_run_of_75_minutes_past_the_last_position(machine_program: Path) -> None:
    """100 steps/s, and beside it the slowest there is, backward: no interval is off by a tick."""
    begin = 2**31 - 225_000
    with Host(machine_program) as host:
        machine = Machine(host, image_of(QUICK, QUICK), round_ticks=MS_TICKS)
        machine.do("position", 3, begin, -(2**31) + 10)
        machine.ask("run", 3, SLOW_HZ // 100, -LONGEST_INTERVAL)
        machine.do("wait", MINUTES * 60 * SLOW_HZ)
        assert machine.report().position - (begin - 2**32) in (MINUTES * 6000 - 1, MINUTES * 6000)
        machine.do("stop", 1)
        machine.do("halt", 2)
        target = machine.report().target
        machine.rest()
        report, (fast, slow, *_) = machine.report(), machine.all_steps()
        assert set(fast.intervals) == {SLOW_HZ // 100}
        assert set(slow.intervals) == {LONGEST_INTERVAL}
        assert -slow.travel == len(slow.times) == MINUTES * 60 * SLOW_HZ // LONGEST_INTERVAL + 1
        assert machine.report(1).position == -(2**31) + 10 + slow.travel + 2**32
        assert report.position == target == begin + fast.travel - 2**32
        assert (report.steps_made, report.starved) == (fast.travel, 0)
        assert machine.move(target + 10, mask=1) == (0, 0)
        machine.rest()
        assert machine.steps().travel == 10


def test_a_trace_of_every_65535th_step(machine_program: Path) -> None:
    """What is left to the next one has 16 bits."""
    k = 65_535
    with Host(machine_program) as host:
        machine = Machine(host, image_of(SHARP), round_ticks=1000)
        machine.do("trace", 0, k)
        machine.move(2 * k + 1)
        machine.rest()
        times = machine.steps().times
        assert machine.traced() == [(i + 1, times[i] % 2**16) for i in (0, k, 2 * k)]


def passed(controller: Controller, milliseconds: int) -> list[bytes]:
    """Let time pass; return the notices that came in it, and keep what has not ended yet."""
    sent = controller.half_frame + bytes.fromhex(controller.driver.ask("pass", milliseconds).replace("-", ""))
    whole, _, controller.half_frame = sent.rpartition(b"\0")
    return messages_of(whole + b"\0") if whole else []


def asked(controller: Controller) -> tuple[Status, list[bytes]]:
    """Return the status, and the notices that came with it."""
    frame = controller.half_frame + controller.driver.send(controller.frame(p.STATUS, b"\0"))
    controller.half_frame = b""
    messages = messages_of(frame)
    (reply,) = [message for message in messages if message[0] == p.STATUS | 0x80]
    return Status.unpack(reply[5:]), [message for message in messages if message[0] == p.REPORT_NOTICE]


def test_75_minutes_of_a_session(driver: Driver) -> None:
    """A run that is asked for goes on, its reports come each second, and it ends when nobody asks any more."""
    controller = started(driver)
    controller.push(FAST.image(2, fast=True))
    controller.ok(p.RUN, for_axes({0: 160_000}))
    controller.ok(p.REPORT, b"\1")
    notices = []
    for _ in range(60 * MINUTES * 10 // 9):
        notices += passed(controller, 900)
        status, more = asked(controller)
        notices += more
        assert status.axis_state == p.IN_MOTION
    reports = [Report.unpack(notice[4:]) for notice in notices]
    steps = [after.positions[0] - before.positions[0] for before, after in itertools.pairwise(reports)]
    late = [(after.time_ms - before.time_ms) % 2**16 for before, after in itertools.pairwise(reports)]
    assert len(reports) in range(60 * MINUTES, 60 * MINUTES + 60)
    assert min(late) >= 990
    assert max(late) <= 1010
    assert min(steps[1:]) >= 99
    assert max(steps) <= 101
    controller.ok(p.REPORT, b"\0")
    passed(controller, 1700)
    status = controller.status()
    assert (status.axis_state, status.starved) == (p.IDLE, 0)
    assert controller.steps()[0] == status.position


def test_a_run_that_nobody_asks_for_ends_in_time_wherever_the_clock_is(driver: Driver) -> None:
    """1.0 to 1.3 s later, at any of 16 places of the 65.5 s in which the milliseconds come round."""
    controller = started(driver)
    controller.push(FAST.image(2, fast=True))
    for _ in range(16):
        controller.ok(p.RUN, for_axes({0: 16_000}))
        passed(controller, 300)
        at = controller.status().position
        passed(controller, 3796)
        status = controller.status()
        assert status.axis_state == p.IDLE
        assert 1000 <= status.position - at <= 1340  # what is queued and the ramp down come after it


def test_a_move_from_the_first_position_to_the_last_goes_through_all_others(machine_program: Path) -> None:
    with Host(machine_program) as host:
        machine = Machine(host, image_of(QUICK))
        machine.do("position", 1, -(2**31))
        assert machine.move(2**31 - 1) == (0, 0)
        machine.do("wait", 1000 * MS_TICKS)
        report = machine.report()
        machine.do("halt", 1)
        assert report.target == 2**31 - 1
        assert report.position == -(2**31) + report.steps_made
        assert report.steps_made > 900
