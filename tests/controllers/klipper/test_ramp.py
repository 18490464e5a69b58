"""The ramp that Klipper plays, against the tests' own printer, and what a design gives it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.conftest import Clock
from controllers.klipper.bench import Bench, by
from controllers.klipper.printer import CONFIG, MACROS
from designs import design
from stepramp.controllers.klipper.compression import packed_s
from stepramp.controllers.klipper.own_ramp import instants_s, own_ramp, peak_speed
from stepramp.controllers.klipper.read_settings import read_settings
from stepramp.controllers.own_ramp import Beside
from stepramp.errors import Rejected

FILES = {"printer.cfg": CONFIG, "macros/start.cfg": MACROS}


@given(st.integers(1, 3000), st.floats(1, 1e5), st.floats(1, 1e6), st.sampled_from([0.0, 0.3, 0.5, 0.9]))
def test_the_ramp_is_the_trapezoid(steps: int, speed: float, gain: float, ratio: float) -> None:
    instants, lasts_s = instants_s(steps, speed, gain, ratio)
    waits = np.diff(instants, append=lasts_s)
    assert waits.shape == (steps,)
    assert (waits > 0).all()
    top = peak_speed(steps, speed, gain, ratio)
    # By integrating the speed: up to the top, along, and down again.
    grid = np.linspace(0, steps, 20_001)
    v = np.minimum(np.sqrt(2 * gain * np.minimum(grid, steps - grid)), top)
    middle = (v[1:] + v[:-1]) / 2
    passed = np.concatenate(([0.0], np.cumsum(np.diff(grid) / middle)))
    at = np.interp(np.arange(steps) + 0.5, grid, passed)
    assert waits[:-1] == pytest.approx(np.diff(at), rel=0.02, abs=passed[-1] * 1e-3)
    assert waits.max() <= passed[-1] * 1.01
    # The last one is but the way of half a step.
    assert all(1 / waits[:-1] <= top * (1 + 1e-9))


@given(st.integers(1, 3000), st.floats(1, 1e5), st.floats(1, 1e6))
def test_each_step_comes_early_and_by_no_more_than_klipper_lets_it(steps: int, speed: float, gain: float) -> None:
    instants, _ = instants_s(steps, speed, gain)
    made = packed_s(instants)
    assert made.shape == (steps,)
    early, before = instants - made, np.diff(instants, prepend=instants[0] - 1)
    cycle = 1 / 16e6
    assert (early > -1e-9).all()
    assert (early < np.minimum(25e-6, before / 2) + 2 * cycle).all()
    assert (np.diff(made) > 0).all()


def test_steps_are_packed_into_few_rows() -> None:
    instants, _ = instants_s(20_000, 20_000, 100_000)
    cycles = np.rint(np.diff(packed_s(instants)) * 16e6)
    bends = np.diff(cycles)
    # A row begins where intervals don't go on to change by the same.
    rows = np.count_nonzero(np.diff(bends)) / 2
    assert rows < 200
    # Along the plateau all are the same: 50 µs.
    assert np.count_nonzero(cycles == 800) > 10_000


def test_even_steps_stay_even_and_a_row_of_them_ends_at_65535() -> None:
    # In the midst of clock cycles, so that float64 doesn't round to another one.
    made = packed_s((np.arange(1, 100_001) * 2000 + 0.5) / 16e6)
    assert np.unique(np.rint(np.diff(made) * 16e6)).tolist() == [2000]


def test_so_long_a_move_takes_the_printer(clock: Clock) -> None:
    for ratio, steps in ((0.5, 4000), (0.0, 4000), (0.5, 10_000)):
        files = {**FILES, "printer.cfg": CONFIG.replace("[printer]", f"[printer]\nminimum_cruise_ratio: {ratio}")}
        bench = Bench(clock, files)
        bench.connected().move_by([by(steps)])
        began_s = clock.now_s
        while bench.printer.queue:
            clock.now_s += 0.001
            bench.printer.advance()
        lasted_s = clock.now_s - began_s - 0.25
        assert instants_s(steps, 24_000, 240_000, ratio)[1] == pytest.approx(lasted_s, abs=0.02)
        assert bench.printer.fastest * 80 == pytest.approx(peak_speed(steps, 24_000, 240_000, ratio), rel=0.01)


def test_beside_the_design() -> None:
    asked = design(move__steps=4000, ramp__base_speed_steps_per_s=100, ramp__deceleration_steps_per_s2=4000)
    beside = Beside.of(asked, own_ramp)
    losses = " ".join(beside.own.losses)
    for words in ("Base speed 100 steps/s is not kept: Klipper starts from 0", "Acceleration 5,000", "25 µs", "0.5"):
        assert words in losses
    # A row of 25 µs at 1 ms a step.
    assert float(np.median(np.abs(beside.relative_error))) < 0.03
    short = Beside.of(design(move__steps=100), own_ramp)
    assert any("This move stays at 500 steps/s" in loss for loss in short.own.losses)


def test_a_move_that_is_too_long_is_rejected_by_its_field() -> None:
    with pytest.raises(Rejected, match=r"move.steps"):
        own_ramp(design(move__steps=4_000_001), 80.0)


def test_a_configuration_becomes_designs() -> None:
    axes = read_settings(CONFIG, design())
    assert [axis.name for axis in axes] == ["X", "Y", "Z"]
    x, _, z = (axis.design for axis in axes)
    assert (x.axis.full_steps_per_rev, x.axis.microsteps, x.axis.travel_per_rev) == (200, 16, 40)
    assert (x.ramp.slew_speed_steps_per_s, x.ramp.acceleration_steps_per_s2) == (24_000, 240_000)
    assert (z.axis.travel_per_rev, z.ramp.slew_speed_steps_per_s, z.ramp.acceleration_steps_per_s2) == (8, 2000, 40_000)
    assert axes[1].design.axis.full_steps_per_rev == 400
    assert (x.name, x.ramp.base_speed_steps_per_s) == ("Klipper axis X", 0)


def test_a_byte_order_mark_before_a_configuration() -> None:
    assert read_settings(f"\ufeff{CONFIG}", design()) == read_settings(CONFIG, design())


@pytest.mark.parametrize("text", ["", "$100=250.000\n", "axes:\n  x:\n", "[printer]\nname: HP\n", "[a\n", "M203 X1"])
def test_what_is_no_configuration_is_left_to_others(text: str) -> None:
    assert read_settings(text, design()) == []


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("cartesian", "delta", "kinematics are delta"),
        ("max_velocity: 300", "max_velocity: 3OO", r"max_velocity of \[printer\] is '3OO'; allowed: a number from 0.0"),
        ("max_velocity: 300", "max_velocity: 1e9", "slew speed of axis X is 8e"),
    ],
)
def test_a_configuration_that_no_design_can_be_made_of(old: str, new: str, words: str) -> None:
    with pytest.raises(Rejected, match=words):
        read_settings(CONFIG.replace(old, new), design())


CUT = CONFIG[: CONFIG.index("[printer]")] + CONFIG[CONFIG.index("[stepper_x]") :] + "[printer]\nkinematics: cartesian\n"
"""With [printer] as its last section."""


def test_a_configuration_that_is_cut_off_says_where_it_ends_and_what_stands_for_what() -> None:
    begun = f"{CUT}max_velocity: 300\nmax_accel: 3"
    *_, z = read_settings(begun, design())
    assert z.design.ramp.acceleration_steps_per_s2 == 3 * 400
    assert z.remarks == (
        "max_z_velocity isn't told: it is taken for max_velocity, as Klipper does.",
        "max_z_accel isn't told: it is taken for max_accel, as Klipper does.",
        "What it includes isn't in it, and may say otherwise: macros/*.cfg.",
        "The text ends within [printer], at max_accel: 3: if it was cut off there, its last number may lack digits, "
        "and options that would follow are missing.",
    )
    for text in (begun.replace("\n", "\r"), "".join(f"\n  {line}" for line in begun.splitlines())):
        x, *_ = read_settings(text, design())
        assert x.remarks[-1].startswith("The text ends within [printer], at max_accel: 3"), text
    whole = "max_velocity: 300\nmax_z_velocity: 5\nmax_z_accel: 100\nmax_accel: 3000"
    for end in ("\n", "\r\n", "  # as it came", "\n[fan]\nmax_power: 1"):
        x, *_ = read_settings(f"{CUT}{whole}{end}", design())
        assert x.remarks == ("What it includes isn't in it, and may say otherwise: macros/*.cfg.",), end


@pytest.mark.parametrize("end", ["gear_ratio:", "gear_ratio: ", "gear_ratio = ", "gear_ratio: 80:20,"])
def test_a_configuration_that_is_cut_off_before_a_value_says_so(end: str) -> None:
    *_, z = read_settings(CONFIG[: CONFIG.index("gear_ratio")] + end, design())
    assert z.remarks[-1] == (
        f"The text ends within [stepper_z], at {end.strip()} as it seems in the midst of a value: if it was cut off "
        "there, the rest of that value and options that would follow are missing."
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (CUT[: CUT.index("[printer]")], r"^\[printer\] isn't there \(nor is what is included\); allowed: a whole conf"),
        ("[stepper_x]\nmicrosteps: 16\n", r"^\[printer\] isn't there; allowed: a whole configuration of Klipper, with"),
        ("[stepper_x]\nmicrosteps: 16\n[printer]\nmax_velocity: 9", "its kinematics are not told"),
        (f"{CUT}max_velo", "The configuration can't be read: .*max_velo"),
    ],
)
def test_a_configuration_that_lacks_something_is_known_as_one(text: str, words: str) -> None:
    with pytest.raises(Rejected, match=words):
        read_settings(text, design())


@given(st.floats(0.01, 500), st.floats(1, 50_000))
def test_pushing_what_was_read_changes_nothing(speed: float, gain: float) -> None:
    given_speed, given_gain = f"{speed:.6f}", f"{gain:.6f}"
    text = CONFIG.replace("max_velocity: 300", f"max_velocity: {given_speed}")
    text = text.replace("max_accel: 3000", f"max_accel: {given_gain}").replace("max_z_velocity: 5\n", "")
    bench = Bench(Clock(), {**FILES, "printer.cfg": text.replace("max_z_accel = 100\n", "")})
    controller = bench.connected()
    designs = [axis.design for axis in read_settings(controller.backup(), design())]
    assert controller.preview_push(designs).same
    assert controller.preview_push(designs[1:2], 1).same
