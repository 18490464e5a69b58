"""What a hello is to controllers that obey single bytes: somebody may connect one of them as ours by mistake."""

from __future__ import annotations

import binascii
import random
import secrets

import pytest

from controllers.tic.emulator import TicEmulator
from stepramp.controllers.stepramp import conversation
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.conversation import Conversation
from stepramp.controllers.stepramp.messages.status import StatusReply, StatusRequest
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.errors import DeviceLost


class Heard:
    """A connection to a device in no time: what was sent to it, frame by frame."""

    name = "heard"

    def __init__(self, device: VirtualController | TicEmulator) -> None:
        self.frames: list[bytes] = []
        self._device = device
        self._said = b""

    def write(self, data: bytes) -> None:
        self.frames.append(data)
        self._said += self._device.exchange(data)

    def read(self, _: float) -> bytes:
        said, self._said = self._said, b""
        return said

    def pending(self) -> bytes:
        return self.read(0.0)

    def close(self) -> None:
        pass


@pytest.fixture(autouse=True)
def _impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    # Not the session of the scripts.
    monkeypatch.undo()
    monkeypatch.setattr(conversation, "GARBAGE_S", 0.0)
    monkeypatch.setattr(conversation, "HELLO_INTERVAL_S", 0.0)
    monkeypatch.setattr(conversation, "MOST_HELLOS", 3)


def seed(monkeypatch: pytest.MonkeyPatch, number: int) -> None:
    monkeypatch.setattr(secrets, "randbelow", random.Random(number).randrange)


def hello_of(frame: bytes) -> tuple[int, int] | None:
    """Return session and tag of a hello, decoded by hand; None for another request."""
    decoded, rest = b"", frame.strip(b"\0")
    while rest:
        decoded += rest[1 : rest[0]] + b"\0"
        rest = rest[rest[0] :]
    message, crc = decoded[:-3], decoded[-3:-1]
    assert binascii.crc_hqx(message, 0xFFFF) == int.from_bytes(crc, "little")
    return (int.from_bytes(message[1:3], "little"), message[3]) if message[0] == 1 else None


def test_no_byte_of_a_hello_has_its_top_bit_set(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(conversation, "HELLO_INTERVAL_S", 0.2)
    sessions = set()
    for number in range(40):
        seed(monkeypatch, number)
        heard = Heard(VirtualController())
        talk = Conversation(heard, lambda _: None)
        for others in (0, 1, 2, 60, 3, 150):
            for _ in range(others):
                talk.ask(StatusRequest(0), StatusReply)
            talk.begin()
        hellos = [frame for frame in heard.frames if hello_of(frame)]
        assert len(hellos) == 6
        assert max(b"".join(hellos)) < 0x80
        [session] = {hello[0] for frame in hellos if (hello := hello_of(frame))}
        sessions.add(session)
    assert 0 not in sessions
    assert len(sessions) > 30


def test_there_is_a_hello_for_each_session(monkeypatch: pytest.MonkeyPatch) -> None:
    """And it is repeated with no other bytes."""
    monkeypatch.setattr(conversation, "MOST_HELLOS", 2)
    heard = Heard(TicEmulator(lambda: 0.0))
    most = []
    monkeypatch.setattr(secrets, "randbelow", lambda below: most.append(below) or 0)
    with pytest.raises(DeviceLost):
        Conversation(heard, lambda _: None).begin()
    heard.frames.clear()
    sessions = set()
    for number in range(most[0]):
        monkeypatch.setattr(secrets, "randbelow", lambda _, number=number: number)
        with pytest.raises(DeviceLost):
            Conversation(heard, lambda _: None).begin()
        first, second = heard.frames
        assert first == second
        assert max(first) < 0x80
        hello = hello_of(first)
        assert hello is not None
        sessions.add(hello[0])
        heard.frames.clear()
    assert len(sessions) == most[0] > 10_000
    assert 0 not in sessions


def test_a_tic_hears_no_command_in_a_hello(monkeypatch: pytest.MonkeyPatch) -> None:
    for number in range(300):
        seed(monkeypatch, number)
        tic = TicEmulator()
        heard = Heard(tic)
        with pytest.raises(DeviceLost):
            StepRampController(heard).connect()
        assert len(heard.frames) == 3
        assert (tic.commands, tic.steps) == ([], 0)
