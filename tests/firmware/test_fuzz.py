"""A million frames at the controller, most of them wrong: fuzz/fuzz_controller.c."""

import json
import subprocess

import pytest

from firmware import protocol as p
from firmware.controller_host import build, missing_compiler
from firmware.protocol import Ramp
from tools import require

FRAMES = 1_000_000
LONGEST_S = 300

LISTS = Ramp([(20_000, 1, 0), (14_142, 2, -2595), (10_000, 300, -20)], 2000, [(20_000, 2, -5858), (11_547, 40, -200)])
SHORT = Ramp([(5000, 60, -30)], 3000, [(5000, 60, -30)])
FAST = Ramp([(4000, 20, -150)], 1000, [])
FORMULAS = [
    p.with_header(1, bytes.fromhex(constants))
    for constants in (
        "0090010000020000380100000000710200129be8a1003b584c190171020034f304b54035da7310233e3702e2730302233e3703e273030300"
        "00000100001a060034f304b56b7f454910ae5857028b750502ae5857038b750503000000010000",
        "01900100000100000000000100000000000000000000000000000071020034f304b54035da7310233e3702e2730302233e3703e273030300"
        "000001000071020034f304b54035da7310233e3702e2730302233e3703e2730303000000010000",
    )
]
"""At 2 MHz from rest to 5000 steps/s with 20,000 steps/s^2; down with 8000 and with as much."""
IMAGES = [
    LISTS.image(),
    SHORT.image(2),
    p.image_of([LISTS.packed(), SHORT.packed()], [0, 1, 1]),
    FAST.image(4, fast=True),
    Ramp([(900, 10, -30)], 600, [(700, 5, -2)]).image(fast=True),
    p.image_of(FORMULAS, [0, 1, 1]),
    p.image_of([FORMULAS[0], FAST.packed()], [1, 0]),
]
REQUESTS = {
    *(p.HELLO, p.STATUS, p.REPORT, p.TRACE, p.BEGIN, p.DATA, p.END, p.COMMIT, p.READ, p.TRY, p.ROLL_BACK),
    *(p.READ_SETTINGS, p.WRITE_SETTINGS, p.MOVE_BY, p.MOVE_TO, p.RUN, p.LINE, p.SET_POSITION, p.ZERO, p.STOP, p.HALT),
}

OF_INPUTS = {p.ACKNOWLEDGE, p.HOME, p.READ_LIMITS, p.WRITE_LIMITS}


@pytest.mark.parametrize("with_inputs", [False, True])
def test_a_million_frames(*, with_inputs: bool) -> None:
    require(*missing_compiler())
    command = [str(build("fuzz", with_inputs=with_inputs)), str(FRAMES), "1", *(image.hex() for image in IMAGES)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S, check=False)
    assert result.returncode == 0, result.stderr
    reached = json.loads(result.stdout)
    assert reached["frames"] == FRAMES
    accepted = {int(kind): times[1] for kind, times in reached.items() if kind.isdecimal()}
    assert set(accepted) == REQUESTS | (OF_INPUTS if with_inputs else set())
    assert min(accepted.values()) > FRAMES / 1000
