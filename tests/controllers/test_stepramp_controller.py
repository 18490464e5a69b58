"""The client of the protocol against scripts of (sent, replied), with nothing left over."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from controllers.ramps import IMAGE, four_axes
from designs import design
from stepramp.controllers.contract import Activity, Asked, ControllerStatus, StoredRamp
from stepramp.controllers.stepramp import conversation, transfer
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.frames import FrameSplitter, crc16, encode_frame
from stepramp.controllers.stepramp.messages.body import DoneReply, Notice, Reply, Request
from stepramp.controllers.stepramp.messages.message import REPLY, Message
from stepramp.controllers.stepramp.messages.motion import (
    HaltRequest,
    LineRequest,
    MoveByRequest,
    MoveToRequest,
    RunRequest,
    SetPositionRequest,
    StopRequest,
    TargetsReply,
    ZeroRequest,
)
from stepramp.controllers.stepramp.messages.ramps import (
    BeginRequest,
    CommitRequest,
    DataReply,
    DataRequest,
    EndReply,
    EndRequest,
    ReadReply,
    ReadRequest,
    RollBackRequest,
    TryRequest,
)
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus, pack_reply
from stepramp.controllers.stepramp.messages.report import ReportNotice, ReportRequest
from stepramp.controllers.stepramp.messages.session import HelloReply, HelloRequest
from stepramp.controllers.stepramp.messages.settings import ReadSettingsRequest, SettingsReply, WriteSettingsRequest
from stepramp.controllers.stepramp.messages.status import StatusReply, StatusRequest
from stepramp.controllers.stepramp.messages.trace import TraceNotice, TraceReply, TraceRequest
from stepramp.controllers.stepramp.push import plan_push
from stepramp.controllers.stepramp.settings import Settings
from stepramp.controllers.virtual.controller import HELLO
from stepramp.errors import DeviceLost, Refused, Rejected
from stepramp.link.serial_port import SerialPort

SESSION = 0x1234
BYTES = IMAGE.encode()
NOISE = bytes([7, 1, 99])
IDLE = StatusReply(0, 0, 0, 0, 0, 0, 1, crc16(BYTES), 0, 0)
NO_RAMP = StatusReply(0, 0, 0, 0, 0, 0, 0, 0, 0, 0)


def sent(request: Request, tag: int) -> Message:
    return Message(request.KIND, SESSION, tag, request.pack())


def replied(request: Request, reply: Reply | Refusal, tag: int, session: int = SESSION) -> bytes:
    return encode_frame(Message(request.KIND | REPLY, session, tag, pack_reply(reply)).pack())


def said(notice: Notice, tag: int = 0, session: int = SESSION) -> bytes:
    return encode_frame(Message(notice.KIND, session, tag, notice.pack()).pack())


def by_steps(*values: int) -> list[Asked]:
    return [Asked(axis, value, f"axes.{axis}.by_steps") for axis, value in enumerate(values)]


class Script:
    """A device that expects messages in an order and answers each with the bytes set against it.

    The handshake is expected first; tags count on by themselves.
    """

    def __init__(self, hello: HelloReply = HELLO, settings: Settings | None = None, image: bytes = b"") -> None:
        self.pairs: list[tuple[Message, bytes]] = [(sent(HelloRequest(), 0), replied(HelloRequest(), hello, 0))]
        self.splitter = FrameSplitter()
        self.unasked = b""
        self.noise = b""
        """What it receives after each frame."""
        self._tag = 0
        self.then(ReadSettingsRequest(), SettingsReply((settings or Settings()).pack()))
        if hello.ramp_in_use:
            self.reads(0, image)
        self.then(ReportRequest(50), DoneReply())

    def then(self, request: Request, reply: Reply | Refusal | bytes, *, again: bool = False) -> Script:
        """Expect a request with the next tag, or a repeat of the last one."""
        self._tag = self._tag if again else (self._tag + 1) % 256
        answer = reply if isinstance(reply, bytes) else replied(request, reply, self._tag)
        self.pairs.append((sent(request, self._tag), answer))
        return self

    def reads(self, source: int, image: bytes) -> Script:
        """Expect that an image is read."""
        for offset in range(0, max(1, len(image)), 48):
            self.then(ReadRequest(source, offset, 48), ReadReply(len(image), image[offset : offset + 48]))
        return self

    def delivers(self, image: bytes, staged: bytes | None = None) -> Script:
        """Expect that an image is sent and read back from RAM."""
        self.then(BeginRequest(len(image), crc16(image)), DoneReply())
        for offset in range(0, len(image), 48):
            part = image[offset : offset + 48]
            self.then(DataRequest(offset, part), DataReply(offset + len(part)))
        return self.then(EndRequest(), EndReply(1, 1)).reads(1, image if staged is None else staged)

    @property
    def tag(self) -> int:
        return self._tag

    def opened(self) -> None:
        pass

    def exchange(self, data: bytes) -> bytes:
        answer, self.unasked = self.unasked, b""
        for frame in self.splitter.feed(data + self.noise):
            expected, reply = self.pairs.pop(0)
            assert Message.unpack(frame) == expected
            answer += reply
        return answer


def stored(image: bytes = BYTES) -> Script:
    """Return the script of a controller that has a ramp."""
    known = HelloReply(**{**vars(HELLO), "ramp_sequence": 1, "image_crc": crc16(image), "ramp_in_use": 1})
    return Script(known, image=image)


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(conversation.secrets, "randbelow", lambda _: SESSION - 1)
    monkeypatch.setattr(conversation, "GARBAGE_S", 0.0)
    monkeypatch.setattr(conversation, "REPLY_TIMEOUT_S", 0.01)
    monkeypatch.setattr(conversation, "HELLO_INTERVAL_S", 0.01)


Connect = Callable[[Script], StepRampController]


@pytest.fixture
def connect(plug_in: Callable) -> Iterator[Connect]:
    """Connect to a script; at the end nothing of it may be left over."""
    used: list[tuple[SerialPort, Script]] = []

    def connect(script: Script) -> StepRampController:
        port = SerialPort(plug_in(script))
        used.append((port, script))
        controller = StepRampController(port)
        controller.connect()
        return controller

    yield connect
    for port, script in used:
        assert script.pairs == []
        port.close()


def test_before_the_handshake_nothing_is_known(plug_in: Callable) -> None:
    port = SerialPort(plug_in(Script()))
    with pytest.raises(DeviceLost, match="not connected"):
        _ = StepRampController(port).timer_hz
    port.close()


def test_the_handshake(connect: Connect) -> None:
    controller = connect(Script())
    assert (controller.timer_hz, controller.firmware_version) == (2_000_000, "0.2.0")
    assert controller.clocks_hz == (16_000_000, 2_000_000)
    assert controller.identity == HELLO


def test_the_ramps_that_are_there_are_read(connect: Connect) -> None:
    script = stored(four_axes().encode())
    for axis in range(4):
        script.then(StatusRequest(axis), IDLE)
    assert len(connect(script).status().axes) == 4


def test_ramps_on_trial_are_read_from_ram(connect: Connect) -> None:
    known = HelloReply(**{**vars(HELLO), "ramp_in_use": 2})
    script = Script(known, image=BYTES)
    for number in range(2, 2 - (-len(BYTES) // 48)):
        message, answer = script.pairs[number]
        script.pairs[number] = (Message(message.kind, SESSION, message.tag, b"\1" + message.body[1:]), answer)
    connect(script)


def test_ramps_without_sense(connect: Connect) -> None:
    script = stored(b"\xff" * 20)
    script.pairs.pop()
    with pytest.raises(DeviceLost, match="without sense"):
        connect(script)


def test_hello_is_repeated_until_the_board_has_started(connect: Connect) -> None:
    script = Script()
    hello, good = script.pairs[0]
    garbage = b"\xf0Booting\r\n" + bytes(3)
    late = replied(HelloRequest(), HELLO, 0, session=SESSION + 1)
    before = [(hello, b""), (hello, garbage), (hello, late), (hello, good[:5]), (hello, b"\0" + good)]
    script.pairs[:1] = before
    assert connect(script).identity == HELLO


class Chattering(Script):
    """Tells an earlier client what it does until it hears a hello."""

    def exchange(self, data: bytes) -> bytes:
        self.unasked = said(ReportNotice(0, 0, ((5, 0),)), session=7) if len(self.pairs) == 3 else b""
        return super().exchange(data)


def test_a_controller_that_still_reports_to_an_earlier_client(
    connect: Connect, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(conversation, "GARBAGE_S", 0.01)
    monkeypatch.setattr(conversation, "MOST_GARBAGE_S", 0.05)
    assert connect(Chattering()).listen() is None


def test_nothing_answers(connect: Connect) -> None:
    script = Script()
    hello, _ = script.pairs[0]
    script.pairs = [(hello, b"")] * 1000
    with pytest.raises(DeviceLost, match="Nothing answers at"):
        connect(script)
    assert 5 <= 1000 - len(script.pairs) <= 21
    script.pairs.clear()


def test_another_version_of_the_protocol(connect: Connect) -> None:
    script = Script()
    script.pairs = [(script.pairs[0][0], replied(HelloRequest(), Refusal(ReplyStatus.BAD_VERSION, 1), 0))]
    with pytest.raises(Refused, match="speaks version 1 of the protocol, this program version 2"):
        connect(script)


def test_a_clock_of_0_hz_makes_no_sense(connect: Connect) -> None:
    script = Script()
    body = bytearray(pack_reply(HELLO))
    body[5:9] = bytes(4)
    script.pairs = [(script.pairs[0][0], encode_frame(Message(0x81, SESSION, 0, bytes(body)).pack()))]
    with pytest.raises(DeviceLost, match="0 Hz"):
        connect(script)


def test_letting_go_ends_the_reports(connect: Connect) -> None:
    connect(Script().then(ReportRequest(0), DoneReply())).disconnect()


def test_what_a_status_means(connect: Connect) -> None:
    moving = StatusReply(1, 1, -120, 2000, 4000, 120, 3, 0x1234, 6, 2)
    stopping = StatusReply(1, 2, 5, 9, 8000, 5, 3, 0x1234, 0, 0)
    script = stored().then(StatusRequest(0), moving).then(StatusRequest(0), stopping)
    controller = connect(script.then(StatusRequest(0), StatusReply(3, 0, 5, 5, 0, 5, 1, 7, 0, 0)))
    status = controller.status()
    [axis] = status.axes
    assert (status.activity, axis.position_steps, axis.target_steps) == (Activity.MOVING, -120, 2000)
    assert (axis.speed_steps_per_s, axis.steps_made, status.ramp) == (500.0, 120, StoredRamp(3, 0x1234))
    assert (status.on_trial, status.motors_on, status.starved) == (True, True, 2)
    assert controller.status().activity is Activity.STOPPING
    assert controller.status().activity is Activity.WRITING


def test_without_a_ramp_there_is_still_one_axis(connect: Connect) -> None:
    status = connect(Script().then(StatusRequest(0), NO_RAMP)).status()
    assert (len(status.axes), status.ramp, status.activity) == (1, None, Activity.READY)


# ---- reports ----


def test_reports_are_heard_without_asking(connect: Connect) -> None:
    moving = StatusReply(1, 1, 10, 2000, 4000, 10, 1, 7, 0, 0)
    script = stored().then(StatusRequest(0), moving)
    controller = connect(script)
    assert controller.listen() is None
    controller.status()
    script.unasked = said(ReportNotice(1, 1, ((20, 2000),))) + said(ReportNotice(21, 1, ((40, 1000),)), 1)
    heard = controller.listen()
    assert heard is not None
    [axis] = heard.axes
    assert (axis.position_steps, axis.target_steps, axis.speed_steps_per_s) == (40, 2000, 2000.0)
    assert (axis.steps_made, heard.activity) == (40, Activity.MOVING)
    assert controller.listen() is None


TO_TARGETS: list[tuple[Callable[[StepRampController], None], Request, Reply]] = [
    (
        lambda controller: controller.move_by([Asked(0, 1500, "by_steps")]),
        MoveByRequest(1, (1500,)),
        TargetsReply((1500,)),
    ),
    (
        lambda controller: controller.line([Asked(0, 1500, "by_steps")]),
        LineRequest(1, 0, (1500,)),
        TargetsReply((1500,)),
    ),
    (lambda controller: controller.zero([0], 1500), ZeroRequest(1, 1500), DoneReply()),
]


@pytest.mark.parametrize("rests", [False, True], ids=["in flight", "after it ended"])
@pytest.mark.parametrize(("to_target", "request_", "reply"), TO_TARGETS, ids=["move", "line", "zero"])
def test_after_a_run_a_target_is_told_again(
    connect: Connect, to_target: Callable, request_: Request, reply: Reply, rests: bool
) -> None:
    """An axis that runs has no target but where it is; what it is asked next has one."""
    running, moving = StatusReply(1, 1, 10, 10, 4000, 10, 1, 7, 0, 0), StatusReply(1, 1, 10, 1500, 4000, 10, 1, 7, 0, 0)
    script = stored().then(StatusRequest(0), IDLE).then(RunRequest(1, (4000,)), DoneReply())
    script.then(StatusRequest(0), running)
    if rests:
        script.then(StatusRequest(0), IDLE)
    script.then(request_, reply).then(StatusRequest(0), moving)
    controller = connect(script)
    controller.status()
    controller.run([Asked(0, 500.0, "speed_steps_per_s")])
    controller.status()
    if rests:
        controller.status()
    to_target(controller)
    controller.status()
    script.unasked = said(ReportNotice(1, 1, ((20, 4000),)))
    [axis] = heard_of(controller).axes
    assert (axis.position_steps, axis.target_steps) == (20, 1500)


def heard_of(controller: StepRampController) -> ControllerStatus:
    heard = controller.listen()
    assert heard is not None
    return heard


def test_an_axis_that_ran_slowly_counts_as_it_runs_until_it_rests(connect: Connect) -> None:
    """Four axes take at least 533 fast ticks each: 457 are too fast, unless three of them run at 4,000."""
    moving, at_rest = StatusReply(1, 1, 0, 0, 4000, 5, 1, 7, 0, 0), StatusReply(0, 0, 0, 0, 0, 5, 1, 7, 0, 0)
    speeds = [Asked(axis, 4000.0, f"axes.{axis}.speed_steps_per_s") for axis in (1, 2, 3)]
    script = stored(fast_image())

    def states(*replies: StatusReply) -> None:
        for axis, reply in enumerate(replies):
            script.then(StatusRequest(axis), reply)

    states(*[at_rest] * 4)
    script.then(RunRequest(0b1110, (4000,) * 3), DoneReply())
    states(at_rest, *[moving] * 3)
    script.then(MoveByRequest(1, (5,)), TargetsReply((5,)))
    states(*[at_rest] * 4)
    states(at_rest, *[moving] * 3)
    # What ran has rested since: who knows how fast it moves now?
    states(at_rest, *[moving] * 3)
    controller = connect(script)
    controller.status()
    controller.run(speeds)
    controller.status()
    controller.move_by([Asked(0, 5, "by_steps")])
    for _ in range(2):
        controller.status()
    with pytest.raises(Rejected, match="this takes 117 %"):
        controller.move_by([Asked(0, 5, "by_steps")])


def test_steps_of_a_run_are_counted_past_the_last_position(connect: Connect) -> None:
    moving = StatusReply(1, 1, 2**31 - 5, 2**31 - 5, 4000, 10, 1, 7, 0, 0)
    script = stored().then(StatusRequest(0), moving)
    controller = connect(script)
    controller.status()
    script.unasked = said(ReportNotice(1, 1, ((-(2**31) + 15, 2000),)))
    heard = controller.listen()
    assert heard is not None
    assert (heard.axes[0].position_steps, heard.axes[0].steps_made) == (-(2**31) + 15, 30)


def test_a_report_of_another_state_is_reason_to_ask(connect: Connect) -> None:
    moving = StatusReply(1, 1, 10, 2000, 4000, 10, 1, 7, 0, 0)
    script = stored().then(StatusRequest(0), moving).then(StatusRequest(0), IDLE)
    controller = connect(script)
    controller.status()
    script.unasked = said(ReportNotice(1, 0, ((0, 0),)))
    heard = controller.listen()
    assert heard is not None
    assert heard.activity is Activity.READY


def test_what_is_unasked_is_never_taken_for_a_reply(connect: Connect) -> None:
    script = stored()
    tag = script.tag + 1
    report, trace = ReportNotice(0, 0, ((77, 0),)), TraceNotice(0, 1, 1, (5,))
    noise = said(report, tag) + said(trace, tag) + encode_frame(Message(0xC7, SESSION, tag, b"\0").pack())
    script.then(StatusRequest(0), noise + replied(StatusRequest(0), IDLE, tag) + said(report, tag + 1))
    controller = connect(script)
    assert controller.status().axes[0].position_steps == 0
    heard = controller.listen()
    assert heard is not None
    assert heard.axes[0].position_steps == 77


def test_notices_of_another_session_or_without_sense_are_dropped(connect: Connect) -> None:
    script = stored().then(StatusRequest(0), IDLE)
    controller = connect(script)
    controller.status()
    odd = encode_frame(Message(0xC0, SESSION, 1, b"\1").pack())
    script.unasked = said(ReportNotice(0, 1, ((5, 9),)), session=SESSION + 1) + odd
    assert controller.listen() is None


# ---- lost replies ----


def test_a_lost_reply_is_asked_for_again_with_the_same_tag(connect: Connect) -> None:
    script = stored().then(StatusRequest(0), IDLE)
    script.then(MoveByRequest(1, (5,)), b"").then(MoveByRequest(1, (5,)), b"", again=True)
    script.then(MoveByRequest(1, (5,)), TargetsReply((5,)), again=True).then(StopRequest(), DoneReply())
    controller = connect(script)
    controller.move_by(by_steps(5))
    controller.stop()


def test_a_repeat_ends_the_noise_before_it(connect: Connect) -> None:
    script = stored().then(StatusRequest(0), IDLE).then(StatusRequest(0), IDLE)
    controller = connect(script)
    script.noise = NOISE
    assert controller.status() == controller.status()


def test_a_garbled_reply_counts_as_lost(connect: Connect) -> None:
    script = stored()
    good = replied(StatusRequest(0), IDLE, script.tag + 1)
    garbled = good[:8] + bytes([good[8] ^ 1 or 2]) + good[9:]
    script.then(StatusRequest(0), garbled).then(StatusRequest(0), good[:-3] + b"\0", again=True)
    script.then(StatusRequest(0), IDLE, again=True)
    assert connect(script).status().ramp == StoredRamp(1, crc16(BYTES))


def test_a_stale_reply_is_no_answer(connect: Connect) -> None:
    script = stored()
    tag = script.tag + 1
    other = StatusReply(0, 0, 99, 99, 0, 0, 0, 0, 0, 0)
    stale = replied(StatusRequest(0), other, tag - 1) + replied(StatusRequest(0), other, tag, session=SESSION + 1)
    script.then(StatusRequest(0), stale + replied(StatusRequest(0), IDLE, tag))
    assert connect(script).status().axes[0].position_steps == 0


def test_no_answer_after_three_repeats(connect: Connect) -> None:
    script = stored().then(StatusRequest(0), b"")
    for _ in range(3):
        script.then(StatusRequest(0), b"", again=True)
    with pytest.raises(DeviceLost, match="does not answer"):
        connect(script).status()


def test_a_controller_that_was_restarted_is_lost(connect: Connect) -> None:
    script = stored().then(StatusRequest(0), Refusal(ReplyStatus.STALE_SESSION))
    with pytest.raises(DeviceLost, match="was restarted"):
        connect(script).status()


@pytest.mark.parametrize("body", [b"", b"\x63\0\0", b"\0", b"\4\0", b"\0\x09" + bytes(26), b"\0\0\x03" + bytes(25)])
def test_answers_without_sense(connect: Connect, body: bytes) -> None:
    script = stored()
    script.then(StatusRequest(0), encode_frame(Message(0x82, SESSION, script.tag + 1, body).pack()))
    with pytest.raises(DeviceLost, match="without sense"):
        connect(script).status()


def test_tags_begin_again_after_255(connect: Connect) -> None:
    script = Script()
    for _ in range(300):
        script.then(StopRequest(), DoneReply())
    controller = connect(script)
    for _ in range(300):
        controller.stop()


# ---- moves ----


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (ReplyStatus.MOVING, "The motor moves"),
        (ReplyStatus.NO_RAMP, "has no ramp"),
        (ReplyStatus.WRITING, "storing a ramp"),
        (ReplyStatus.UNKNOWN_KIND, "unknown_kind"),
    ],
)
def test_refusals_in_words(connect: Connect, status: ReplyStatus, words: str) -> None:
    script = stored().then(StatusRequest(0), IDLE).then(MoveToRequest(1, (5,)), Refusal(status, 1))
    with pytest.raises(Refused, match=words):
        connect(script).move_to([Asked(0, 5, "to_steps")])


def four() -> Script:
    """Return the script of a controller with four axes, and that of its status."""
    script = stored(four_axes().encode())
    for axis in range(4):
        script.then(StatusRequest(axis), IDLE)
    return script


def test_several_axes_in_one_request(connect: Connect) -> None:
    script = four().then(MoveByRequest(0b1001, (7, -3)), TargetsReply((7, -3)))
    script.then(MoveToRequest(0b0110, (-5, 6)), TargetsReply((-5, 6)))
    script.then(RunRequest(0b0011, (2000, -4000)), DoneReply())
    script.then(LineRequest(0b0101, 0, (30, -10)), TargetsReply((30, -10)))
    script.then(LineRequest(0b0011, 1, (30, -10)), TargetsReply((30, -10)))
    script.then(SetPositionRequest(0b1000, (-9,)), DoneReply()).then(ZeroRequest(0b0010, 300), DoneReply())
    script.then(StopRequest(b"\x06"), DoneReply()).then(HaltRequest(), DoneReply())
    controller = connect(script)
    controller.move_by([Asked(3, -3, "axes.0.by_steps"), Asked(0, 7, "axes.1.by_steps")])
    controller.move_to([Asked(1, -5, "axes.0.to_steps"), Asked(2, 6, "axes.1.to_steps")])
    controller.run([Asked(0, 1000.0, "a"), Asked(1, -500.0, "b")])
    controller.line([Asked(0, 30, "axes.0.by_steps"), Asked(2, -10, "axes.1.by_steps")])
    controller.line(by_steps(30, -10), ramp_axis=1)
    controller.set_position([Asked(3, -9, "axes.0.position_steps")])
    controller.zero([1], 300)
    controller.stop([1, 2])
    controller.halt()


def test_a_line_plays_the_ramp_of_the_slowest_axis(connect: Connect) -> None:
    # Axes 0 and 2 have a slew interval of 1,000 ticks, 1 and 3 of 900.
    script = stored(four_axes().encode()).then(LineRequest(0b0110, 2, (30, -10)), TargetsReply((30, -10)))
    connect(script).line([Asked(1, 30, "axes.0.by_steps"), Asked(2, -10, "axes.1.by_steps")])


def test_without_a_ramp_nothing_is_asked(connect: Connect) -> None:
    controller = connect(Script())
    for move in (
        lambda: controller.move_by(by_steps(1)),
        lambda: controller.run([Asked(0, 5.0, "speed_steps_per_s")]),
        lambda: controller.zero([0], 5),
    ):
        with pytest.raises(Refused, match="no ramp yet"):
            move()


@pytest.mark.parametrize(
    ("asked", "field"),
    [
        ([Asked(1, 5, "axes.0.by_steps")], "axes.0.axis"),
        ([Asked(0, 5, "axes.0.by_steps"), Asked(0, 5, "axes.1.by_steps")], "axes.1.axis"),
        ([Asked(0, 2**31, "by_steps")], "by_steps"),
        # What there and back, and a jog, say of their one axis.
        ([Asked(3, 5, "by_steps")], "axis"),
    ],
)
def test_what_is_rejected_before_it_is_sent(connect: Connect, asked: list[Asked], field: str) -> None:
    with pytest.raises(Rejected) as caught:
        connect(stored()).move_by(asked)
    assert [each.field for each in caught.value.rejections] == [field]


def test_an_axis_that_cant_be_zeroed_is_named(connect: Connect) -> None:
    script = four().then(ZeroRequest(0b0010, 500), Refusal(ReplyStatus.TOO_FAST, 130))
    controller = connect(script)
    for axes in ([5], [1]):
        with pytest.raises(Rejected) as caught:
            controller.zero(axes, 500)
        [rejection] = caught.value.rejections
        assert (rejection.field, rejection.value) == ("axes", axes[0])


def test_the_axis_whose_target_is_too_far_is_named(connect: Connect) -> None:
    script = four().then(MoveByRequest(0b0011, (1, 2**31 - 1)), Refusal(ReplyStatus.OUT_OF_RANGE, 1))
    with pytest.raises(Rejected, match="target from -2,147,483,648") as caught:
        connect(script).move_by(by_steps(1, 2**31 - 1))
    assert caught.value.rejections[0].field == "axes.1.by_steps"


@pytest.mark.parametrize("speed", [2010.0, -2100.0, 0.005])
def test_speeds_that_the_ramp_does_not_lead_to(connect: Connect, speed: float) -> None:
    with pytest.raises(Rejected, match=r"from -2,000 to 2,000 steps/s, the slew speed") as caught:
        connect(stored()).run([Asked(0, speed, "speed_steps_per_s")])
    assert caught.value.rejections[0].field == "speed_steps_per_s"


def fast_image() -> bytes:
    return plan_push([design(timer__frequency_hz=16_000_000, ramp__slew_speed_steps_per_s=35_000,
                             ramp__acceleration_steps_per_s2=1e9)] * 4, HELLO, Settings()).image.encode()  # fmt: skip


def test_axes_that_are_too_fast_together_are_not_asked_to_move(connect: Connect) -> None:
    # Four axes take at least 533 fast ticks each, 30,018 steps/s: 35,000 are 16,000,000 / 457 of them.
    script = stored(fast_image())
    for _ in range(2):
        for axis in range(4):
            script.then(StatusRequest(axis), IDLE)
    each = ", ".join(f"axis {axis} at most 30,018 steps/s" for axis in range(4))
    told = f"{each} when they move at the same time, or fewer axes; this takes 117 %"
    with pytest.raises(Rejected, match=told) as caught:
        connect(script).move_by(by_steps(1, 1, 1, 1))
    assert (caught.value.rejections[0].field, caught.value.rejections[0].value) == ("axes", "0, 1, 2, 3")


def test_those_that_move_already_count(connect: Connect) -> None:
    moving = StatusReply(1, 1, 0, 9, 457, 5, 1, 7, 0, 0)
    script = stored(fast_image())
    for _ in range(2):
        for axis in range(4):
            script.then(StatusRequest(axis), moving if axis else IDLE)
    with pytest.raises(Rejected, match="this takes 117 %") as caught:
        connect(script).move_by([Asked(0, 5, "by_steps")])
    assert caught.value.rejections[0].field == "by_steps"


@pytest.mark.parametrize("slower_steps_per_s", [100.0, 0.0])
def test_an_axis_that_is_told_to_slow_down_counts_with_the_speed_it_has(
    connect: Connect, slower_steps_per_s: float
) -> None:
    """Four at 457 ticks: one of them told to run slower, or to stop, and another one to start."""
    moving = StatusReply(1, 1, 0, 9, 457, 5, 1, 7, 0, 0)
    script = stored(fast_image())
    for _ in range(2):
        for axis in range(4):
            script.then(StatusRequest(axis), moving if axis else IDLE)
    with pytest.raises(Rejected, match="this takes 117 %"):
        connect(script).run([Asked(0, 35_000.0, "axes.0"), Asked(1, slower_steps_per_s, "axes.1")])


def test_an_axis_that_slows_down_counts_with_the_speed_it_has(connect: Connect) -> None:
    """It was told to run slower before, and is at 457 ticks still; once it is slow, another one may start."""
    moving, slow = (StatusReply(1, 1, 0, 9, interval, 5, 1, 7, 0, 0) for interval in (457, 4000))
    script = stored(fast_image())
    for axis in range(4):
        script.then(StatusRequest(axis), moving if axis else IDLE)
    script.then(RunRequest(2, (4000,)), DoneReply())
    for axis in range(4):
        script.then(StatusRequest(axis), moving if axis else IDLE)
    controller = connect(script)
    controller.run([Asked(1, 4000.0, "speed_steps_per_s")])
    with pytest.raises(Rejected, match="this takes 117 %"):
        controller.move_by([Asked(0, 5, "by_steps")])
    for axis in range(4):
        script.then(StatusRequest(axis), (slow if axis == 1 else moving) if axis else IDLE)
    script.then(MoveByRequest(1, (5,)), TargetsReply((5,)))
    controller.move_by([Asked(0, 5, "by_steps")])


def test_what_only_the_controller_finds_too_fast(connect: Connect) -> None:
    script = four().then(MoveByRequest(1, (5,)), Refusal(ReplyStatus.TOO_FAST, 130))
    with pytest.raises(Rejected, match="at most 1,526 steps/s; this takes 131 %"):
        connect(script).move_by([Asked(0, 5, "by_steps")])


def test_a_line_that_is_too_fast(connect: Connect) -> None:
    image = plan_push([design(timer__frequency_hz=16_000_000, ramp__slew_speed_steps_per_s=100_000,
                              ramp__acceleration_steps_per_s2=1e9)] * 4, HELLO, Settings()).image.encode()  # fmt: skip
    with pytest.raises(Rejected, match="at most 90,395 steps/s, for a line of 4 axes") as caught:
        connect(stored(image)).line(by_steps(5, 5, 5, 5))
    assert caught.value.rejections[0].field == "ramp_axis"


def quick_on(controller: StepRampController, speed_steps_per_s: float, axes: int = 1) -> None:
    """Push a ramp that is that fast, for so many axes, while pulses are short."""
    controller.use_settings(Settings())
    quick = {"ramp__slew_speed_steps_per_s": speed_steps_per_s, "ramp__acceleration_steps_per_s2": 1e9}
    controller.prepare_push([design(timer__frequency_hz=16_000_000, **quick)] * axes, mode="try")()


# Fast ticks by hand, 32 a µs of pulse width: alone 106 + 32 w, two 246 + 64 w, on a line of two 133 + 32 w.
@pytest.mark.parametrize(
    ("speed", "width_us", "fastest", "widest_us"),
    [(100_000, 10, 37_558, 1), (150_943, 1, 115_942, 0), (40_000, 100, 4839, 9)],
)
def test_with_wide_pulses_it_is_told_what_would_do(
    controller: StepRampController, speed: int, width_us: int, fastest: int, widest_us: int
) -> None:
    quick_on(controller, speed)
    controller.use_settings(Settings(pulse_width_us=width_us))
    told = (
        f"axis 0 at most {fastest:,} steps/s, or with a pulse width of at most {widest_us} µs \\(now {width_us} µs\\)"
    )
    with pytest.raises(Rejected, match=told):
        controller.move_by([Asked(0, 5, "by_steps")])
    controller.run([Asked(0, fastest, "speed_steps_per_s")])
    controller.halt()
    controller.use_settings(Settings(pulse_width_us=widest_us))
    controller.move_by([Asked(0, 5, "by_steps")])
    controller.halt()
    controller.use_settings(Settings(pulse_width_us=widest_us + 1))
    with pytest.raises(Rejected):
        controller.move_by([Asked(0, 5, "by_steps")])


def test_with_wide_pulses_it_is_told_what_axes_and_lines_can_do(controller: StepRampController) -> None:
    quick_on(controller, 40_000, axes=2)
    controller.use_settings(Settings(pulse_width_us=9))
    told = (
        "axis 0 at most 19,464 steps/s, axis 1 at most 19,464 steps/s when they move at the same time, or fewer axes, "
        "or with a pulse width of at most 2 µs"
    )
    with pytest.raises(Rejected, match=told):
        controller.move_by(by_steps(5, 5))
    controller.run([Asked(axis, 19_464, f"axes.{axis}") for axis in range(2)])
    controller.halt()
    with pytest.raises(Rejected, match=r"at most 38,004 steps/s, for a line of 2 axes, or with .* at most 8 µs"):
        controller.line(by_steps(5, 5))
    controller.line([*by_steps(5, 0)])
    controller.halt()
    controller.use_settings(Settings(pulse_width_us=8))
    controller.line(by_steps(5, 5))


def test_what_gauges_can_not_do(controller: StepRampController) -> None:
    controller.prepare_push([design()] * 4, mode="try")()
    controller.use_settings(Settings(outputs="gauges"))
    with pytest.raises(Rejected, match="a gauge: 0 to 2") as caught:
        controller.move_by(by_steps(5, 5, 5, 5))
    assert (caught.value.rejections[0].field, caught.value.rejections[0].value) == ("axes.3.axis", 3)
    with pytest.raises(Refused, match="line"):
        controller.line(by_steps(5, 5))
    controller.move_by(by_steps(5, 5, 5))


# ---- traces ----


def test_a_trace_is_collected_with_the_plan_of_the_move(connect: Connect) -> None:
    script = stored().then(TraceRequest(0, 2), TraceReply(2))
    script.then(StatusRequest(0), IDLE).then(StatusRequest(0), IDLE)
    script.then(MoveByRequest(1, (-5,)), TargetsReply((-5,)))
    controller = connect(script)
    assert controller.trace is None
    assert controller.trace_moves(0, 2) == 2
    controller.move_by([Asked(0, -5, "by_steps")])
    # The slowest five of 4000, 2828 … up and 4000, 3900 … down: 4000 up, then 3700, 3800, 3900, 4000 down.
    script.unasked = said(TraceNotice(0, 2, 1, (60_000, (60_000 + 7700) % 65_536))) + said(
        TraceNotice(0x80, 2, 5, ((60_000 + 15_400 + 4) % 65_536,)), 1
    )
    controller.listen()
    assert controller.trace is not None
    trace = controller.trace()
    assert (trace.complete, trace.step.tolist()) == (True, [1, 3, 5])
    assert trace.planned_ticks.tolist() == [0, 7700, 15_400]
    assert trace.deviation_us.tolist() == [0.0, 0.0, 2.0]


def test_a_stop_ends_the_trace(connect: Connect) -> None:
    script = stored().then(TraceRequest(0, 0), TraceReply(1))
    script.then(StatusRequest(0), IDLE).then(StatusRequest(0), IDLE)
    script.then(RunRequest(1, (2000,)), DoneReply()).then(StopRequest(), DoneReply())
    controller = connect(script)
    controller.trace_moves(0, 0)
    controller.run([Asked(0, 1000.0, "speed_steps_per_s")])
    script.unasked = said(TraceNotice(0, 1, 1, (1, 4001)))
    controller.listen()
    controller.stop()
    script.unasked = said(TraceNotice(0x80, 1, 3, (9, 9)))
    controller.listen()
    assert controller.trace is not None
    trace = controller.trace()
    assert (trace.changed, trace.complete, trace.step.tolist()) == (True, True, [1, 2])


def test_no_trace_of_an_axis_that_is_not_there(connect: Connect) -> None:
    with pytest.raises(Rejected) as caught:
        connect(stored()).trace_moves(2, 0)
    assert caught.value.rejections[0].field == "traced_axis"


# ---- ramps and settings ----


def test_storing_an_image(connect: Connect) -> None:
    writing = StatusReply(3, 0, 0, 0, 0, 0, 1, 1, 0, 0)
    script = Script().delivers(BYTES).then(CommitRequest(), DoneReply()).then(StatusRequest(0), writing)
    script.then(StatusRequest(0), StatusReply(0, 0, 0, 0, 0, 0, 9, 1, 0, 0)).reads(0, BYTES)
    assert connect(script).store(BYTES) == (BYTES, 9)


def test_trying_an_image(connect: Connect) -> None:
    script = stored().delivers(BYTES).then(TryRequest(), DoneReply()).then(StatusRequest(0), IDLE).reads(1, BYTES)
    assert connect(script).try_out(BYTES) == (BYTES, 1)


def test_what_the_ram_holds_is_compared_before_it_is_used(connect: Connect) -> None:
    controller = connect(Script().delivers(BYTES, staged=bytes(len(BYTES))))
    with pytest.raises(Refused, match="another ramp than the one sent"):
        controller.store(BYTES)


def test_a_memory_that_fails(connect: Connect) -> None:
    script = Script().delivers(BYTES).then(CommitRequest(), DoneReply())
    script.then(StatusRequest(0), StatusReply(0, 0, 0, 0, 0, 0, 1, 1, 1, 0))
    with pytest.raises(Refused, match="could not store"):
        connect(script).store(BYTES)


def test_a_memory_that_never_gets_done(connect: Connect, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transfer, "WRITE_TIMEOUT_S", 0.0)
    script = Script().delivers(BYTES).then(CommitRequest(), DoneReply())
    script.then(StatusRequest(0), StatusReply(3, 0, 0, 0, 0, 0, 1, 1, 0, 0))
    with pytest.raises(Refused, match="without an end"):
        connect(script).store(BYTES)


@pytest.mark.parametrize(
    ("refusal", "words"),
    [
        (Refusal(ReplyStatus.BAD_CRC, 0x1234), "arrived damaged"),
        (Refusal(ReplyStatus.BAD_RAMP, 0x0211), "refuses segment 17 of ramp 2"),
        (Refusal(ReplyStatus.BAD_RAMP, 0x02FF), "refuses the header of ramp 2"),
        (Refusal(ReplyStatus.BAD_RAMP, 0xFFFF), "refuses the ramps' header"),
        (Refusal(ReplyStatus.OUT_OF_ORDER, 48), r"out_of_order \(48\)"),
    ],
)
def test_an_image_that_is_refused(connect: Connect, refusal: Refusal, words: str) -> None:
    script = Script().then(BeginRequest(1, crc16(b"x")), DoneReply()).then(DataRequest(0, b"x"), DataReply(1))
    script.then(EndRequest(), refusal)
    with pytest.raises(Refused, match=words):
        connect(script).store(b"x")


def test_a_push_is_refused_while_moving(connect: Connect) -> None:
    image = plan_push([design()], HELLO, Settings()).image.encode()
    controller = connect(Script().then(BeginRequest(len(image), crc16(image)), Refusal(ReplyStatus.MOVING)))
    with pytest.raises(Refused, match="moves"):
        controller.prepare_push([design()])()


def test_a_push_to_one_axis_does_not_undo_another(connect: Connect) -> None:
    plan = plan_push([design()], HELLO, Settings(), 0)
    image = plan.image.encode()
    script = Script().delivers(image).then(TryRequest(), DoneReply()).then(StatusRequest(0), NO_RAMP).reads(1, image)
    controller = connect(script)
    first, second = (controller.prepare_push([design()], 0, "try") for _ in range(2))
    assert not first().kept
    with pytest.raises(Refused, match="changed in the meantime"):
        second()


def test_keeping(connect: Connect) -> None:
    script = stored().then(CommitRequest(), DoneReply()).then(StatusRequest(0), IDLE).reads(0, BYTES)
    connect(script).keep()
    with pytest.raises(Refused, match="push a design first"):
        connect(Script()).keep()


def test_rolling_back(connect: Connect) -> None:
    on_trial = StatusReply(0, 0, 0, 0, 0, 0, 1, 7, 2, 0)
    script = stored().then(StatusRequest(0), on_trial).then(RollBackRequest(), DoneReply())
    script.then(StatusRequest(0), IDLE).then(ReadSettingsRequest(), SettingsReply(Settings().pack())).reads(0, BYTES)
    controller = connect(script.then(StatusRequest(0), IDLE))
    controller.roll_back()
    with pytest.raises(Refused, match="Nothing is on trial"):
        controller.roll_back()


def test_restoring(connect: Connect) -> None:
    previous, restored = four_axes().encode(), StatusReply(0, 0, 0, 0, 0, 0, 2, 7, 0, 0)
    settings = SettingsReply(Settings(pulse_width_us=4).pack())
    script = stored().then(StatusRequest(0), IDLE).reads(2, previous).then(RollBackRequest(), DoneReply())
    script.then(StatusRequest(0), restored).then(ReadSettingsRequest(), settings).reads(0, previous)
    connect(script.then(StatusRequest(0), restored)).restore()


def test_restoring_what_is_not_there_or_while_something_is_on_trial(connect: Connect) -> None:
    script = stored().then(StatusRequest(0), IDLE).reads(2, b"")
    with pytest.raises(Refused, match="no ramps that were stored before"):
        connect(script).restore()
    on_trial = StatusReply(0, 0, 0, 0, 0, 0, 1, 7, 2, 0)
    with pytest.raises(Refused, match="roll them back first"):
        connect(stored().then(StatusRequest(0), on_trial)).restore()


def test_restoring_when_an_image_was_delivered_and_not_used(connect: Connect) -> None:
    """The first roll back then only drops that one."""
    settings, restored = SettingsReply(Settings().pack()), StatusReply(0, 0, 0, 0, 0, 0, 2, 7, 0, 0)
    script = stored().then(StatusRequest(0), IDLE).reads(2, BYTES).then(RollBackRequest(), DoneReply())
    script.then(StatusRequest(0), IDLE).then(ReadSettingsRequest(), settings).reads(0, BYTES)
    script.then(StatusRequest(0), IDLE).then(RollBackRequest(), DoneReply())
    script.then(StatusRequest(0), restored).then(ReadSettingsRequest(), settings).reads(0, BYTES)
    connect(script).restore()


def test_settings(connect: Connect) -> None:
    other = Settings(pulse_width_us=9)
    script = Script(settings=other).then(ReadSettingsRequest(), SettingsReply(other.pack()))
    controller = connect(script.then(WriteSettingsRequest(Settings().pack()), DoneReply()))
    assert controller.settings() == other
    controller.use_settings(Settings())


def test_it_gives_way_before_each_request_and_while_the_memory_is_written(plug_in: Callable) -> None:
    gaps: list[float] = []
    script = Script().delivers(BYTES).then(CommitRequest(), DoneReply())
    script.then(StatusRequest(0), StatusReply(3, 0, 0, 0, 0, 0, 1, 1, 0, 0))
    script.then(StatusRequest(0), IDLE).then(ReadRequest(0, 0, 48), ReadReply(0, b""))
    port = SerialPort(plug_in(script))
    controller = StepRampController(port, gaps.append)
    controller.connect()
    assert controller.store(BYTES) == (b"", 1)
    requests = 1 + 2 + 3 + 2 * -(-len(BYTES) // 48)
    assert gaps == [0.0] * (requests + 1) + [transfer.WRITE_POLL_S] + [0.0] * 2
    port.close()
