"""The ramps and settings that a controller uses and stores."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial

from stepramp.controllers.contract import AnswerUnknown, ControllerStatus
from stepramp.controllers.inputs import CALLED
from stepramp.controllers.stepramp.conversation import Conversation
from stepramp.controllers.stepramp.input_roles import EMERGENCY_INPUTS, GAUGE_INPUTS, INPUTS
from stepramp.controllers.stepramp.messages.axes import MOST_AXES
from stepramp.controllers.stepramp.messages.body import DoneReply
from stepramp.controllers.stepramp.messages.ramps import ReadSource, RollBackRequest
from stepramp.controllers.stepramp.messages.reply import Refusal
from stepramp.controllers.stepramp.messages.session import RampInUse
from stepramp.controllers.stepramp.messages.settings import (
    SETTINGS_BYTES,
    LimitsReply,
    ReadLimitsRequest,
    ReadSettingsRequest,
    SettingsReply,
    WriteLimitsRequest,
    WriteSettingsRequest,
)
from stepramp.controllers.stepramp.messages.status import StatusReply, StatusRequest
from stepramp.controllers.stepramp.ramp_image import BadRampImage, RampImage
from stepramp.controllers.stepramp.settings import OFFSETS, StepRampSettings
from stepramp.controllers.stepramp.soft_limits import bounds_of
from stepramp.controllers.stepramp.transfer import Transfer
from stepramp.errors import Count, DeviceLost, Refused, Rejected, Rejection


class Storage:
    """What a controller uses, as far as it is learnt, and how that changes.

    port_name: where the controller is. look_again: learns anew what the controller uses. used: called when other ramps
    or settings have come into use.
    """

    def __init__(
        self,
        conversation: Conversation,
        transfer: Transfer,
        port_name: str,
        look_again: Callable[[], None],
        used: Callable[[], None],
    ) -> None:
        self._conversation = conversation
        self._transfer = transfer
        self._port_name = port_name
        self._look_again = look_again
        self._used = used
        self.image: RampImage | None = None
        """The ramps in use."""
        self.settings = StepRampSettings()
        """Those in use."""
        self._packed = self.settings.pack()
        self.has_soft_limits = False
        """Whether it keeps axes within some."""
        self._limits = b""

    def store(self, image: bytes) -> tuple[bytes, int]:
        """Store a ramp image: send, read back from RAM, commit, read back from EEPROM.

        Returns what was read back and its sequence number. Raises Refused when the controller can't take it, or holds
        something else than what was sent: then the ramps it had stay active.
        """
        self._transfer.deliver(image)
        with self._looking_again():
            written = self._transfer.commit()
        return self.learn_image(RampInUse.STORED), written.ramp_sequence

    def try_out(self, image: bytes) -> tuple[bytes, int]:
        """Use a ramp image without storing it: send, read back from RAM, use. Returns as store does."""
        self._transfer.deliver(image)
        self._transfer.try_out()
        sequence = self._conversation.ask(StatusRequest(0), StatusReply).ramp_sequence
        return self.learn_image(RampInUse.ON_TRIAL), sequence

    def keep(self) -> None:
        """Store the ramps and settings in use."""
        if self.image is None:
            raise Refused("There is no ramp that the settings could be stored with: push a design first.")
        with self._looking_again():
            self._transfer.commit()
        self.learn_image(RampInUse.STORED)

    def roll_back(self, before: ControllerStatus) -> None:
        """Use the stored ramps and settings again; Refused when nothing else is in use."""
        if not before.on_trial:
            raise Refused("Nothing is on trial: the stored ramps and settings are in use.")
        self._roll_back()

    def restore(self, before: ControllerStatus) -> None:
        """Make the ramps and settings that were stored before the stored ones; Refused when there are none."""
        if before.on_trial:
            raise Refused("Ramps or settings are on trial: keep them or roll them back first.")
        if not self._transfer.read(ReadSource.PREVIOUS):
            raise Refused("The controller has no ramps that were stored before.")
        self._roll_back()
        sequence = before.ramp.sequence if before.ramp else 0
        if self._conversation.ask(StatusRequest(0), StatusReply).ramp_sequence == sequence:
            # An image had been delivered and not used: the first time only dropped that.
            self._roll_back()

    def read_settings(self) -> StepRampSettings:
        """Ask for the settings in use."""
        reply = self._conversation.ask(ReadSettingsRequest(), SettingsReply)
        limits = self._read_limits()
        try:
            settings = StepRampSettings.unpack(reply.settings, limits)
        except (Rejected, ValueError) as error:
            # Not the client's fault: a Rejected would name a field that nobody sent.
            raise DeviceLost(f"The controller at {self._port_name} has settings without sense: {error}") from error
        self._packed, self._limits = reply.settings, limits
        return settings

    def _read_limits(self) -> bytes:
        """Ask for the soft limits in use, of all axes; none are kept: nothing."""
        if not self.has_soft_limits:
            return b""
        return b"".join(
            self._conversation.ask(ReadLimitsRequest(axis), LimitsReply).pack() for axis in range(MOST_AXES)
        )

    def use_settings(self, settings: StepRampSettings) -> None:
        """Use other settings until a roll back or a reset; Rejected for those of inputs where there are none."""
        given, present = settings.given_of_inputs, self._packed
        if given and len(present) == SETTINGS_BYTES:
            allowed = f"null: the controller at {self._port_name} has no inputs, as its firmware is without, or older"
            raise Rejected([Rejection(name, _told(settings, name), allowed) for name in given])
        if settings.soft_limits and not self.has_soft_limits:
            allowed = f"null: the controller at {self._port_name} keeps none, as its firmware is without, or older"
            raise Rejected([Rejection("soft_limits", _told(settings, "soft_limits"), allowed)])
        _refuse_inputs_of_gauges(settings, StepRampSettings.unpack(settings.pack(present)))
        # Without these the first bytes alone are sent: the others stay as they are, whatever they have become.
        packed = settings.pack(present if given else b"")
        self._conversation.ask(WriteSettingsRequest(packed), DoneReply, partial(_refused_setting, settings))
        self._packed = packed + present[len(packed) :]
        self._write_limits(settings.pack_limits(self._limits))
        self._note_settings(StepRampSettings.unpack(self._packed, self._limits))

    def _write_limits(self, limits: bytes) -> None:
        for axis in range(MOST_AXES if self.has_soft_limits else 0):
            if bounds_of(limits, axis) != bounds_of(self._limits, axis):
                self._conversation.ask(WriteLimitsRequest(axis, *bounds_of(limits, axis)), DoneReply)
        self._limits = limits if self.has_soft_limits else b""

    def learn_settings(self) -> None:
        """Learn which settings are in use."""
        self._note_settings(self.read_settings())

    def learn_image(self, in_use: RampInUse) -> bytes:
        """Read the ramps in use, and return their image as bytes."""
        source = ReadSource.RAM if in_use is RampInUse.ON_TRIAL else ReadSource.STORED
        read = b"" if in_use is RampInUse.NONE else self._transfer.read(source)
        try:
            self.image = RampImage.decode(read) if read else None
        except BadRampImage as error:
            raise DeviceLost(f"The controller at {self._port_name} has ramps without sense: {error}") from error
        self._used()
        return read

    def _note_settings(self, settings: StepRampSettings) -> None:
        self.settings = settings
        self._used()

    def _roll_back(self) -> None:
        with self._looking_again():
            self._conversation.ask(RollBackRequest(), DoneReply)
        written = self._transfer.await_written()
        self.learn_settings()
        self.learn_image(RampInUse.STORED if written.ramp_sequence else RampInUse.NONE)

    @contextmanager
    def _looking_again(self) -> Iterator[None]:
        """When it isn't known whether a request was carried out, look at what the controller now has."""
        try:
            yield
        except AnswerUnknown:
            self._conversation.begin()
            with suppress(Refused):
                self._transfer.await_written()
            self._look_again()
            raise


