"""The virtual controller's ramps and settings: what was delivered, what is on trial, what is stored."""

from collections.abc import Callable
from dataclasses import replace
from enum import Enum, auto

from stepramp.controllers.stepramp.frames import crc16
from stepramp.controllers.stepramp.messages.body import DoneReply, Reply
from stepramp.controllers.stepramp.messages.ramps import (
    MOST_DATA,
    BeginRequest,
    DataReply,
    DataRequest,
    EndReply,
    ReadReply,
    ReadRequest,
    ReadSource,
)
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.session import HelloReply, RampInUse
from stepramp.controllers.stepramp.ramp_image import BadRampImage, IntervalLimits, RampImage
from stepramp.controllers.stepramp.settings import USUAL_OF_INPUTS, StepRampSettings
from stepramp.controllers.stepramp.soft_limits import NO_LIMITS
from stepramp.controllers.virtual.memory import VirtualMemory

USUAL = StepRampSettings().pack() + USUAL_OF_INPUTS
"""The settings of a controller that has stored none."""
Use = Callable[[RampImage | None, StepRampSettings], None]


class Content(Enum):
    """What the image in RAM is."""

    NOTHING = auto()
    RECEIVING = auto()
    CHECKED = auto()
    ON_TRIAL = auto()
    STORED = auto()


PLAYABLE = (Content.ON_TRIAL, Content.STORED)
DELIVERED = (Content.RECEIVING, Content.CHECKED)


