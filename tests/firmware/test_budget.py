"""The firmware keeps to its budget of memory and time, budget.toml, which in turn keeps close to the firmware."""

import subprocess
import tomllib
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from firmware.protocol import (
    COMMIT,
    READ_SETTINGS,
    REPORT,
    SLOW_HZ,
    STORED,
    TRACE,
    WRITING,
    Ramp,
    Settings,
    image_of,
    with_header,
)
from firmware.rig import (
    BusyClient,
    Played,
    RampDesign,
    along_a_line,
    at_the_same_time,
    controller_in,
    image,
    move_by,
    play,
    request,
)
from simulator.avr import build_firmware, build_harness, missing_tools
from stepramp.controllers.stepramp.formula_image import encode_formula
from stepramp.ramp.on_chip import OnChipRamp
from stepramp.shapes.constant import ConstantAcceleration as Slope
from tools import require

BUDGET = tomllib.loads(Path(__file__).with_name("budget.toml").read_text())
QUEUE_BYTES = 512
"""They lie before the linker's sections."""
GENEROUS = 1.05
FOUR = RampDesign(30_019, 900_000, 900_000)
LINE = {
    build: RampDesign(speed, 4_500_000, 4_500_000)
    for build, speed in (("memory", 88_395), ("memory_with_inputs", 86_956))
}
WIDE = RampDesign(1000, 20_000, 20_000)
GAUGE = Ramp([(4000, 6, 0), (2500, 20, 0), (1500, 40, 0)], 1000, [(4000, 6, 0), (2500, 20, 0), (1500, 40, 0)])
COMPUTED = image_of(
    [
        with_header(
            1, encode_formula(OnChipRamp.of(Slope(SLOW_HZ, 0, 1500, up), Slope(SLOW_HZ, 0, 1500, 9000), method))
        )
        for up, method in ((6000, "newton"), (9000, "first_order"), (6000, "compromise"))
    ],
    (0, 1, 2, 0),
)
"""Four axes whose ramps the chip computes."""


BUILDS = {"memory": (), "memory_with_inputs": ("INPUTS=yes",)}
"""Options of the Makefile, by the budget's tables."""


def section_bytes(build: str) -> dict[str, int]:
    elf = str(build_firmware(*BUILDS[build]))
    lines = subprocess.run(["avr-size", "-A", elf], capture_output=True, text=True, check=True).stdout.splitlines()
    return {words[0]: int(words[1]) for line in lines if len(words := line.split()) == 3 and words[1].isdigit()}


def keeps_to(name: str, measured: int, budget: int, generous: float = GENEROUS) -> None:
    assert measured <= budget, f"{name}: {measured}, the budget is {budget}"
    assert budget <= max(generous * measured, measured + 4), f"{name}: {measured}, but the budget is {budget}"


@pytest.fixture(scope="module", autouse=True)
def tools() -> None:
    require(*missing_tools())
    build_harness()


@pytest.mark.parametrize("build", BUILDS)
def test_flash(build: str) -> None:
    sections = section_bytes(build)
    keeps_to("flash", sections[".text"] + sections[".data"], BUDGET[build]["flash"])


@pytest.mark.parametrize("build", BUILDS)
def test_static_ram(build: str) -> None:
    sections = section_bytes(build)
    static = sum(sections.get(name, 0) for name in (".data", ".bss", ".noinit")) + QUEUE_BYTES
    keeps_to("static RAM", static, BUDGET[build]["static_ram"])


def everything(client: BusyClient) -> None:
    """What uses the stack most: storing, reading, settings, with motors before and after."""
    client.expect_ok(READ_SETTINGS)
    client.keep_busy()
    client.expect_ok(COMMIT)
    client.wait_while(WRITING)
    client.read(STORED)
    client.push(Ramp([(4000, 30, -50)], 1000, []))


@pytest.fixture(scope="module", params=BUILDS)
def build(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory, build: str) -> list[Played]:
    """The hardest work that the firmware is built for, in each of its modes, with reports and a trace."""
    folder = tmp_path_factory.mktemp("budget")
    work: list[tuple[Any, ...]] = [
        (image([FOUR] * 4), move_by(6000, -6000, 5000, -5000)),
        (image([LINE[build]] * 4), along_a_line(20_000, -19_999, 12_345, 20_000)),
        (COMPUTED, move_by(1500, -1500, 1400, -1400)),
        (image([WIDE] * 4), move_by(300, -300, 300, -300)),
        (GAUGE.image(3), move_by(400, -400, 300)),
    ]
    settings = {3: Settings(pulse_width_us=100), 4: Settings(outputs=1)}
    told = [request(REPORT, bytes([50])), request(TRACE, b"\0\1\0")]

    def job(number: int) -> Played:
        ramps, motion = work[number]
        make = partial(controller_in, folder / str(number), build=BUILDS[build])
        return play(make, ramps, *told, motion, everything, settings=settings.get(number))

    numbers = [number for number in range(len(work)) if work[number][0] is not COMPUTED or build == "memory"]
    return at_the_same_time(*(partial(job, number) for number in numbers))


def test_stack(played: list[Played], build: str) -> None:
    least = min(one.statistics["untouched_stack_bytes"] for one in played)
    budget = BUDGET[build]["untouched_stack"]
    assert budget <= least <= budget + 16, f"{least} bytes of the stack are untouched, the budget says {budget}"


@pytest.mark.parametrize("vector", BUDGET["longest_interrupt"])
def test_longest_interrupts(played: list[Played], vector: str) -> None:
    """Of axes and a line at their limits: wide pulses are waited for in the interrupt, and gauges are slow."""
    longest = max(one.statistics[vector]["longest"] for one in played[:2])
    # How often the longest come together is a matter of what else the machine does meanwhile.
    keeps_to(vector, longest, BUDGET["longest_interrupt"][vector], generous=1.5)
