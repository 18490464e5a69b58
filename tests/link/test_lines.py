"""Lines out of bytes: the same however they are cut, bounded, and told apart from what was sent."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from stepramp.errors import DeviceLost
from stepramp.link.lines import Line, Lines, LineSplitter

ENDS = ("\n", "\r", "\r\n")


def cut(data: bytes, cuts: list[int]) -> list[bytes]:
    ends = sorted({min(each, len(data)) for each in cuts} | {0, len(data)})
    return [data[begin:end] for begin, end in pairwise(ends)]


def split(pieces: list[bytes], longest: int = 20) -> list[Line]:
    splitter = LineSplitter(longest)
    return [line for piece in pieces for line in splitter.feed(piece)]


pieces = st.one_of(st.binary(max_size=30), st.sampled_from([b"\r", b"\n", b"\r\n", b"\xc3\xa4"]))


@given(data=st.lists(pieces).map(b"".join), cuts=st.lists(st.integers(0, 300)))
@example(data=b"a\r\nb\r\n", cuts=[2])
@example(data="ä\r\n".encode(), cuts=[1])
def test_lines_are_the_same_however_they_are_cut(data: bytes, cuts: list[int]) -> None:
    assert split(cut(data, cuts)) == split([data]) == split([bytes((each,)) for each in data])


words = st.text("abcXYZ0189$.=?<>|:, äµ", min_size=1).map(str.strip).filter(bool)


@given(lines=st.lists(st.tuples(words, st.sampled_from(ENDS))))
def test_each_line_comes_whole_and_in_order_whatever_ends_it(lines: list[tuple[str, str]]) -> None:
    data = "".join(text + end for text, end in lines).encode()
    assert split([data], 1000) == [Line(text) for text, _ in lines]


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (b"ok\n", "ok"),
        (b"\r\n\r\n\0\0Grbl 1.1h ['$' for help]\r\n", "Grbl 1.1h ['$' for help]"),
        (b"  echo:  M201 X500.00 \r", "echo:  M201 X500.00"),
        (b"\xff\xfeok\x1b[2J\x07\n", "\\xff\\xfeok\\x1b[2J\\x07"),
        ("50 µs\n".encode(), "50 µs"),
        ("50 µs\n".encode("latin-1"), "50 \\xb5s"),
        (b"a\tb\n", "a\tb"),
    ],
)
def test_what_a_line_says(data: bytes, text: str) -> None:
    assert split([data], 1000) == [Line(text)]


@given(length=st.integers(0, 5000), cuts=st.lists(st.integers(0, 5000)))
def test_a_line_without_end_is_not_kept(length: int, cuts: list[int]) -> None:
    said = split(cut(b"x" * length + b"\nok\n", cuts), 20)
    begun = [Line("x" * min(length, 20), is_whole=length <= 20)] if length else []
    assert said == [*begun, Line("ok")]


def test_what_never_ends_takes_no_memory() -> None:
    splitter = LineSplitter()
    for _ in range(1000):
        assert splitter.feed(b"x" * 4096) == []
    assert len(splitter._begun) == 1024


class Pieces:
    """A connection that says pieces, one a read, and then the last one for ever."""

    name = "pieces"

    def __init__(self, *said: bytes) -> None:
        self.said = list(said)
        self.sent = b""
        self.reads = 0

    def write(self, data: bytes) -> None:
        self.sent += data

    def read(self, timeout_s: float) -> bytes:
        assert timeout_s <= 0.05
        self.reads += 1
        if self.said and self.said[0] == b"gone":
            raise DeviceLost("It has gone.")
        return self.said.pop(0) if len(self.said) > 1 else self.said[0]

    def pending(self) -> bytes:
        return self.read(0.0)

    def close(self) -> None:
        pass


def test_a_line_that_comes_back_is_known_as_an_echo_and_its_answer_is_not() -> None:
    heard: list[Line] = []
    lines = Lines(Pieces(b"$$\r", b"\n$0=10\r\no", b"k\r\n$$\r\nok\n", b""), lambda _: None, heard.append)
    lines.send("$$")
    assert lines.hear_until(lambda: Line("ok") in heard, 5.0)
    assert not lines.hear_until(lambda: False, 0.0)
    assert heard == [Line("$$", is_echo=True), Line("$0=10"), Line("ok"), Line("$$"), Line("ok")]


def test_an_echo_that_was_lost_keeps_no_later_one_from_being_known() -> None:
    heard: list[Line] = []
    port = Pieces(b"G1\nok\n")
    lines = Lines(port, lambda _: None, heard.append)
    lines.send("G0")
    lines.send("G1")
    lines.listen()
    lines.listen()
    assert heard == [Line("G1", is_echo=True), Line("ok"), Line("G1"), Line("ok")]
    assert port.sent == b"G0\nG1\n"


def test_a_setting_that_was_sent_and_is_listed_later_is_no_echo() -> None:
    heard: list[Line] = []
    lines = Lines(Pieces(b"ok\n", b"$120=50.000\n$121=10.000\nok\n", b""), lambda _: None, heard.append)
    lines.send("$120=50.000")
    assert lines.hear_until(lambda: Line("ok") in heard, 5.0)
    lines.send("$$")
    assert lines.hear_until(lambda: heard.count(Line("ok")) == 2, 5.0)
    assert heard[1:3] == [Line("$120=50.000"), Line("$121=10.000")]


def test_more_urgent_calls_come_between_reads_and_hear_too() -> None:
    heard: list[str] = []
    gave_way: list[int] = []

    def give_way(_: float) -> None:
        gave_way.append(port.reads)
        if len(gave_way) == 1:
            lines.hear_until(lambda: "stopped" in heard, 5.0)

    port = Pieces(b"$0=1", b"0\nstopped\no", b"k\n", b"")
    lines = Lines(port, give_way, lambda line: heard.append(line.text))
    assert lines.hear_until(lambda: "ok" in heard, 5.0)
    assert heard == ["$0=10", "stopped", "ok"]
    assert (gave_way, port.reads) == ([1], 3)


@pytest.mark.parametrize(("said", "has_heard"), [(b"", False), (b"\xff" * 100, True)])
def test_the_time_is_kept_to_whatever_comes(said: bytes, has_heard: bool) -> None:
    gave_way: list[float] = []
    lines = Lines(Pieces(said), gave_way.append, lambda _: None)
    assert not lines.hear_until(lambda: False, 0.02)
    assert gave_way
    assert lines.has_heard is has_heard


def test_chatter_is_not_listened_to_for_ever() -> None:
    heard: list[Line] = []
    lines = Lines(Pieces(b"busy: processing\n" * 100), lambda _: None, heard.append)
    assert not lines.hear_until(lambda: False, 1e9)
    assert 10_000 < len(heard) < 11_000


def test_a_port_that_is_gone_is_told() -> None:
    lines = Lines(Pieces(b"gone"), lambda _: None, lambda _: None)
    with pytest.raises(DeviceLost):
        lines.hear_until(lambda: False, 5.0)
