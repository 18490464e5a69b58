"""Listings of a Marlin as people paste them: nothing of them is left out without a word."""

from __future__ import annotations

import pytest

from controllers.bench import only_rejection
from designs import design
from stepramp.controllers.marlin.read_settings import read_settings
from stepramp.errors import Rejected

LISTING = """echo:; Steps per unit:
echo:  M92 X80.00 Y80.00 Z400.00 E93.00
echo:; Max feedrates (units/s):
echo:  M203 X500.00 Y500.00 Z5.00 E25.00
echo:; Max Acceleration (units/s2):
echo:  M201 X500.00 Y500.00 Z100.00 E5000.00
echo:; Acceleration (units/s2) (P<print-accel> R<retract-accel> T<travel-accel>):
echo:  M204 P500.00 R1000.00 T500.00
ok
"""


def remarks(text: str) -> str:
    return " ".join(remark for axis in read_settings(text, design()) for remark in axis.remarks)


@pytest.mark.parametrize(
    "text",
    [
        "\n".join(f"Recv: {line}" for line in LISTING.splitlines()),
        "\ufeff" + LISTING,
        "\ufeff" + LISTING.partition("\n")[2].replace("echo:", ""),
        "\n".join(f"12:00:01.123 > {line}" for line in LISTING.splitlines()),
        "Send: M503\r\n" + "\r\n".join(f"Recv: {line}" for line in LISTING.splitlines()),
    ],
    ids=["a host's terminal", "a mark at its beginning", "before its first number", "a time", "with what was sent"],
)
def test_whatever_stands_before_its_lines(text: str) -> None:
    assert [axis.name for axis in read_settings(text, design())] == ["X", "Y", "Z", "E"]
    assert [each.design for each in read_settings(text, design())] == [
        each.design for each in read_settings(LISTING, design())
    ]


@pytest.mark.parametrize(
    ("old", "new", "value"),
    [
        ("M201 X500.00", "M201 X0.00", "M201 X0.00 is no number above 0"),
        ("M92 X80.00", "M92 X-80.00", "M92 X-80.00 is no number above 0"),
        ("M203 X500.00 ", "M203 ", "M203 X is not told"),
        ("M92 X80.00", "M92 X80,00", "M92 X80,00 Y80.00 Z400.00 E93.00"),
        ("M203 X500.00", "M203 X5e2", "M203 X5e2 Y500.00 Z5.00 E25.00"),
        ("echo:  M201 X500.00 Y500.00 Z100.00 E5000.00\n", "", "M201 X is not told"),
    ],
)
def test_a_bad_value_is_named(old: str, new: str, value: str) -> None:
    field, told, _ = only_rejection(lambda: read_settings(LISTING.replace(old, new), design()))
    assert (field, told) == ("text", value)


@pytest.mark.parametrize(
    ("old", "new", "read", "said"),
    [
        ("Y500.00 Z100", "Y0.00 Z100", "X", "Axis Y is left out: M201 Y0.00 is no number above 0."),
        ("Z400.00", "Z-400.00", "XY", "Axis Z is left out: M92 Z-400.00 is no number above 0."),
        ("Z400.00", "Z-400.00", "XY", "Axis E is left out: one before it is."),
        (" Z5.00 E25.00", "", "XY", "Axis Z is left out: M203 Z is not told. Axis E is left out: M203 E is not told."),
        ("Z400.00", "Z400.00 I10.00 J20.00", "XYZE", "Axes other than X, Y, Z and E are left out: I, J."),
        (
            " E93.00",
            "\necho:  M92 T0 E93.00\necho:  M92 T1 E95.00",
            "XYZE",
            "M92 T1 E95.00 is left out: of several extruders the first is read, not T1.",
        ),
    ],
)
def test_axes_that_are_left_out_are_named(old: str, new: str, read: str, said: str) -> None:
    text = LISTING.replace(old, new)
    assert "".join(axis.name for axis in read_settings(text, design())) == read
    assert said in remarks(text)


def test_of_what_is_told_again_the_last_counts_as_for_marlin_itself() -> None:
    """Of a listing with another one, or with what was set, behind it; that of a further extruder is another number."""
    again = "echo:  M92 X160.00 T1 E95.00\necho:  M201 X500.00 Y600.00\nM204 T300.00\n"
    axes = {axis.name: axis.design for axis in read_settings(LISTING + again, design())}
    scales = {name: each.axis.steps_per_rev / each.axis.travel_per_rev for name, each in axes.items()}
    assert scales == pytest.approx({"X": 160, "Y": 80, "Z": 400, "E": 93})
    assert axes["X"].ramp.acceleration_steps_per_s2 == pytest.approx(300 * 160)
    said = remarks(LISTING + again)
    assert "M92 X80.00 is left out: it is told again, as X160.00, which counts." in said
    assert "M201 Y500.00 is left out: it is told again, as Y600.00, which counts." in said
    assert "M201 X500.00 is left out" not in said
    assert "M204 T500.00 is left out" in said
    assert "M92 T1 E95.00 is left out: of several extruders" in said


