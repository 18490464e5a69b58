"""The client of the protocol against scripts of (sent, replied), with nothing left over."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from designs import design
from stepramp.controllers import stepramp_controller
from stepramp.controllers.controller import Activity, StoredRamp
from stepramp.controllers.frames import FrameSplitter, crc16, encode_frame
from stepramp.controllers.messages import (
    REPLY,
    BeginRequest,
    CommitRequest,
    DataReply,
    DataRequest,
    DoneReply,
    EndReply,
    EndRequest,
    HelloReply,
    HelloRequest,
    Message,
    MotorState,
    MoveByRequest,
    MoveReply,
    MoveToRequest,
    ReadReply,
    ReadRequest,
    Refusal,
    Reply,
    ReplyStatus,
    Request,
    StatusReply,
    StatusRequest,
    StopRequest,
    pack_reply,
)
from stepramp.controllers.stepramp_controller import StepRampController
from stepramp.errors import DeviceLost, Refused, Rejected
from stepramp.link.serial_port import SerialPort

SESSION = 0x1234
HELLO = HelloReply(1, 0, 1, 0, 2_000_000, 40, 2**24 - 1, 500, 120, 1, 0, 0)
IDLE = StatusReply(MotorState.IDLE, 0, 0, 0, 0, 1, 0xABCD, 0)
IMAGE = bytes(range(60))


def sent(request: Request, tag: int) -> Message:
    return Message(request.KIND, SESSION, tag, request.pack())


def replied(request: Request, reply: Reply | Refusal, tag: int, session: int = SESSION) -> bytes:
    return encode_frame(Message(request.KIND | REPLY, session, tag, pack_reply(reply)).pack())


class Script:
    """A device that expects messages in an order and answers each with the bytes set against it."""

    def __init__(self) -> None:
        self.pairs: list[tuple[Message, bytes]] = [
            (sent(HelloRequest(), 0), replied(HelloRequest(), HELLO, 0)),
        ]
        self.splitter = FrameSplitter()

    def then(self, request: Request, reply: Reply | Refusal | bytes, tag: int) -> Script:
        answer = reply if isinstance(reply, bytes) else replied(request, reply, tag)
        self.pairs.append((sent(request, tag), answer))
        return self

    def opened(self) -> None:
        pass

    def exchange(self, data: bytes) -> bytes:
        answer = b""
        for frame in self.splitter.feed(data):
            expected, reply = self.pairs.pop(0)
            assert Message.unpack(frame) == expected
            answer += reply
        return answer


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stepramp_controller.secrets, "randbelow", lambda _: SESSION - 1)
    monkeypatch.setattr(stepramp_controller, "GARBAGE_S", 0.0)
    monkeypatch.setattr(stepramp_controller, "REPLY_TIMEOUT_S", 0.01)
    monkeypatch.setattr(stepramp_controller, "HELLO_INTERVAL_S", 0.01)
    monkeypatch.setattr(stepramp_controller, "HELLO_TIMEOUT_S", 0.2)


@pytest.fixture
def script() -> Script:
    return Script()


@pytest.fixture
def connect(plug_in: Callable, script: Script) -> Iterator[Callable[[], StepRampController]]:
    """Connect to the script; at the end nothing of it may be left over."""
    ports: list[SerialPort] = []

    def connect() -> StepRampController:
        ports.append(SerialPort(plug_in(script)))
        controller = StepRampController(ports[-1])
        controller.connect()
        return controller

    yield connect
    assert script.pairs == []
    for port in ports:
        port.close()


def test_before_the_handshake_nothing_is_known(plug_in: Callable) -> None:
    port = SerialPort(plug_in(Script()))
    with pytest.raises(DeviceLost, match="not connected"):
        _ = StepRampController(port).timer_hz
    port.close()


def test_the_handshake(connect: Callable[[], StepRampController]) -> None:
    controller = connect()
    assert (controller.timer_hz, controller.firmware_version) == (2_000_000, "0.1.0")
    assert controller.identity == HELLO


def test_hello_is_repeated_until_the_board_has_started(connect: Callable, script: Script) -> None:
    hello, good = script.pairs.pop()
    garbage = b"\xf0Booting\r\n" + bytes(3)
    late = replied(HelloRequest(), HELLO, 0, session=SESSION + 1)
    script.pairs = [(hello, b""), (hello, garbage), (hello, late), (hello, good[:5]), (hello, b"\0" + good)]
    assert connect().identity == HELLO


def test_nothing_answers(connect: Callable, script: Script) -> None:
    hello, _ = script.pairs.pop()
    script.pairs = [(hello, b"")] * 1000
    with pytest.raises(DeviceLost, match="Nothing at"):
        connect()
    assert 5 <= 1000 - len(script.pairs) <= 21
    script.pairs.clear()


def test_another_version_of_the_protocol(connect: Callable, script: Script) -> None:
    hello, _ = script.pairs.pop()
    script.pairs = [(hello, replied(HelloRequest(), Refusal(ReplyStatus.BAD_VERSION, 2), 0))]
    with pytest.raises(Refused, match="speaks version 2"):
        connect()


def test_a_timer_of_0_hz_makes_no_sense(connect: Callable, script: Script) -> None:
    hello, _ = script.pairs.pop()
    body = bytearray(pack_reply(HELLO))
    body[5:9] = bytes(4)
    script.pairs = [(hello, encode_frame(Message(0x81, SESSION, 0, bytes(body)).pack()))]
    with pytest.raises(DeviceLost, match="0 Hz"):
        connect()


def test_what_a_status_means(connect: Callable, script: Script) -> None:
    moving = StatusReply(MotorState.MOVING, -120, 2000, 4000, 120, 3, 0x1234, 0)
    script.then(StatusRequest(), moving, 1).then(StatusRequest(), StatusReply(0, 5, 5, 0, 5, 0, 0, 0), 2)
    controller = connect()
    status = controller.status()
    assert (status.activity, status.position_steps, status.target_steps) == (Activity.MOVING, -120, 2000)
    assert (status.speed_steps_per_s, status.ramp) == (500.0, StoredRamp(3, 0x1234))
    status = controller.status()
    assert (status.activity, status.speed_steps_per_s, status.ramp) == (Activity.READY, 0.0, None)


def test_a_lost_reply_is_asked_for_again_with_the_same_tag(connect: Callable, script: Script) -> None:
    script.then(MoveByRequest(5), b"", 1).then(MoveByRequest(5), b"", 1).then(MoveByRequest(5), MoveReply(5), 1)
    script.then(StopRequest(), DoneReply(), 2)
    controller = connect()
    controller.move_by(5)
    controller.stop()


def test_a_garbled_reply_counts_as_lost(connect: Callable, script: Script) -> None:
    good = replied(StatusRequest(), IDLE, 1)
    garbled = good[:8] + bytes([good[8] ^ 1 or 2]) + good[9:]
    script.then(StatusRequest(), garbled, 1).then(StatusRequest(), good[:-3] + b"\0", 1).then(StatusRequest(), IDLE, 1)
    assert connect().status().ramp == StoredRamp(1, 0xABCD)


def test_a_stale_reply_is_no_answer(connect: Callable, script: Script) -> None:
    other = StatusReply(0, 99, 99, 0, 0, 0, 0, 0)
    stale = replied(StatusRequest(), other, 0) + replied(StatusRequest(), other, 1, session=SESSION + 1)
    script.then(StatusRequest(), stale + replied(StatusRequest(), IDLE, 1), 1)
    assert connect().status().position_steps == 0


def test_no_answer_after_three_repeats(connect: Callable, script: Script) -> None:
    for _ in range(4):
        script.then(StatusRequest(), b"", 1)
    with pytest.raises(DeviceLost, match="does not answer"):
        connect().status()


def test_a_controller_that_was_restarted_is_lost(connect: Callable, script: Script) -> None:
    script.then(StatusRequest(), Refusal(ReplyStatus.STALE_SESSION), 1)
    with pytest.raises(DeviceLost, match="was restarted"):
        connect().status()


@pytest.mark.parametrize("body", [b"", b"\x63\0\0", b"\0", b"\4\0", b"\0\x09" + bytes(23)])
def test_answers_without_sense(connect: Callable, script: Script, body: bytes) -> None:
    script.then(StatusRequest(), encode_frame(Message(0x82, SESSION, 1, body).pack()), 1)
    with pytest.raises(DeviceLost, match="without sense"):
        connect().status()


def test_tags_begin_again_after_255(connect: Callable, script: Script) -> None:
    for number in range(1, 300):
        script.then(StopRequest(), DoneReply(), number % 256)
    controller = connect()
    for _ in range(1, 300):
        controller.stop()


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (ReplyStatus.MOVING, "The motor moves"),
        (ReplyStatus.NO_RAMP, "has no ramp"),
        (ReplyStatus.WRITING, "storing a ramp"),
        (ReplyStatus.UNKNOWN_KIND, "unknown_kind"),
    ],
)
def test_refusals_in_words(connect: Callable, script: Script, status: ReplyStatus, words: str) -> None:
    script.then(MoveToRequest(5), Refusal(status, 1), 1)
    with pytest.raises(Refused, match=words):
        connect().move_to(5)


def test_targets_that_are_too_far(connect: Callable, script: Script) -> None:
    script.then(MoveByRequest(2**31 - 1), Refusal(ReplyStatus.OUT_OF_RANGE), 1)
    controller = connect()
    for move in (
        lambda: controller.move_by(2**31 - 1),
        lambda: controller.move_by(2**31),
        lambda: controller.move_by(0),
        lambda: controller.move_to(-(2**31) - 1),
    ):
        with pytest.raises(Rejected, match="target from -2,147,483,648"):
            move()


def delivered(script: Script, staged: bytes = IMAGE) -> Script:
    """Script the way of IMAGE into the controller's RAM and back."""
    script.then(BeginRequest(60, crc16(IMAGE)), DoneReply(), 1)
    script.then(DataRequest(0, IMAGE[:48]), DataReply(48), 2).then(DataRequest(48, IMAGE[48:]), DataReply(60), 3)
    script.then(EndRequest(), EndReply(1, 1), 4)
    script.then(ReadRequest(1, 0, 48), ReadReply(60, staged[:48]), 5)
    return script.then(ReadRequest(1, 48, 48), ReadReply(60, staged[48:]), 6)


