from __future__ import annotations

import io

import pytest
from rich.console import Console

from stepramp.command_line.output import Rows, as_table, figure, write_csv

ROWS = Rows(
    ("device", "state", "position [steps]", "limits [steps]"), [("1", "stopping", -2_000_000, "-100000…1000000")], "One"
)


@pytest.mark.parametrize("width", [24, 80, 400])
def test_no_value_is_cut_however_narrow_the_terminal(width: int) -> None:
    written = io.StringIO()
    Console(file=written, width=width).print(as_table(ROWS))
    shown = "".join(written.getvalue().split())
    if width >= 80:
        assert all(each in written.getvalue() for each in ("stopping", "-2,000,000", "-100000…1000000", "[steps]"))
    assert shown.count("…") == 1, "only the one that is in a value"


def test_csv_has_numbers_as_they_are_and_nothing_for_what_isn_t_there(capsys: pytest.CaptureFixture[str]) -> None:
    write_csv(Rows(("a", "b"), [(1234567, None), (0.1, "x,y")]))
    assert capsys.readouterr().out == 'a,b\n1234567,\n0.1,"x,y"\n'


@pytest.mark.parametrize(
    ("value", "text"), [(None, "–"), (True, "yes"), (1234567, "1,234,567"), (0.000012345678, "1.23457e-05"), ("a", "a")]
)
def test_figures_are_as_people_read_them(value: object, text: str) -> None:
    assert figure(value) == text