def test_of_what_is_told_again_the_last_is_not_cut_off() -> None:
    cut = "echo:  M92 X80.00 Y80.00 Z400.00 E9\n"
    assert [axis.name for axis in read_settings(cut + LISTING, design())] == ["X", "Y", "Z", "E"]
    assert [axis.name for axis in read_settings(LISTING + cut, design())] == ["X", "Y", "Z"]


CUT = "is cut off, as it seems: the others of its line have 2 decimals"
PERHAPS = "if the text was cut off there, that number may lack digits, too"


@pytest.mark.parametrize(
    ("upto", "read", "said"),
    [
        # A paste that ends in the midst of a number, or between two.
        ("M201 X500.00 Y5", "X", f"Axis Y is left out: M201 Y5 {CUT}."),
        ("M201 X500.00 Y500.", "X", f"Axis Y is left out: M201 Y500. {CUT}."),
        ("M201 X500.00 Y500.00 Z100.00 E50", "XYZ", f"Axis E is left out: M201 E50 {CUT}."),
        ("M201 X500.00 Y500.00 Z", "XY", "Axis Z is left out: M201 Z is not told."),
        (
            "M201 X500.00 Y500.00",
            "XY",
            f"M201 ends with Y500.00, and tells no Z, E: {PERHAPS}.",
        ),
        (
            "M201 X5",
            "X",
            f"M201 ends with X5, and tells no Y, Z, E: {PERHAPS}.",
        ),
        ("Z100.00 E5000.00", "XYZE", "M204 T is not told: the acceleration is that of M201 alone."),
        ("M204 P500.00 R10", "XYZ", f"Axis E is left out: M204 R10 {CUT}."),
    ],
)
def test_a_listing_that_is_cut_off_gives_no_wrong_numbers_without_a_word(upto: str, read: str, said: str) -> None:
    text = LISTING[: LISTING.index(upto) + len(upto)]
    assert "".join(axis.name for axis in read_settings(text, design())) == read
    assert said in remarks(text)


def test_a_line_in_the_midst_that_is_cut_off_gives_none_either() -> None:
    """As of a terminal that drops what comes while it scrolls."""
    text = LISTING.replace(" Y500.00 Z5.00 E25.00", " Y3")
    assert [axis.name for axis in read_settings(text, design())] == ["X"]
    assert f"Axis Y is left out: M203 Y3 {CUT}. Axis Z is left out: M203 Z is not told." in remarks(text)
    # What somebody has written has as many decimals as it needs.
    by_hand = LISTING.replace("X500.00 Y500.00 Z5.00 E25.00", "X500 Y500.5 Z5.25 E25")
    assert len(read_settings(by_hand, design())) == 4


@pytest.mark.parametrize("upto", ["M204 P500.00 R1000.00 T5", "M204 P500.00 R1000.00 T500."])
def test_what_is_cut_off_of_all_axes_is_refused(upto: str) -> None:
    text = LISTING[: LISTING.index(upto) + len(upto)]
    field, told, allowed = only_rejection(lambda: read_settings(text, design()))
    assert (field, told) == ("text", f"M204 {upto.rpartition(' ')[2]} {CUT}")
    assert allowed == "M92, M203 and M201 of axis X, above 0 and not cut off"


def test_nothing_is_said_of_what_is_all_read() -> None:
    assert "left out" not in remarks(LISTING)
    assert read_settings("G21\nM92 X80\nG1 X5\n", design()) == []
    assert read_settings("M92 sets the steps per mm.\n", design()) == []


def test_m204_of_marlin_1_0() -> None:
    """There S holds for all moves, and T for retracts."""
    text = LISTING.replace("M204 P500.00 R1000.00 T500.00", "M204 S300.00 T700.00")
    x, y, z, e = read_settings(text, design())
    gains = [axis.design.ramp.acceleration_steps_per_s2 for axis in (x, y, z, e)]
    assert gains == [300 * 80, 300 * 80, 100 * 400, 700 * 93]
    assert "The acceleration is that of M204 S, 300 mm/s², less than its M201." in x.remarks


def test_each_line_that_cant_be_read_is_named() -> None:
    text = LISTING.replace("X80.00", "X80,00").replace("X500.00", "X500,00")
    with pytest.raises(Rejected) as caught:
        read_settings(text, design())
    assert [each.value for each in caught.value.rejections] == [
        "M92 X80,00 Y80.00 Z400.00 E93.00", "M203 X500,00 Y500.00 Z5.00 E25.00", "M201 X500,00 Y500.00 Z100.00 E5000.00"
    ]  # fmt: skip
