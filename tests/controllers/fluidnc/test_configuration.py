"""FluidNC's configuration: read as FluidNC reads it, and as designs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.fluidnc.emulator import FILE
from designs import design
from stepramp.controllers.fluidnc.configuration import Configuration
from stepramp.controllers.fluidnc.push import PushPlan
from stepramp.controllers.fluidnc.read_settings import read_settings
from stepramp.errors import Rejected


def test_a_configuration_is_read_as_fluidnc_reads_it() -> None:
    configuration = Configuration.of(FILE.splitlines())
    assert configuration.axes == ["x", "y", "z"]
    assert configuration.items["uart1/mode"] == "8N1"
    assert configuration.items["huanyang/speed_map"] == "0=0% 0=25% 6000=25% 24000=100%"
    assert configuration.items["axes/x/motor0/limit_neg_pin"] == "gpio.39:low"
    assert configuration.items["macros/macro0"] == "$SD/Run=lift.nc & G0 X0"
    # Of homing there is a rate, too.
    assert configuration.items["axes/x/homing/seek_mm_per_min"] == "200.000"
    axis = configuration.axis(0)
    assert axis is not None
    assert (axis.steps_per_mm, axis.most_rate, axis.acceleration) == (250, 500, 10)
    assert configuration.axis(3) is None


@pytest.mark.parametrize("value", ["NO PIN", "nan", "-1", "0", "5e-324", "fast", "1e99", "8E1", "1_000", "٨٠", "0x50"])
def test_an_axis_without_sense(value: str) -> None:
    text = FILE.replace("steps_per_mm: 250", f"steps_per_mm: {value}")
    assert Configuration.of(text.splitlines()).axis(0) is None
    with pytest.raises(Rejected) as caught:
        read_settings(text, design())
    told = [(each.field, each.value, each.allowed) for each in caught.value.rejections]
    assert told == [
        ("text", f"axes/{letter}/steps_per_mm: {value}", "axes with numbers from 0.001 to 100,000") for letter in "xyz"
    ]


def test_a_configuration_that_is_indented_by_tabs_is_refused_by_that() -> None:
    with pytest.raises(Rejected, match="items that are indented by blanks: FluidNC takes no tabs"):
        read_settings(FILE.replace("  ", "\t"), design())


@given(st.text(st.characters(codec="utf-8"), max_size=200))
def test_any_text_is_read_or_left_alone(text: str) -> None:
    assert Configuration.of(text.splitlines()) == Configuration.of(text.splitlines())


def test_a_configuration_becomes_designs() -> None:
    x, y, z = read_settings(FILE, design())
    assert [axis.name for axis in (x, y, z)] == ["X", "Y", "Z"]
    assert (x.design.axis.microsteps, x.design.axis.travel_per_rev) == (16, 12.8)
    assert (y.design.axis.microsteps, y.design.axis.travel_per_rev) == (2, 1.6)
    assert x.design.ramp.slew_speed_steps_per_s == pytest.approx(500 * 250 / 60)
    assert x.design.ramp.acceleration_steps_per_s2 == 2500
    assert "200 times 16 steps a turn, 12.8 mm, are 250 steps/mm" in x.remarks[0]
    for text in ("", "$100=250\n", "[printer]\nkinematics: cartesian\n", "axes: 3\n", "max_speed: 2000\n"):
        assert read_settings(text, design()) == []


ENDS = "The text ends within axis"
MISSING = "Axis X is found: if it was cut off, others are missing, and its last number may lack digits."


@pytest.mark.parametrize(
    ("upto", "said"),
    [
        (
            "steps_per_mm: 250\n    max_rate_mm_per_min: 5",
            [
                "axes/x/acceleration_mm_per_sec2 is taken as 25, as FluidNC does where it isn't told.",
                f"{ENDS} X, at axes/x/max_rate_mm_per_min, before anything of its motor0. {MISSING}",
            ],
        ),
        (
            "max_travel_mm: 200",
            [f"{ENDS} X, at axes/x/max_travel_mm, before anything of its motor0. {MISSING}"],
        ),
        ("microsteps: 16", [f"{ENDS} X, at axes/x/motor0/tmc_2209/microsteps. {MISSING}"]),
        ("  y:", [f"{ENDS} Y, at axes/y, before anything of its motor0. {MISSING}"]),
        ("macro0:", []),
    ],
)
def test_a_configuration_that_is_cut_off_says_what_was_found_of_it(upto: str, said: list[str]) -> None:
    for axis in read_settings(FILE[: FILE.index(upto) + len(upto)], design()):
        assert list(axis.remarks[1:]) == said


@given(st.decimals("1", "5000", places=3), st.decimals("10", "99999", places=3), st.decimals("1", "99999", places=3))
def test_pushing_what_was_read_changes_nothing(per_mm: object, rate: object, gain: object) -> None:
    text = f"axes:\n  x:\n    steps_per_mm: {per_mm}\n    max_rate_mm_per_min: {rate}\n"
    text += f"    acceleration_mm_per_sec2: {gain}\n"
    if not 1 < float(str(rate)) / 60 * float(str(per_mm)) < 900_000:
        return
    present = Configuration.of(text.splitlines())
    axis = present.axis(0)
    assert axis is not None
    [read] = read_settings(text, design())
    plan = PushPlan.of([read.design], 0, [axis])
    assert plan.preview(present).same
    assert [np.float32(each) for each in plan.wanted.values()] == [axis.acceleration, axis.most_rate]
