"""Restoring a grbl, whatever a power cut has left of its settings, and without having anything set out."""

from __future__ import annotations

import pytest

from controllers.grbl.bench import Bench, by
from controllers.grbl.emulator import Eeprom
from designs import design
from stepramp.controllers.contract import Activity
from stepramp.controllers.grbl.controller import IN_USE, GrblController
from stepramp.controllers.remark import Unwritten
from stepramp.errors import Refused, Rejected

G28_AND_G30 = "What G28 and G30 go to can't be written again: go there, and say G28.1 or G30.1."


def saved(bench: Bench) -> str:
    assert isinstance(bench.controller, GrblController)
    return bench.controller.backup()


def restored(bench: Bench, text: str) -> tuple[str, ...]:
    """Restore a backup to a controller that was switched off and on, and is connected again."""
    bench.port.close()
    bench.grbl.power_up()
    bench.reopen()
    bench.controller.connect()
    bench.grbl.lines.clear()
    assert isinstance(bench.controller, GrblController)
    return bench.controller.use_backup(text)


@pytest.mark.parametrize("left", [{120: 0.0}, {121: 0.0}, {100: 0.0, 110: 0.0}, {112: -3.0}])
@pytest.mark.usefixtures("controller")
def test_settings_without_sense_are_written_again(bench: Bench, left: dict[int, float]) -> None:
    text = saved(bench)
    bench.grbl.eeprom.settings |= left
    assert restored(bench, text) == (IN_USE, G28_AND_G30)
    assert bench.grbl.eeprom.settings == Eeprom().settings
    assert bench.controller.status().trouble is None
    assert bench.controller.most_axes == 3


@pytest.mark.usefixtures("controller")
def test_no_axis_takes_the_number_of_one_before_it(bench: Bench) -> None:
    bench.grbl.eeprom.settings |= {111: 0.0, 102: 80.0}
    bench.port.close()
    bench.grbl.power_up()
    bench.reopen()
    bench.controller.connect()
    status = bench.controller.status()
    assert [axis.steps_per_mm for axis in status.axes] == [250]
    assert "settings of axis Y make no sense" in str(status.trouble)
    bench.controller.move_by([by(500)])
    bench.rest()
    assert bench.grbl.position == [500, 0, 0]


def test_one_without_a_first_axis_is_connected_and_moves_nothing(bench: Bench) -> None:
    bench.grbl.eeprom.settings[100] = 0.0
    bench.grbl.eeprom.settings[110] = 0.0
    bench.grbl.power_up()
    bench.controller.connect()
    [axis] = bench.controller.status().axes
    assert (axis.activity, axis.steps_per_mm, bench.controller.most_axes) == (Activity.READY, None, 0)
    assert not axis.position_told
    for ask in (
        lambda: bench.controller.move_by([by(1)]),
        lambda: bench.controller.set_position([by(1)]),
        lambda: bench.controller.prepare_push([design()], 0),
        lambda: bench.controller.preview_push([design()], 0),
    ):
        with pytest.raises(Refused, match="The settings of axis X make no sense"):
            ask()


def test_what_a_backup_lacks_is_told(bench: Bench, controller: GrblController) -> None:
    whole = saved(bench)
    lines = [line for line in whole.splitlines() if not line.startswith(("$112", "$N1", "[G55"))]
    assert controller.use_backup("\n".join(lines)) == (
        "The backup doesn't have $112, G55, $N1: that is left as it was.",
        G28_AND_G30,
    )
    assert controller.use_backup(whole + "$100=250.000 (x, step/mm)\n") == (G28_AND_G30,)
    assert bench.grbl.eeprom.writes == 0