def test_storing_an_image(connect: Callable, script: Script) -> None:
    writing = StatusReply(MotorState.WRITING, 0, 0, 0, 0, 1, 1, 0)
    delivered(script).then(CommitRequest(), DoneReply(), 7).then(StatusRequest(), writing, 8)
    script.then(StatusRequest(), StatusReply(0, 0, 0, 0, 0, 9, 1, 0), 9)
    script.then(ReadRequest(0, 0, 48), ReadReply(60, IMAGE[:48]), 10)
    script.then(ReadRequest(0, 48, 48), ReadReply(60, IMAGE[48:]), 11)
    assert connect().store(IMAGE) == (IMAGE, 9)


def test_what_the_ram_holds_is_compared_before_it_is_stored(connect: Callable, script: Script) -> None:
    delivered(script, staged=bytes(60))
    with pytest.raises(Refused, match="another ramp than the one sent"):
        connect().store(IMAGE)


def test_a_memory_that_fails(connect: Callable, script: Script) -> None:
    delivered(script).then(CommitRequest(), DoneReply(), 7)
    script.then(StatusRequest(), StatusReply(0, 0, 0, 0, 0, 1, 1, 1), 8)
    with pytest.raises(Refused, match="could not store"):
        connect().store(IMAGE)


def test_a_memory_that_never_gets_done(connect: Callable, script: Script, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stepramp_controller, "WRITE_TIMEOUT_S", 0.0)
    delivered(script).then(CommitRequest(), DoneReply(), 7)
    script.then(StatusRequest(), StatusReply(MotorState.WRITING, 0, 0, 0, 0, 1, 1, 0), 8)
    with pytest.raises(Refused, match="without an end"):
        connect().store(IMAGE)


