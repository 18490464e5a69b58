"""What is said and answered, word for word, with nothing left over: from the examples of the makers' manuals."""

from __future__ import annotations

import pytest
from pytrinamic.tmcl import TMCLReply

from stepramp.controllers.tmcl import conversation
from stepramp.controllers.tmcl.axis import Axis, Seen
from stepramp.controllers.tmcl.conversation import Conversation, Denied
from stepramp.controllers.tmcl.modules import MODULES
from stepramp.controllers.tmcl.program import Program
from stepramp.controllers.tmcl.stopping import Stopping
from stepramp.errors import DeviceLost, Refused


class Script:
    """A connection on which so is said, and answered: pairs of hexadecimal bytes."""

    name = "script"

    def __init__(self, *pairs: tuple[str, str]) -> None:
        self._left = [(bytes.fromhex(said), bytes.fromhex(answer)) for said, answer in pairs]
        self._coming = b""

    def write(self, data: bytes) -> None:
        said, self._coming = self._left.pop(0)
        assert data == said, data.hex(" ")

    def read(self, _timeout_s: float) -> bytes:
        come, self._coming = self._coming, b""
        return come

    def pending(self) -> bytes:
        return self.read(0.0)

    def close(self) -> None:
        pass

    def is_over(self) -> bool:
        return not self._left and not self._coming


@pytest.fixture(autouse=True)
def short_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(conversation, "ANSWER_S", 0.002)


def axis_of(script: Script) -> tuple[Axis, Conversation]:
    talk = Conversation(script, lambda _: None)
    return Axis(talk, MODULES[1276], 0), talk


def test_the_handshake_tells_the_module() -> None:
    """1276 is 04FC hexadecimal; firmware 1.13."""
    script = Script(("01 88 01 00 00 00 00 00 8a", "02 01 64 88 04 fc 01 0d fd"))
    assert Conversation(script, lambda _: None).begin() == (1276, "1.13")
    assert script.is_over()


def test_an_older_firmware_tells_its_name_only() -> None:
    """1240V145 in ASCII, without a checksum."""
    name = ("01 88 00 00 00 00 00 00 89", "02 31 32 34 30 56 31 34 35")
    script = Script(("01 88 01 00 00 00 00 00 8a", "02 01 64 88 00 00 01 2d 1d"), name, name)
    assert Conversation(script, lambda _: None).begin() == (1240, "1.45")
    assert script.is_over()


def test_an_older_firmware_that_tells_two_names_is_refused() -> None:
    script = Script(
        ("01 88 01 00 00 00 00 00 8a", "02 01 64 88 00 00 01 2d 1d"),
        ("01 88 00 00 00 00 00 00 89", "02 31 32 34 30 56 31 34 35"),
        ("01 88 00 00 00 00 00 00 89", "02 31 32 34 31 56 31 34 35"),
    )
    with pytest.raises(Refused, match="doesn't tell which one it is"):
        Conversation(script, lambda _: None).begin()
    assert script.is_over()


def test_a_parameter_is_set_and_read() -> None:
    script = Script(
        ("01 05 05 00 00 00 03 e8 f6", "02 01 64 05 00 00 03 e8 57"),
        ("01 06 05 00 00 00 00 00 0c", "02 01 64 06 00 00 03 e8 58"),
    )
    axis, _ = axis_of(script)
    assert axis.call(5, 1000)
    assert script.is_over()


def test_a_place_below_0_is_read() -> None:
    """GAP 3, GAP 1: at rest at -1000."""
    script = Script(
        ("01 06 03 00 00 00 00 00 0a", "02 01 64 06 00 00 00 00 6d"),
        ("01 06 01 00 00 00 00 00 08", "02 01 64 06 ff ff fc 18 7f"),
    )
    axis, _ = axis_of(script)
    assert axis.look() == Seen(-1000, 0)
    assert script.is_over()


def test_a_move_is_told_and_its_target_read() -> None:
    script = Script(
        ("01 04 00 00 00 01 5f 90 f5", "02 01 64 04 00 01 5f 90 5b"),
        ("01 06 00 00 00 00 00 00 07", "02 01 64 06 00 01 5f 90 5d"),
    )
    axis, _ = axis_of(script)
    assert axis.go_to(90000, lambda: None)
    assert script.is_over()


@pytest.mark.parametrize(
    ("speed", "told", "answered", "read"),
    [
        (51200, "01 01 00 00 00 00 c8 00 ca", "02 01 64 01 00 00 c8 00 30", "02 01 64 06 00 00 c8 00 35"),
        (-51200, "01 02 00 00 00 00 c8 00 cb", "02 01 64 02 00 00 c8 00 31", "02 01 64 06 ff ff 38 00 a3"),
    ],
)
def test_a_run_is_told_and_its_direction_read(speed: int, told: str, answered: str, read: str) -> None:
    script = Script((told, answered), ("01 06 02 00 00 00 00 00 09", read))
    axis, _ = axis_of(script)
    assert axis.go_at(speed, lambda: None)
    assert script.is_over()


def test_a_stop_is_told_twice_and_seen_and_looks_for_a_program() -> None:
    stop = ("01 03 00 00 00 00 00 00 04", "02 01 64 03 00 00 00 00 6a")
    script = Script(
        stop,
        stop,
        ("01 06 02 00 00 00 00 00 09", "02 01 64 06 00 00 00 00 6d"),
        ("01 0a 80 00 00 00 00 00 8b", "02 01 64 0a 00 00 00 00 71"),
    )
    axis, talk = axis_of(script)
    Stopping(talk, Program(talk), [axis]).stop()
    assert script.is_over()


ECHO = "01 06 05 00 00 00 00 00 0c "
ANSWER = "02 01 64 06 00 00 03 e8 58"


@pytest.mark.parametrize(
    "answers",
    [
        [ECHO + ANSWER],
        ["02 02 64 06 00 00 00 07 75" + ANSWER],
        ["", ANSWER],
        ["02 01 64 06 00 00 03 e8", ANSWER],
        ["02 01 64 06 00 00 03 e9 58", ANSWER],
        ["02 01 01 00 00 00 00 00 04", ANSWER],
        ["ff" * 30, ANSWER],
        [ECHO, "", ECHO + ANSWER],
        ["02 01 64 05 00 00 03 e8 57", ANSWER],
    ],
    ids=["echo", "another's", "lost", "short", "damaged", "sent damaged", "noise", "echoes alone", "an older answer"],
)
def test_what_comes_back_damaged_or_from_others_is_asked_again(answers: list[str]) -> None:
    script = Script(*[(ECHO, answer) for answer in answers])
    axis, _ = axis_of(script)
    assert axis.get(5) == 1000
    assert script.is_over()


def test_a_module_that_never_answers_is_lost() -> None:
    script = Script(*[(ECHO, "")] * 4)
    axis, _ = axis_of(script)
    with pytest.raises(DeviceLost, match="does not answer"):
        axis.get(5)
    assert script.is_over()


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (2, "doesn't know the command"),
        (3, "no such parameter"),
        (4, "doesn't take the value"),
        (5, "EEPROM, is locked"),
    ],
)
def test_what_is_refused_is_told_in_words_and_not_asked_again(status: int, words: str) -> None:
    script = Script(("01 07 06 00 00 00 00 00 0e", TMCLReply(2, 1, status, 7, 0).to_buffer().hex()))
    axis, _ = axis_of(script)
    with pytest.raises(Denied, match=words) as caught:
        axis.store(6, lambda: None)
    assert caught.value.status == status
    assert script.is_over()
