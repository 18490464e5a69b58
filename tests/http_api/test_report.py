"""The report that people send each other, over HTTP: what it says, in which units, and that it is whole by itself."""

import base64
import io
import json
import re
from collections.abc import Callable
from datetime import date
from html.parser import HTMLParser
from typing import Any

import pytest
from pypdf import PdfReader
from starlette.testclient import TestClient

from designs import document
from event_loop import run
from motor.trains import whole
from stepramp.design import Design
from stepramp.exports.printed import motor
from stepramp.http_api.app import create_app
from stepramp.motor.train import NotWanted

NASTY = '"a" $x^2$ _b <script>alert(1)</script>\n\\ {日本} \u202e &'


def reported(client: TestClient, kind: str, **body: Any) -> Any:
    return client.post("/api/v1/report", params={"format": kind}, json={"design": document(), **body})


class Page(HTMLParser):
    """What a browser finds in a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.rows: list[list[str]] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_data(self, data: str) -> None:
        self.text += data
        if self.tags and self.tags[-1][0] in ("td", "th") and data != "\n":
            self.rows[-1][-1] += data

    def all_of(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]

    def row(self, name: str) -> list[str]:
        [found] = [row for row in self.rows if row[0] == name]
        return found[1:]

    def pictures(self) -> list[str]:
        sources = [each["src"] or "" for each in self.all_of("img")]
        return [base64.b64decode(each.removeprefix("data:image/svg+xml;base64,")).decode() for each in sources]


def page_of(answer: Any) -> Page:
    assert answer.status_code == 200, answer.text
    return Page(answer.text)


def pdf_of(answer: Any) -> tuple[PdfReader, str]:
    assert answer.status_code == 200, answer.text
    reader = PdfReader(io.BytesIO(answer.content))
    return reader, "\n".join(page.extract_text() for page in reader.pages)


ASKED = {
    "design": document(name=NASTY, timer__counter_bits=14, move__steps=150),
    "pinned": document(name="Before"),
    "methods": ["first_order", "newton", "exact"],
    "units": {"length": "mm", "time": "min"},
}


@pytest.fixture(scope="module")
def answer() -> Any:
    """Return the answer that has everything: drawing takes a second."""
    with TestClient(create_app(), base_url="http://127.0.0.1:8000", raise_server_exceptions=False) as client:
        return reported(client, "html", **ASKED)


@pytest.fixture(scope="module")
def page(answer: Any) -> Page:
    return page_of(answer)


def test_the_page_needs_nothing_from_elsewhere_and_runs_nothing(answer: Any, page: Page) -> None:
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    assert answer.headers["content-disposition"] == 'attachment; filename="a_x_2_b_script_alert_1_script_report.html"'
    assert not page.all_of("script")
    assert not [name for _, attributes in page.tags for name in attributes if name.startswith("on") or name == "href"]
    assert all((each["src"] or "").startswith("data:image/svg+xml;base64,") for each in page.all_of("img"))
    assert len(page.pictures()) == 5
    for picture in page.pictures():
        assert "script" not in re.sub("<!--.*?-->", "", picture)
        # Names of what the file is written in are no addresses.
        assert "//" not in re.sub(r'xmlns(:\w+)?="[^"]*"', "", picture)
    assert NASTY.split("\n", maxsplit=1)[0] in page.text


def test_the_page_can_be_read_without_seeing_it(page: Page) -> None:
    assert page.all_of("html") == [{"lang": "en"}]
    assert len(page.all_of("title")) == len(page.all_of("h1")) == len(page.all_of("main")) == 1
    assert page.text.count('"a" $x^2$') >= 2, "as title and as heading"
    assert all(each.get("scope") in ("col", "row") for each in page.all_of("th"))
    assert "" not in [cell for row in page.rows for cell in row]
    # 2 MHz / sqrt(2 · 5000) = 20,000 ticks and 100 steps/s, 120 mm/min; 75 steps up, to sqrt(2 · 5000 · 75) steps/s.
    speed, delay, error, acceleration, jerk = (each["alt"] or "" for each in page.all_of("img"))
    assert speed.startswith("velocity, mm/min, over 150 steps: Exact from 120 to 1,040")
    assert "Exact from 1,150 to 10,000" in delay
    assert "1st order" in error
    assert acceleration.startswith("acceleration as planned, mm/min²")
    # From the first step, a·v = 5,000 · 100 steps/s³, on: the jump to 5,000 steps/s² is spread over it.
    assert jerk.startswith("jerk as planned, mm/min³")
    assert "1st order" not in acceleration, "what another method makes of it, its error tells"


def test_acceleration_and_jerk_of_a_shape_are_drawn(client: TestClient) -> None:
    """A step is 0.02 mm: 5,000 steps/s² are 100 mm/s², and 100,000 steps/s³ are 2,000 mm/s³."""
    shaped = {**document(), "schema": "stepramp/2"}
    shaped["ramp"] = {**shaped["ramp"], "shape": {"name": "s_curve", "jerk_steps_per_s3": 100_000}}
    asked = {"design": shaped, "pinned": document(name="Before"), "units": {"length": "mm", "time": "s"}}
    *_, acceleration, jerk = (each["alt"] or "" for each in page_of(reported(client, "html", **asked)).all_of("img"))
    assert "Exact from -100 to 100" in acceleration.replace("−", "-")
    assert "pinned: Before, Exact from -100 to 100" in acceleration.replace("−", "-")
    assert "pinned: Before, Exact from" in jerk
    found = re.match(
        r"jerk as planned, mm/s³, over 2,000 steps: Exact from -([\d,]+) to ([\d,]+);", jerk.replace("−", "-")
    )
    assert found is not None, jerk
    least, most = (float(each.replace(",", "")) for each in found.groups())
    assert least == pytest.approx(2000, rel=0.02)
    # The steps next to rest are long: from one to the other there is more than the limit.
    assert 2000 * 0.98 < most < 2000 * 1.25
    _, text = pdf_of(reported(client, "pdf", **asked))
    assert "acceleration as planned, mm/s²" in text
    assert "jerk as planned, mm/s³" in text


def test_it_says_all_in_the_units_chosen_with_the_pinned_design_beside_it(page: Page) -> None:
    """400 steps a turn of 8 mm: a step is 0.02 mm."""
    assert page.row("parameter") == ["value", "pinned: Before"]
    assert page.row("slew speed") == ["1,200 mm/min"] * 2
    assert page.row("acceleration") == ["360,000 mm/min²"] * 2
    assert page.row("move") == ["3 mm", "40 mm"]
    assert page.row("length") == ["3 mm, 150 steps"]
    assert page.row("timer") == ["2,000,000 Hz, 14 bits", "2,000,000 Hz, 16 bits"]
    assert len(page.row("pinned: Before, Exact")) == 7
    assert all("pinned: Before" in (each["alt"] or "") for each in page.all_of("img"))
    assert page.row("3") == ["100", "1,000"], "of the lookup table"


def test_methods_are_called_and_drawn_as_on_the_page(client: TestClient, page: Page) -> None:
    told = {each["name"]: each for each in client.get("/api/v1/methods").json()["methods"]}
    for method in ("exact", "first_order", "newton"):
        assert len(page.row(told[method]["label"])) == 7
        assert all(told[method]["style"]["light"] in picture for picture in page.pictures()[:3])
    body = {"design": ASKED["design"], "methods": ["first_order"]}
    worst = client.post("/api/v1/errors", json=body).json()["methods"][0]["largest_relative_error"]
    assert page.row("1st order")[1:3] == [f"{100 * worst['value']:.3g} %", f"{worst['step']:,}"]


def test_logarithmic_axes_have_plain_numbers(page: Page) -> None:
    ticks = re.findall("<!-- (.*?) -->", page.pictures()[1])
    assert {"2,000", "5,000", "10,000"} <= set(ticks)
    assert not [tick for tick in ticks if re.search(r"mathdefault|\^|\de", tick)]


def test_each_check_has_its_verdict(client: TestClient, page: Page) -> None:
    verdicts = {row[0]: row[1] for row in page.rows if len(row) == 3 and row[1] in ("passed", "failed")}
    assert sorted(verdicts.values()) == ["failed"] * 2 + ["passed"] * 3
    warnings = client.post("/api/v1/profile", json={"design": ASKED["design"]}).json()["warnings"]
    in_steps = page_of(reported(client, "html", **ASKED | {"units": {"length": "steps", "time": "s"}}))
    failed = {name for name, verdict in verdicts.items() if verdict == "failed"}
    assert {in_steps.row(name)[1] for name in failed} == {each["message"] for each in warnings}


def test_the_pdf_says_the_same(client: TestClient) -> None:
    answer = reported(client, "pdf", **ASKED)
    assert answer.headers["content-type"] == "application/pdf"
    reader, text = pdf_of(answer)
    assert all(page.mediabox.width == pytest.approx(595, abs=1) for page in reader.pages), "A4"
    today = date.today()
    for words in (
        '"a" $x^2$ _b <script>', f"{today.day} {today:%B %Y}", "1,200 mm/min", "360,000 mm/min²", "passed", "failed",
        "velocity, mm/min", "delay of a step, µs", "Newton", "pinned: Before", "10,000", "Lookup table", "1,500",
        "lacks stand as \ufffd",
    ):  # fmt: skip
        assert words in text
    assert reader.metadata is not None
    assert (reader.metadata.title or "").startswith('"a"')


def test_the_pdf_says_that_its_font_lacks_something_only_when_it_does(client: TestClient) -> None:
    _, text = pdf_of(reported(client, "pdf", design=document(name="Übung Ø 5 µm")))
    assert "Übung Ø 5 µm" in text
    assert "\ufffd" not in text
    _, text = pdf_of(reported(client, "pdf", design=document(name="Stage 🚀" + "日本語" * 25)))
    assert "Stage \N{REPLACEMENT CHARACTER}" in text
    assert text.count("\N{REPLACEMENT CHARACTER}") > 75


def test_a_long_table_goes_on_on_further_pages(client: TestClient) -> None:
    rows = [[row + 1, 9000 - row] for row in range(1000)]
    reader, text = pdf_of(reported(client, "pdf", design=document(table={"rows": rows, "interval_unit": "us"})))
    found = re.findall(r"(\d[\d,]*) +(\d[\d,]*) +(\d[\d,]*)(?= |$)", text.partition("Lookup table")[2], re.MULTILINE)
    told = sorted([int(number.replace(",", "")) for number in row] for row in found)
    assert told == [[row + 1, row + 1, 9000 - row] for row in range(1000)]
    assert all("last ramp index" in page.extract_text() for page in reader.pages[2:]), "the head on each page"
    assert len(reader.pages) > 4


@pytest.mark.parametrize(
    ("kind", "body", "field", "allowed"),
    [
        ("docx", {}, "format", "html, pdf"),
        ("html", {"methods": ["fastest"]}, "methods.0", "exact, ideal"),
        ("pdf", {"units": {"length": "inch"}}, "units.length", "steps, rev, deg, mm"),
        ("pdf", {"units": {"time": "h"}}, "units.time", "s, min"),
        ("html", {"units": {"length": "mm"}, "design": document(axis__travel_unit="deg")}, "units.length",
         "steps, rev or deg: the travel of 'Test' is in deg"),
        ("html", {"units": {"length": "mm"}, "pinned": document(name="Old", axis__travel_unit="deg")}, "units.length",
         "the travel of 'Old' is in deg"),
        ("html", {"design": document(timer__frequency_hz=1000, ramp__slew_speed_steps_per_s=9000)},
         "design.ramp.slew_speed_steps_per_s", "at most 1,000 steps/s"),
        ("html", {"pinned": document(timer__frequency_hz=1000, ramp__slew_speed_steps_per_s=9000)},
         "pinned.ramp.slew_speed_steps_per_s", "at most 1,000 steps/s"),
        ("html", {"pinned": document(move__steps=0)}, "pinned.move.steps", "but not 0"),
        ("html", {"design": document(move__steps=10_000_000), "methods": ["exact", "ideal", "midpoint", "newton",
         "tuned"]}, "methods", "at most 4 methods"),
        ("html", {"colour": "red"}, "colour", "nothing; there is no such field, only"),
    ],
)  # fmt: skip
def test_what_can_t_be_reported_is_refused_by_field_value_and_what_is_allowed(
    client: TestClient, kind: str, body: dict[str, Any], field: str, allowed: str
) -> None:
    answer = reported(client, kind, **body)
    assert answer.status_code == 422, answer.text
    [error] = answer.json()["errors"]
    assert error["field"] == field
    assert allowed in error["allowed"]


def test_a_format_that_is_given_twice_is_refused(client: TestClient) -> None:
    answer = client.post("/api/v1/report", params={"format": ["html", "pdf"]}, json={"design": document()})
    [error] = answer.json()["errors"]
    assert (answer.status_code, error["field"]) == (422, "format")
    assert error["message"] == 'format is ["html", "pdf"]; allowed: one value, given once.'


@pytest.mark.parametrize("kind", ["html", "pdf"])
def test_a_report_of_a_design_with_a_motor_has_its_section(client: TestClient, kind: str) -> None:
    answer = reported(client, kind, design=whole())
    if kind == "html":
        page = page_of(answer)
        assert page.row("verdict") == ["safe"]
        assert page.row("supply") == ["24 V", "given"]
        alts = [each["alt"] or "" for each in page.all_of("img")]
        assert [alt.partition(",")[0] for alt in alts[-2:]] == ["torque", "load angle"]
        return
    _, text = pdf_of(answer)
    assert "What the motor does with the move" in text
    assert "the ramp asks for" in text


def test_a_report_ends_when_its_client_has_left(monkeypatch: pytest.MonkeyPatch) -> None:
    ended, body = [], json.dumps({"design": whole()}).encode()

    def outcome_of(_: Design, is_wanted: Callable[[], bool]) -> None:
        while is_wanted():
            pass
        ended.append(True)
        raise NotWanted

    monkeypatch.setattr(motor, "outcome_of", outcome_of)
    coming = iter([{"type": "http.request", "body": body, "more_body": False}])

    async def receive() -> dict[str, Any]:
        return next(coming, {"type": "http.disconnect"})

    async def send(_: Any) -> None:
        pass

    host = (b"host", b"localhost")
    scope = {
        "type": "http", "method": "POST", "path": "/api/v1/report", "query_string": b"format=html", "scheme": "http",
        "headers": [host, (b"content-type", b"application/json"), (b"content-length", str(len(body)).encode())],
        "server": ("localhost", 80), "client": ("127.0.0.1", 1),
    }  # fmt: skip
    run(create_app()(scope, receive, send))
    assert ended == [True]


MAP = {
    "over": "load",
    "over_values": [0.0, 0.1, 0.2],
    "accelerations_steps_per_s2": [1e4, 2e4, 4e4],
    "verdicts": [[0, 0, 1], [0, 1, 2], [-1, 2, 3]],
}


def test_a_stall_map_is_a_picture_of_the_report(client: TestClient) -> None:
    design = whole(move__steps=200)
    page = page_of(reported(client, "html", design=design, maps=[MAP]))
    assert len(page.pictures()) == 8
    [words] = [each["alt"] or "" for each in page.all_of("img") if (each["alt"] or "").startswith("stall map")]
    assert "over load, from 10,000 to 40,000; load, Nm from 0 to 0.2" in words
    reader, _ = pdf_of(reported(client, "pdf", design=design, maps=[MAP]))
    without, _ = pdf_of(reported(client, "pdf", design=design))
    assert len(reader.pages) == len(without.pages) + 1


@pytest.mark.parametrize(
    ("changes", "field", "allowed"),
    [
        ({"over": "current"}, "maps.0.over", "slew_speed, load, supply_voltage"),
        ({"over_values": [0.0, 0.2, 0.1]}, "maps.0.over_values.2", "more than 0.2, the one before"),
        ({"over_values": [0.0, 0.1, 2000.0]}, "maps.0.over_values.2", "a number from -1,000 to 1,000 Nm"),
        ({"accelerations_steps_per_s2": [1e4, 2e4]}, "maps.0.verdicts", "2 rows, one for each acceleration"),
        ({"verdicts": [[0, 0], [0, 1, 2], [0, 2, 3]]}, "maps.0.verdicts.0", "3 verdicts, one for each column"),
        ({"verdicts": [[0, 0, 9], [0, 1, 2], [0, 2, 3]]}, "maps.0.verdicts.0.2", "a whole number from -1 to 3"),
    ],
)
def test_a_map_that_makes_no_sense_is_refused(
    client: TestClient, changes: dict[str, object], field: str, allowed: str
) -> None:
    refused = reported(client, "html", design=whole(), maps=[MAP | changes])
    assert refused.status_code == 422
    error = refused.json()["errors"][0]
    assert error["field"] == field
    assert allowed in error["allowed"]


def test_a_map_needs_a_motor(client: TestClient) -> None:
    refused = reported(client, "html", maps=[MAP])
    assert refused.json()["errors"][0]["allowed"] == "none, since the design has no motor"