def test_what_a_backup_tells_twice_is_refused_by_its_name(bench: Bench, controller: GrblController) -> None:
    with pytest.raises(Rejected, match=r"\$100 is 250.000 and 1; allowed: each setting once in a backup"):
        controller.use_backup(saved(bench) + "$100=1\n")
    with pytest.raises(Rejected, match=r"\$110 is '99999999999'; allowed: a number up to 99,999,999: no machine has"):
        controller.use_backup(saved(bench).replace("$110=500.000", "$110=99999999999"))
    with pytest.raises(Rejected, match=r"\$130 is 'abc'; allowed: a number up to 99,999,999: no machine has"):
        controller.use_backup(saved(bench).replace("$130=200.000", "$130=abc"))


@pytest.mark.parametrize(
    "offsets",
    ["[G55:]", "[G55:,0.000,0.000]", "[G55:nan,1,2]", "[G55:1e5,1,2]", "[G55:1.5,2]", "[G55:1,2,3,4]",
     "[G55:1.2.3,2,3]",
     "[G55:99999999999,2,3]", "[G55:-100000000,2,3]", "[G55:1?,2!,3~]", "[G55:1X9,2,3]", "[G55:1,2,3", "[G55;1,2,3]",
     "[G55:\u0663,2,3]", "[G55:1-,2,3]"],
)  # fmt: skip
def test_offsets_without_sense_are_refused_before_anything_is_written(
    bench: Bench, controller: GrblController, offsets: str
) -> None:
    text = saved(bench).replace("$110=500.000", "$110=77.000").replace("[G55:0.000,0.000,0.000]", offsets)
    with pytest.raises(Rejected) as caught:
        controller.use_backup(text)
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == ("G55", offsets)
    assert rejection.allowed == "[G55:…] with 3 numbers up to 99,999,999, one for each axis"
    assert bench.grbl.eeprom.writes == 0


def test_offsets_that_grbl_tells_are_written_and_those_of_others_left(bench: Bench, controller: GrblController) -> None:
    text = saved(bench).replace("[G55:0.000,0.000,0.000]", "[G55:-1.500,2.000,3.000]\n[G59.1:0.000,0.000]")
    assert controller.use_backup(text) == (G28_AND_G30,)
    assert bench.grbl.eeprom.offsets[2] == (-1.5, 2.0, 3.0)


def test_soft_limits_come_after_homing_which_they_need(bench: Bench, controller: GrblController) -> None:
    text = saved(bench).replace("$20=0", "$20=1").replace("$22=0", "$22=1")
    assert controller.use_backup(text) == (IN_USE, G28_AND_G30)
    assert [bench.grbl.eeprom.settings[number] for number in (20, 22)] == [1, 1]


def test_what_is_refused_keeps_nothing_else_from_being_written(bench: Bench, controller: GrblController) -> None:
    text = saved(bench).replace("$100=250.000", "$99=1\n$100=80.000")
    text = text.replace("$0=10", "$0=1").replace("$1=25", "$1=30")
    remarks = controller.use_backup(text)
    assert (bench.grbl.eeprom.settings[1], bench.grbl.eeprom.settings[100]) == (30, 80)
    assert remarks == (
        "The controller refuses '$0=1': a step pulse must last at least 3 µs (error:6).",
        "The controller refuses '$99=1': it knows no such statement (error:3).",
        IN_USE,
        G28_AND_G30,
    )
    assert [isinstance(each, Unwritten) for each in remarks] == [True, True, False, False]


@pytest.mark.usefixtures("controller")
def test_one_that_is_locked_takes_its_settings_and_says_what_it_does_not_take(bench: Bench) -> None:
    bench.grbl.eeprom.settings |= {22: 1.0, 100: 80.0}
    text = saved(bench).replace("[G54:0.000,", "[G54:5.000,").replace("$N0=", "$N0=G55")
    bench.grbl.eeprom.settings[100] = 250.0
    remarks = restored(bench, text.replace("$22=0", "$22=1").replace("$100=250", "$100=80"))
    assert bench.grbl.eeprom.settings[100] == 80
    assert remarks == (
        "The controller refuses 'G21G10L2P1X5.000Y0.000Z0.000': it is locked (error:9).",
        "The controller refuses '$N0=G55': it takes that only at rest (error:8).",
        IN_USE,
        G28_AND_G30,
    )


