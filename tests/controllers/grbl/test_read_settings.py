"""What a grbl has, as designs: listings as it tells them, and as people copy them."""

from __future__ import annotations

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from controllers.grbl.test_pushes import fields_of
from designs import design
from stepramp.controllers.grbl.ramp import GrblRamp
from stepramp.controllers.grbl.read_settings import read_settings
from stepramp.controllers.grbl.settings import Settings, kept_acceleration
from stepramp.errors import Rejected


def test_a_listing_becomes_designs() -> None:
    text = "; comment\n$100=80.000 (x, step/mm)\n$110=3000.000\n$120=200.000\n$101=0\n$111=1\n$121=1\nok"
    [axis] = read_settings(text, design())
    assert axis.name == "X"
    # 400 steps a turn of 5 mm; 3000 mm/min · 80 / 60; 200 mm/s² · 80.
    assert (axis.design.axis.travel_per_rev, axis.design.axis.travel_unit) == (5.0, "mm")
    assert axis.design.ramp.slew_speed_steps_per_s == 4000
    assert axis.design.ramp.acceleration_steps_per_s2 == 16_000
    assert axis.design.move == design().move
    assert "200 times 2 steps a turn, 5 mm, are 80 steps/mm" in axis.remarks[0]
    assert axis.remarks[1:] == ("Axis Y is left out: with $101=0 it can't move.",)
    assert read_settings("G1 X5", design()) == []


@given(st.decimals("5", "3200", places=3), st.decimals("1", "9999", places=3), st.decimals("0.1", "99999", places=3))
@example("5", "1", "9220.819")
@example("5", "1", "81119.942")
def test_pushing_what_was_read_changes_nothing(per_mm: object, rate: object, gain: object) -> None:
    listing = f"$100={per_mm}\n$110={rate}\n$120={gain}"
    if float(str(rate)) / 60 * float(str(per_mm)) > 900_000:
        return
    [axis] = read_settings(listing, design())
    settings = Settings.of(listing.splitlines()).axis(0)
    assert settings is not None
    pushed = GrblRamp.of(axis.design, settings.steps_per_mm, most_per_mm=settings.most_steps_per_mm)
    # As grbl keeps them: beyond four digits before the point several texts of three decimals are the same to it.
    assert (pushed.rate, kept_acceleration(pushed.acceleration)) == (
        settings.most_rate,
        kept_acceleration(settings.acceleration),
    )


@pytest.mark.parametrize(
    "line",
    [
        "{} = {}",
        "{}={} ; x steps",
        "{}={};x steps",
        "{}={}\tsteps per mm",
        "{}={} (x, step/mm)",
        ">>> {}={}",
        "[22:10:11] {}={}",
        "22:10:11.123 < {}={}",
        "$$ < {}={}",
        "[PRB] {} = {} # mine",
        "  Recv: {}={}\r",
    ],
)
def test_a_listing_is_read_as_people_copy_it(line: str) -> None:
    listed = [("$100", "80.000"), ("$110", "3000.000"), ("$120", "200.000")]
    [axis] = read_settings("\n".join(line.format(*each) for each in listed), design())
    assert (axis.design.axis.travel_per_rev, axis.design.ramp.slew_speed_steps_per_s) == (5.0, 4000)


def test_what_is_listed_twice_is_told() -> None:
    [axis] = read_settings("$100=80\n$110=3000\n$120=200\n$120=200\n$100=90.5", design())
    assert axis.remarks[-1] == "$100=80 and $100=90.5 are listed: the last holds."
    assert axis.design.axis.steps_per_rev / axis.design.axis.travel_per_rev == pytest.approx(90.5)


def test_a_comma_for_the_point_is_told() -> None:
    [(_, value, allowed)] = fields_of(lambda: read_settings("$100=80,000\n$110=3000\n$120=200", design()))
    assert (value, allowed[-41:]) == ("$100=80,000", "numbers above 0, with a point for the comma"[-41:])


def test_an_axis_of_which_a_setting_is_missing_is_told() -> None:
    text = "$101=80\n$110=3000\n$111=3000\n$120=200\n$121=200\n$132=200"
    [axis] = read_settings(text, design())
    assert (axis.name, axis.remarks[1:]) == ("Y", ("Axis X is left out: $100 isn't there.",))
    told = fields_of(lambda: read_settings("$100=80.000 $110=3000 $120=200", design()))
    assert told == [("text", "without $110, $120", "all settings of axis X, a line each")]


WHOLE = "".join(f"${first + axis}={500 - first}.000\n" for first in (100, 110, 120, 130) for axis in range(3))


@pytest.mark.parametrize(("cut", "shown"), [("$122=3", "$122=3"), ("$122=380.0\n", "$122=380.0"), ("$122=", "$122=")])
def test_a_listing_that_is_cut_off_within_a_number_gives_no_wrong_one(cut: str, shown: str) -> None:
    axes = read_settings(WHOLE[: WHOLE.index("$122")] + cut, design())
    assert [axis.name for axis in axes] == ["X", "Y"]
    assert axes[0].remarks[-1] == f"Axis Z is left out: {shown} is cut off, as it seems: the others have 3 decimals."
    with pytest.raises(Rejected, match=r"^\$120=38 is cut off, as it seems: the others have 3 decimals; allowed: all"):
        read_settings(WHOLE[: WHOLE.index("$120")] + "$120=38", design())


@pytest.mark.parametrize(
    "end", ["$122=380.000", "$122=3\nok", "$122=3 (z accel, mm/sec^2)", "$122=380.000\n$130=370.000\n$131=3"]
)
def test_a_listing_that_ends_otherwise_is_whole(end: str) -> None:
    axes = read_settings(WHOLE[: WHOLE.index("$122")] + end, design())
    assert [axis.name for axis in axes] == ["X", "Y", "Z"]
    typed = "$100=80.5\n$110=3000\n$120=20"
    assert [axis.name for axis in read_settings(typed, design())] == ["X"], "others differ: a person has written it"


def test_settings_that_no_design_has() -> None:
    [(field, _, allowed)] = fields_of(lambda: read_settings("$100=3200\n$110=99999999\n$120=5", design()))
    assert field == "text"
    assert "settings of axis X that a design can have" in allowed


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("$100=80\n$110=3000", "$120 isn't there; allowed: all settings of axis X, a line each."),
        ("$100=80", "$110, $120 aren't there; allowed: all settings of axis X, a line each."),
        ("$100=80\n$110=0\n$120=5", "$110=0 is listed; allowed: settings that axis X can move with: numbers above 0."),
        (
            "$100=3200\n$110=99999999\n$120=5",
            "With $110=99999999 the slew speed of axis X is 5,333,333,333; allowed: a number from 0.001 to "
            "1,000,000 steps/s.",
        ),
    ],
)
def test_what_is_refused_is_told_by_its_own_name(text: str, said: str) -> None:
    with pytest.raises(Rejected) as refused:
        read_settings(text, design())
    assert str(refused.value) == said


@pytest.mark.parametrize("listed", ["$120=0", "$110=-5", "$100=nan", "$120=fast"])
def test_a_listing_of_a_grbl_that_can_t_move_is_told_by_what_keeps_it(listed: str) -> None:
    text = f"$100=80\n$110=3000\n$120=10\n{listed}\nok"
    [(field, value, allowed)] = fields_of(lambda: read_settings(text, design()))
    assert (field, value, allowed) == ("text", listed, "settings that axis X can move with: numbers above 0")