class VirtualStore:
    """One image in RAM and two in the memory.

    use: called with what is to be played from now on.
    """

    def __init__(self, memory: VirtualMemory, clock: Callable[[], float], hello: HelloReply, use: Use) -> None:
        self._memory = memory
        self._clock = clock
        self._limits = IntervalLimits.of(hello)
        self._largest_image_bytes = hello.largest_image_bytes
        self._use = use
        self._announced = BeginRequest(0, 0)
        self.writing = False
        self.packed = USUAL
        """The settings in use, as they travel."""
        self.limits = NO_LIMITS
        """The soft limits in use, of all axes, as they are stored."""
        self._load_stored()

    @property
    def settings(self) -> StepRampSettings:
        """The settings in use."""
        return StepRampSettings.unpack(self.packed, self.limits)

    @property
    def sequence(self) -> int:
        """How many contents were stored so far; 0: none."""
        return self._memory.active().sequence

    @property
    def image_crc(self) -> int:
        """CRC of the image that is on trial, or else of the stored one."""
        image = bytes(self._ram) if self._content is Content.ON_TRIAL else self._memory.active().image
        return crc16(image) if image else 0

    @property
    def on_trial(self) -> bool:
        """Whether ramps or settings are in use that are not stored."""
        return self._content is Content.ON_TRIAL or not self._settings_are_stored

    @property
    def axes(self) -> int:
        """Axes of the ramps in use."""
        image = bytes(self._ram) if self._content is Content.ON_TRIAL else self._memory.active().image
        return len(RampImage.decode(image).axes) if image else 0

    def introduced(self, hello: HelloReply) -> HelloReply:
        """Return a hello that says which ramp is in use."""
        stored = RampInUse.STORED if self.sequence else RampInUse.NONE
        in_use = RampInUse.ON_TRIAL if self._content is Content.ON_TRIAL else stored
        return replace(hello, ramp_sequence=self.sequence, image_crc=self.image_crc, ramp_in_use=in_use)

    def settle(self) -> None:
        """Write what there was time for."""
        self._memory.settle(self._clock())
        if self.writing and not self._memory.writing:
            self.writing = False
            self._load_stored()

    def make_ready(self) -> bool:
        """Drop what was delivered and not tried, and return whether there are ramps to move with."""
        if self._content not in PLAYABLE and self.sequence:
            self._load(with_settings=False)
        return self._content in PLAYABLE

    def use_settings(self, packed: bytes) -> None:
        """Use other settings from now on."""
        self.packed, self._settings_are_stored = packed, False
        self._use_all()

    def use_limits(self, axis: int, limit: bytes) -> None:
        """Use other soft limits of an axis from now on."""
        at = axis * len(limit)
        self.limits = self.limits[:at] + limit + self.limits[at + len(limit) :]
        self._settings_are_stored = False
        self._use_all()

    def begin(self, request: BeginRequest) -> Reply | Refusal:
        """Take an image from now on."""
        if request.length > self._largest_image_bytes:
            return Refusal(ReplyStatus.OUT_OF_RANGE, self._largest_image_bytes)
        self._announced, self._ram, self._content = request, bytearray(), Content.RECEIVING
        self._use_all()
        return DoneReply()

    def data(self, request: DataRequest) -> Reply | Refusal:
        """Take a part of the image."""
        if self._content not in DELIVERED or request.offset != len(self._ram):
            return self._out_of_order()
        if len(self._ram) + len(request.data) > self._announced.length:
            return Refusal(ReplyStatus.OUT_OF_RANGE, self._announced.length)
        self._ram += request.data
        return DataReply(len(self._ram))

    def end(self) -> Reply | Refusal:
        """Check the image."""
        if self._content not in DELIVERED or len(self._ram) != self._announced.length:
            return self._out_of_order()
        if crc16(bytes(self._ram)) != self._announced.crc:
            return Refusal(ReplyStatus.BAD_CRC, crc16(bytes(self._ram)))
        try:
            image = RampImage.decode(bytes(self._ram), self._limits)
        except BadRampImage as bad:
            return Refusal(ReplyStatus.BAD_RAMP, bad.detail)
        self._content = Content.CHECKED
        return EndReply(len(image.axes), self._ram[3])

    def try_out(self) -> Reply | Refusal:
        """Use the checked image."""
        if self._content is not Content.CHECKED:
            return self._out_of_order()
        self._content = Content.ON_TRIAL
        self._use_all()
        return DoneReply()

    def commit(self) -> Reply | Refusal:
        """Begin to store the image in RAM and the settings in use."""
        if self._content is not Content.CHECKED and self._content not in PLAYABLE:
            return self._out_of_order()
        self._memory.begin_write(self.packed + self.limits, bytes(self._ram), self._clock())
        self.writing = True
        return DoneReply()

    def roll_back(self) -> Reply | Refusal:
        """Drop what is not stored; when there is nothing of the kind, begin to bring the previous content back."""
        if self._content in DELIVERED or self.on_trial:
            self._load_stored()
        elif not self._memory.previous().image:
            return Refusal(ReplyStatus.NO_RAMP)
        else:
            self._memory.begin_restore(self._clock())
            self.writing = True
        return DoneReply()

    def read(self, request: ReadRequest) -> Reply | Refusal:
        """Return a part of an image."""
        if request.source not in list(ReadSource):
            return Refusal(ReplyStatus.OUT_OF_RANGE, request.source)
        if not 1 <= request.length <= MOST_DATA:
            return Refusal(ReplyStatus.OUT_OF_RANGE, request.length)
        image = {
            ReadSource.STORED: self._memory.active().image,
            ReadSource.RAM: bytes(self._ram),
            ReadSource.PREVIOUS: self._memory.previous().image,
        }[ReadSource(request.source)]
        return ReadReply(len(image), image[request.offset : request.offset + request.length])

    def _out_of_order(self) -> Refusal:
        received = len(self._ram) if self._content in DELIVERED else 0
        return Refusal(ReplyStatus.OUT_OF_ORDER, received)

    def _load_stored(self) -> None:
        self._load(with_settings=True)

    def _load(self, *, with_settings: bool) -> None:
        """Use what is stored; its settings, too, when those in use are to be dropped."""
        stored = self._memory.active()
        self._ram = bytearray(stored.image)
        self._content = Content.STORED if stored.sequence else Content.NOTHING
        if with_settings:
            known = stored.settings if stored.sequence else b""
            self.packed = known[: len(USUAL)] + USUAL[len(known) :]
            self.limits = known[len(USUAL) :] or NO_LIMITS
            self._settings_are_stored = True
        self._use_all()

    def _use_all(self) -> None:
        image = RampImage.decode(bytes(self._ram), self._limits) if self._content in PLAYABLE else None
        self._use(image, self.settings)