@pytest.mark.parametrize(
    ("refusal", "words"),
    [
        (Refusal(ReplyStatus.BAD_CRC, 0x1234), "arrived damaged"),
        (Refusal(ReplyStatus.BAD_RAMP, 17), "refuses segment 17"),
        (Refusal(ReplyStatus.OUT_OF_ORDER, 48), r"out_of_order \(48\)"),
    ],
)
def test_an_image_that_is_refused(connect: Callable, script: Script, refusal: Refusal, words: str) -> None:
    script.then(BeginRequest(1, crc16(b"x")), DoneReply(), 1).then(DataRequest(0, b"x"), DataReply(1), 2)
    script.then(EndRequest(), refusal, 3)
    with pytest.raises(Refused, match=words):
        connect().store(b"x")


def test_a_push_is_refused_while_moving(connect: Callable, script: Script) -> None:
    controller = connect()
    push = controller.prepare_push(design())
    image = stepramp_controller.plan_push(design(), HELLO).image.encode()
    script.then(BeginRequest(len(image), crc16(image)), Refusal(ReplyStatus.MOVING), 1)
    with pytest.raises(Refused, match="moves"):
        push()


def test_it_gives_way_before_each_request_and_while_the_memory_is_written(plug_in: Callable, script: Script) -> None:
    gaps: list[float] = []
    delivered(script).then(CommitRequest(), DoneReply(), 7)
    script.then(StatusRequest(), StatusReply(MotorState.WRITING, 0, 0, 0, 0, 1, 1, 0), 8)
    script.then(StatusRequest(), IDLE, 9).then(ReadRequest(0, 0, 48), ReadReply(0, b""), 10)
    port = SerialPort(plug_in(script))
    controller = StepRampController(port, gaps.append)
    controller.connect()
    assert controller.store(IMAGE) == (b"", 1)
    assert gaps == [0.0] * 8 + [stepramp_controller.WRITE_POLL_S] + [0.0] * 2
    port.close()