@pytest.mark.parametrize("block", ["G0X10", "G28", "G53 G1 X-5 F500", "M3 S1000", "$H"])
def test_a_start_up_line_that_may_move_something_is_never_sent(
    bench: Bench, controller: GrblController, block: str
) -> None:
    remarks = controller.use_backup(saved(bench).replace("$N1=", f"$N1={block}"))
    assert remarks == (
        f"$N1={block} isn't written again: grbl carries a start-up line out as it stores it, and this one may move "
        "something. Say it at the machine.",
        G28_AND_G30,
    )
    bench.pass_time(1)
    assert bench.grbl.steps == 0
    assert not any(line.startswith("$N1=") for line in bench.grbl.lines)


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("$74=stop!", "it is too long, or has characters that grbl obeys"),
        ("$74=why?", "it is too long, or has characters that grbl obeys"),
        ("$74=caf\u00e9", "it is too long, or has characters that grbl obeys"),
        (f"$74={'x' * 80}", "it is too long, or has characters that grbl obeys"),
        ("$75=********", "the controller tells asterisks in place of its value"),
    ],
)
def test_what_would_be_obeyed_or_is_hidden_is_not_sent(
    bench: Bench, controller: GrblController, setting: str, words: str
) -> None:
    remarks = controller.use_backup(f"{saved(bench)}{setting}\n")
    assert remarks == (f"{setting[:3]} isn't written again: {words}.", G28_AND_G30)
    assert bench.grbl.eeprom.writes == 0


@pytest.mark.parametrize("reading", [1, 2, 3])
@pytest.mark.parametrize("lost", [(b"$100=250.000", b"$100=50.000"), (b"G54:0.000", b"G54:.000"), (b"$N1=", b"$N=")])
def test_a_byte_that_is_lost_as_a_backup_is_read_is_not_in_it(
    bench: Bench, controller: GrblController, lost: tuple[bytes, bytes], reading: int
) -> None:
    whole, readings = saved(bench), []

    def lose(said: bytes) -> bytes:
        if lost[0] in said:
            readings.append(said)
        return said.replace(*lost) if len(readings) == reading else said

    bench.grbl.on_the_way_out = lose
    assert saved(bench) == whole
    assert controller.use_backup(whole) == (G28_AND_G30,)
    assert bench.grbl.eeprom.writes == 0


def test_what_is_told_otherwise_each_time_is_not_saved(bench: Bench, controller: GrblController) -> None:
    readings = iter(range(100))
    bench.grbl.on_the_way_out = lambda said: said.replace(b"$120=10.000", f"$120={next(readings)}.000".encode())
    with pytest.raises(Refused, match=r"says to \$\$ is something else each time, as over a cable that loses bytes"):
        controller.backup()


@pytest.mark.parametrize("listing", ["$#", "$N"])
def test_a_listing_in_which_something_is_broken_is_heard_to_its_end(
    bench: Bench, controller: GrblController, listing: str
) -> None:
    text = saved(bench)
    bench.grbl.eeprom.unreadable = listing
    # Its ok after the error is no answer to what is asked next.
    assert "$120=10.000" in controller.backup()
    assert controller.use_backup(text) == (G28_AND_G30,)


@pytest.mark.parametrize(
    "report",
    ["<Idle|MPos:nan,0.000,0.000|FS:0,0>", "<Idle|MPos:0.000,0.000|FS:0,0>", "<Idle|MPos:1e40,0,0|FS:inf,0|WCO:0,0,0>"],
)
def test_reports_that_no_grbl_makes_are_asked_for_again(bench: Bench, controller: GrblController, report: str) -> None:
    left = [report.encode() + b"\r\n"] * 3
    bench.grbl.on_the_way_out = lambda data: left.pop() if left and data.startswith(b"<") else data
    assert [axis.position_steps for axis in controller.status().axes] == [0, 0, 0]
    assert left == []
