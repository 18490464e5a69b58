"""CSV, JSON, the page of plots to zoom and the pictures."""

import csv
import io
import json
import re
import struct
from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest

from designs import design, document
from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.exports.export import Options, export
from stepramp.exports.names import comment_text, identifier_of, is_identifier
from stepramp.ramp.profile import profile_of

NASTY = '"a" */ #error </script><script>alert(1)</script>\n\r\\ ??/ $title /* & \u202e \' \u2028'


def test_the_csv_reads_back_as_the_profile() -> None:
    asked = design(move__steps=-777, timer__frequency_hz=1_234_567)
    rows = list(csv.DictReader(io.StringIO(export(asked, "csv", Options()).content.decode())))
    profile = profile_of(asked)
    assert [int(row["step"]) for row in rows] == list(range(1, 778))
    assert [int(row["interval_ticks"]) for row in rows] == profile.intervals_ticks.tolist()
    assert [float(row["time_s"]) for row in rows] == profile.time_s.tolist()
    assert [int(row["position_steps"]) for row in rows] == list(range(-1, -778, -1))
    assert [float(row["speed_steps_per_s"]) for row in rows] == profile.speed_steps_per_s.tolist()
    assert float(rows[0]["interval_us"]) == pytest.approx(int(rows[0]["interval_ticks"]) / 1.234567, rel=1e-12)


def test_a_csv_of_more_lines_than_spreadsheets_open_is_refused() -> None:
    with pytest.raises(Rejected, match=r"move\.steps is 1000001; allowed: up to 1,000,000 steps in a CSV file"):
        export(design(move__steps=1_000_001), "csv", Options())


@pytest.mark.parametrize("changes", [{}, {"table": None}, {"name": NASTY}, {"move__steps": -5, "name": "Tür 日本"}])
def test_the_json_is_the_design(changes: dict[str, object]) -> None:
    asked = design(**changes)
    text = export(asked, "json", Options()).content.decode()
    assert Design.checked(json.loads(text)) == asked
    assert json.loads(text)["ramp"] == document()["ramp"]


class Elements(HTMLParser):
    """What a browser finds in a page: its elements, and its text outside of scripts."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        if self.tags and self.tags[-1][0] != "script":
            self.text += data


def test_the_page_of_plots_says_the_numbers_and_warnings_and_loads_nothing() -> None:
    asked = design(name=NASTY, timer__counter_bits=14)
    page = Elements(export(asked, "html", Options(methods=("newton", "table"))).content.decode())
    assert not [attributes for _, attributes in page.tags if "src" in attributes or "href" in attributes]
    assert NASTY.split("\n", maxsplit=1)[0] in page.text
    # 1000 steps/s at 5000 steps/s²: 100 steps of ramp; 2 MHz / sqrt(10000) = 20,000 ticks, more than 2^14 - 1.
    assert "The longest interval, 20,000 ticks, does not fit in a counter of 14 bits" in page.text
    for words in ("5,000 steps/s²", "1,800 steps", "newton", "table", "10,000 µs"):
        assert words in page.text
    assert len([tag for tag, _ in page.tags if tag == "script"]) == 3, "Plotly, its settings, the figure"


@pytest.mark.parametrize("format_name", ["svg", "png"])
def test_pictures_are_the_same_for_the_same_design(format_name: str) -> None:
    first, second = (export(design(name=NASTY), format_name, Options(methods=("first_order",))) for _ in range(2))  # type: ignore[arg-type]
    assert first == second


def test_the_pictures_show_a_curve_a_method_and_plot() -> None:
    drawn = export(design(), "svg", Options(methods=("first_order", "newton"))).content
    [figure] = [one for one in ElementTree.fromstring(drawn) if one.get("id") == "figure_1"]
    axes = [group for group in figure if (group.get("id") or "").startswith("axes_")]
    assert len(axes) == 3
    for each in axes:
        curves = [
            path.get("d") or "" for group in each for path in group if (group.get("id") or "").startswith("line2d")
        ]
        assert len([curve for curve in curves if curve.count("L") > 20]) == 3
    image = export(design(), "png", Options()).content
    assert image[:8] == b"\x89PNG\r\n\x1a\n"
    assert struct.unpack(">II", image[16:24]) == (1500, 1350)


@pytest.mark.parametrize("name", [NASTY, "", "int", "2", "日本", "a" * 100, "x\u0000y"])
def test_whatever_a_design_is_called_its_names_in_c_are_good(name: str) -> None:
    assert is_identifier(identifier_of(name))
    assert re.fullmatch(r"[\w.-]+", export(design(name=name), "json", Options()).file_name, re.ASCII)


@pytest.mark.parametrize("text", [NASTY, "*//*/", "a\\", "??/??/", "/" * 9, "**//"])
def test_a_comment_neither_ends_early_nor_disturbs_a_compiler(text: str) -> None:
    shown = comment_text(text)
    assert shown.isprintable()
    assert not [pair for pair in ("*/", "/*", "//", "??", "\\") if pair in shown]