def refuse_in_emergency(now: ControllerStatus) -> None:
    """Refused while an emergency stop holds: by a wrong level it would from each start on, and no software ends it."""
    if now.of_inputs is not None and "emergency_stop" in now.of_inputs.stopped_by:
        raise Refused(f"{now.of_inputs.trouble} Until then nothing is stored, as the stop's level may be a wrong one.")


def _refused_setting(settings: StepRampSettings, refusal: Refusal) -> Rejection:
    """Return which setting a controller refuses, by its offset: all are in their ranges, but an input may be active."""
    number = refusal.detail - OFFSETS["inputs"]
    name = INPUTS[number] if 0 <= number < len(INPUTS) else None
    place, role = next(((at, each) for at, each in enumerate(settings.inputs or ()) if each.input == name), (0, None))
    if role is None:
        return Rejection("settings", refusal.detail, "settings that this controller takes: that is the offset of one")
    other = "low" if role.active == "high" else "high"
    allowed = (
        f"{other}, unless the emergency stop is pressed: {role.input} is {role.active} now, so it would be active at "
        "once, and only what is wired there could end that. If it is pressed, release it first"
    )
    return Rejection(f"inputs.{place}.active", role.active, allowed)


def _told(settings: StepRampSettings, name: str) -> object:
    value = getattr(settings, name)
    called = "limited axes" if name == "soft_limits" else "inputs"
    return Count(f"{len(value)} {called}") if isinstance(value, tuple) else value


def _refuse_inputs_of_gauges(asked: StepRampSettings, merged: StepRampSettings) -> None:
    """Reject what an input is for whose pin is a gauge's: nothing would come of it. merged: with what stays."""
    if merged.outputs != "gauges":
        return
    taken = [role for role in merged.inputs or () if role.input in GAUGE_INPUTS]
    if taken and asked.inputs is None:
        told = " and ".join(f"{role.input}, {CALLED[role.role]}" for role in taken)
        allowed = f"step_and_direction as long as inputs are named whose pins are the gauges': {told}"
        raise Rejected([Rejection("outputs", asked.outputs, allowed)])
    rejections = [
        Rejection(
            f"inputs.{(asked.inputs or ()).index(role)}.input",
            role.input,
            f"for {CALLED[role.role]} one of {', '.join(EMERGENCY_INPUTS)}: with gauges, {role.input} is a coil's pin",
        )
        for role in taken
    ]
    if rejections:
        raise Rejected(rejections)
