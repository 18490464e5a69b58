"""The firmware keeps to its budget of memory and time, budget.toml, which in turn keeps close to the firmware."""

import subprocess
import tomllib
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from firmware.protocol import COMMIT, READ_SETTINGS, STORED, WRITING, Ramp, Settings
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
)
from simulator.avr import build_firmware, build_harness, missing_tools
from tools import require

BUDGET = tomllib.loads(Path(__file__).with_name("budget.toml").read_text())
QUEUE_BYTES = 512
"""They lie before the linker's sections."""
GENEROUS = 1.05
FOUR = RampDesign(30_019, 900_000, 900_000)
LINE = RampDesign(90_396, 4_500_000, 4_500_000)


def section_bytes() -> dict[str, int]:
    lines = subprocess.run(
        ["avr-size", "-A", str(build_firmware())], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    return {words[0]: int(words[1]) for line in lines if len(words := line.split()) == 3 and words[1].isdigit()}


def keeps_to(name: str, measured: int, budget: int) -> None:
    assert measured <= budget, f"{name}: {measured}, the budget is {budget}"
    assert budget <= max(GENEROUS * measured, measured + 4), f"{name}: {measured}, but the budget is {budget}"


@pytest.fixture(scope="module", autouse=True)
def tools() -> None:
    require(*missing_tools())
    build_harness()


def test_flash() -> None:
    sections = section_bytes()
    keeps_to("flash", sections[".text"] + sections[".data"], BUDGET["memory"]["flash"])


def test_static_ram() -> None:
    sections = section_bytes()
    static = sum(sections.get(name, 0) for name in (".data", ".bss", ".noinit")) + QUEUE_BYTES
    keeps_to("static RAM", static, BUDGET["memory"]["static_ram"])


def everything(client: BusyClient) -> None:
    """What uses the stack most: storing, reading, settings, with motors before and after."""
    assert client.expect_ok(READ_SETTINGS) == Settings().packed()
    client.keep_busy()
    client.expect_ok(COMMIT)
    client.wait_while(WRITING)
    client.read(STORED)
    client.push(Ramp([(4000, 30, -50)], 1000, []))


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> list[Played]:
    """The hardest work that the firmware is built for: four axes, and a line of four."""
    folder = tmp_path_factory.mktemp("budget")
    work: list[tuple[Any, ...]] = [
        (image([FOUR] * 4), move_by(6000, -6000, 5000, -5000)),
        (image([LINE] * 4), along_a_line(20_000, -19_999, 12_345, 20_000)),
    ]
    return at_the_same_time(
        *(partial(play, partial(controller_in, folder / str(i)), *one, everything) for i, one in enumerate(work))
    )


def test_stack(played: list[Played]) -> None:
    least = min(one.statistics["untouched_stack_bytes"] for one in played)
    budget = BUDGET["memory"]["untouched_stack"]
    assert budget <= least <= budget + 16, f"{least} bytes of the stack are untouched, the budget says {budget}"


@pytest.mark.parametrize("vector", BUDGET["longest_interrupt"])
def test_longest_interrupts(played: list[Played], vector: str) -> None:
    longest = max(one.statistics[vector]["longest"] for one in played)
    keeps_to(vector, longest, BUDGET["longest_interrupt"][vector])
