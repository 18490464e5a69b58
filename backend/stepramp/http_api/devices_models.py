"""What the routes over devices take and answer."""

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from stepramp.controllers.axes import MOST_AXES
from stepramp.controllers.capabilities import CapabilityName
from stepramp.controllers.contract import FigureUnit, PushReport
from stepramp.controllers.families import FAMILIES, USUAL_FAMILY
from stepramp.controllers.inputs import End, Level, LimitStop, RoleName, StopCause
from stepramp.controllers.progress import PushStage
from stepramp.design import Design
from stepramp.devices.pages import name_of
from stepramp.devices.view import DeviceState
from stepramp.errors import Count
from stepramp.http_api.answer import Answer
from stepramp.http_api.error_items import TOLD_OF_EACH, ToldAnswer
from stepramp.validation import Document, ListOrNull, Text, Within, refuse


class PortPayload(Document):
    """A port."""

    port: Annotated[str, Text(200)] = Field(
        description="Name of a serial port, or an address: sim://, or rfc2217://host:port, socket://host:port and "
        "moonraker://host:port (Klipper) of a host that was named when the server was started, by --allow-remote-port "
        "host:port. No other is ever reached"
    )


class ConnectPayload(PortPayload):
    """A port to connect to."""

    family: Annotated[str, Text(100)] = Field(
        USUAL_FAMILY,
        description="Which family of controllers the one at the port is of, by its name, as `GET /ports` tells. It is "
        "never guessed: what is a greeting to one may set the motor of another moving",
        json_schema_extra={"enum": list(FAMILIES)},
    )


class PushDesigns(Document):
    """Designs whose ramps a controller is to use: one for one axis, or those of all axes."""

    design: Design | None = Field(None, description="A design for one axis; the other axes keep their ramps")
    to_axis: Annotated[int, Within(0, 3)] = Field(
        0, description="Which axis `design` is for: one that has a ramp, or the next one"
    )
    axes: Annotated[list[Design] | None, ListOrNull("designs, one for each axis", most=MOST_AXES, least=1)] = Field(
        None, description="The designs of all axes, axis 0 first, all made for the same clock of the controller"
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        if self.design is not None and self.axes is not None:
            refuse("axes", Count(f"{len(self.axes)} designs"), "nothing, since design is given")
        if self.design is None and self.axes is None:
            refuse("design", None, "a design, or else axes")
        return self

    @property
    def designs(self) -> list[Design]:
        """The designs, of one axis or of all."""
        return self.axes if self.axes is not None else [self.design] if self.design is not None else []

    @property
    def first_axis(self) -> int | None:
        """Axis of the only design; None: they are those of all axes."""
        return self.to_axis if self.axes is None else None


class PushPayload(PushDesigns):
    """Designs whose ramps the controller is to use, and for how long."""

    mode: Literal["keep", "try"] = Field(
        "keep", description="keep: store the ramps. try: use them until they are kept, rolled back, or the board resets"
    )


class PortAnswer(Answer):
    """A port that can be connected to."""

    port: str = Field(description="What to connect to")
    name: str = Field(description="What people call it")
    virtual: bool = Field(description="Whether nothing is attached: the virtual controller")
    families: list[str] = Field(
        description="Names of the families that what is there may be connected as; another one is refused with 422"
    )


class FamilyAnswer(Answer):
    """A family of controllers."""

    name: str = Field(description="What requests call it")
    title: str = Field(description="What people call it")
    kind: str = Field(
        description="Name of the family whose controllers its are, its own or another one: backups of one can be "
        "restored to the other"
    )
    capabilities: list[str] = Field(
        description="What its controllers can do at most, besides what all can; one that is connected tells its own"
    )
    cannot: list[str] = Field(description="What its controllers can't take of a design, or do, as sentences")
    plays_own: bool = Field(
        description="Whether its controllers work the intervals out themselves, and it is known how: "
        "`POST /families/{name}/ramp` tells them"
    )
    reads_settings: bool = Field(description="Whether `POST /import` knows the text that they tell their settings as")


class PortsAnswer(Answer):
    """What can be connected to."""

    ports: list[PortAnswer] = Field(description="The ports of this machine, then those of others, the virtual one last")
    families: list[FamilyAnswer] = Field(description="The families that a controller at a port may be of")


class FoundAnswer(Answer):
    """What a controller says of itself as it starts."""

    family: str | None = Field(description="Name of the family that it names; null: none that is known was named")
    heard: list[str] = Field(description="The line that named it, or else the first ones that were legible")


class RampAnswer(Answer):
    """The ramps that a controller has."""

    sequence: int | None = Field(
        description="How often ramps were stored so far, these included; 0: they are only on trial, null for a "
        "controller that never stores any"
    )
    crc: int | None = Field(description="CRC-16 of their image; null for a controller without an image of them")


class OwnTermsAnswer(Answer):
    """A figure as the controller itself has it."""

    term: str = Field(description="What the controller calls it, such as $120")
    unit: str = Field(description="Its own unit")
    sent: float | None = Field(description="What is sent, or was; null for nothing")
    on_device: float | None = Field(
        description="What it has, after a push as it was read back; null for nothing, or nothing that makes sense"
    )


OWN = "The same in the controller's own terms; null where those are the same"
UNIT = "Unit of the figures; CRC-16 for a checksum, nothing for a mere number"


class PushItemAnswer(Answer):
    """One figure on its way from the design to the controller, in its unit."""

    name: str = Field(description="What it is")
    unit: FigureUnit = Field(description=UNIT)
    requested: float = Field(description="What the design asks for")
    sent: float = Field(description="What was sent")
    read_back: float | None = Field(description="What the controller has; null when that makes no sense")
    axis: int | None = Field(description="Axis whose figure it is; null: all axes'")
    own: OwnTermsAnswer | None = Field(description=OWN)


class PushAnswer(Answer):
    """What came of a push."""

    items: list[PushItemAnswer]
    verified: bool = Field(
        description="Whether what was read back is what was sent, as exactly as the controller tells it"
    )
    segments: int | None = Field(
        description="Segments of all ramps that the controller now has; null for one that takes no segments"
    )
    bytes: int = Field(description="Length of their image [bytes]")
    largest_deviation_us: float | None = Field(
        description="Largest difference between an interval of a design's ramp and the controller's [µs], of the "
        "design's move where the controller works out the intervals itself; null: not known, or a warning says why"
    )
    sequence: int | None = Field(
        description="How often the controller has stored ramps so far; null for one that never does"
    )
    kept: bool = Field(description="Whether they are stored; otherwise on trial")
    warnings: list[str] = Field(description="What works, but not as the designs say")
    warnings_told: list[list[ToldAnswer]] = Field(description=TOLD_OF_EACH)


class PushedAnswer(PushAnswer):
    """What came of a push that was just asked for."""

    heard_s: float = Field(
        description="When the controller has last said what it does since, as a device's heard_s: what it is heard to "
        "have later replaces these ramps [s]"
    )

    @classmethod
    def of(cls, report: PushReport, heard_s: float) -> Self:
        """Return a report as an answer."""
        return cls(**dict(PushAnswer.model_validate(report)), heard_s=heard_s)


class PreviewItemAnswer(Answer):
    """One figure that a push would bring, in its unit."""

    name: str = Field(description="What it is")
    unit: FigureUnit = Field(description=UNIT)
    on_device: float | None = Field(description="What the controller has; null for nothing")
    to_send: float | None = Field(description="What it would have; null for nothing")
    differs: bool = Field(description="Whether the push would change it")
    axis: int | None = Field(description="Axis whose figure it is; null: all axes'")
    own: OwnTermsAnswer | None = Field(description=OWN)


class PreviewAnswer(Answer):
    """What a push would change of the ramps in use."""

    items: list[PreviewItemAnswer]
    same: bool = Field(description="Whether the controller has exactly these ramps already, byte for byte")
    segments: int | None = Field(
        description="Segments of all ramps that would be sent; null for a controller that takes no segments"
    )
    bytes: int = Field(description="Length of their image [bytes]")
    largest_deviation_us: float | None = Field(
        description="Largest difference between an interval of a design's ramp and the one sent [µs]; null: not known"
    )
    warnings: list[str] = Field(description="What would work, but not as the designs say")
    warnings_told: list[list[ToldAnswer]] = Field(description=TOLD_OF_EACH)


class ProgressAnswer(Answer):
    """How far a push has come."""

    stage: PushStage = Field(
        description="planning, sending, checking (reading back before it is used), storing, reading_back; in this order"
    )
    bytes_done: int = Field(description="How far this stage has come [bytes]")
    bytes_total: int = Field(description="How far it goes; 0: that isn't counted in bytes [bytes]")


class ShuttleAnswer(Answer):
    """An axis that goes there and back."""

    axis: int = Field(description="Which axis, from 0")
    by_steps: int = Field(description="How far it goes [steps]")
    times: int = Field(description="How often there and back")
    times_done: int = Field(description="How often it is back already")
    pause_s: float = Field(description="Pause at each end [s]")


class AxisAnswer(Answer):
    """An axis as it is now."""

    axis: int = Field(description="Its number, from 0")
    state: DeviceState = Field(description="ready, moving or stopping; lost with its device")
    position_steps: int = Field(description="Where its motor is [steps]")
    target_steps: int = Field(
        description="Where it will come to rest; its position as long as it runs at a speed, and right after a stop "
        "until the controller has said where; of what is lost, where it was going when it was last heard of [steps]"
    )
    speed_steps_per_s: float = Field(
        description="How fast it moves, without sign; of what is lost, how fast it did when it was last heard of "
        "[steps/s]"
    )
    steps_made: int = Field(description="Steps since it last set out from rest [steps]")
    steps_per_mm: float | None = Field(
        description="As the controller itself is set; null for one that counts in steps only [steps/mm]"
    )
    microsteps: int | None = Field(
        description="How many of its steps the controller makes of a full step; null where it doesn't tell"
    )
    lowest_steps: int | None = Field(description="Soft limit: the lowest position; null for none [steps]")
    highest_steps: int | None = Field(description="Soft limit: the highest position; null for none [steps]")
    limits_hold: bool = Field(
        description="Whether it has soft limits and is kept within them just now, as its position is counted: "
        "`position_known` tells whether it is there. While it is homed it isn't"
    )
    position_known: bool | None = Field(
        description="Whether it is known that its motor is there: since it was homed, or its position set. Not after a "
        "reset, nor once it was halted at speed, nor while `unknown_positions` names it. It moves all the same. null "
        "where the controller doesn't tell"
    )
    position_told: bool = Field(
        description="Whether the controller tells where it is. false where its settings make no sense or it isn't "
        "ready, and of an axis that Klipper hasn't homed: then position and target say nothing"
    )
    homing: bool | None = Field(description="Whether it is being homed; null where the controller doesn't tell")
    is_beyond_limits: bool = Field(
        description="Whether it is beyond its soft limits: then only moves that end within them, and runs towards "
        "them, are taken"
    )


class OtherAnswer(Answer):
    """A setting that is another since its start than was written."""

    name: str = Field(description="What the controller calls it")
    written: str = Field(description="What was written, as it was sent")
    at: str = Field(description="When that was, in UTC, for people")
    now: str | None = Field(description="What it had after its start, as it was told; null: it wasn't there")


class ProofAnswer(Answer):
    """What a start of a controller has shown of settings that it was given before."""

    proven: list[str] = Field(description="Settings that it had as they were written: it has stored them")
    not_kept: list[str] = Field(
        description="Settings that are others: they weren't kept, or were set by somebody else since"
    )
    others: list[OtherAnswer] = Field(description="The same settings, with both values")
    stored: str | None = Field(description="What is said of the proven ones, as a sentence; null where none is")
    words: str = Field(description="All of it as sentences, with what was written when, and what it has")


class InputAnswer(Answer):
    """An input that is for something."""

    input: str = Field(description="Its name on the board, such as A0")
    role: RoleName = Field(
        description="emergency_stop: halts all axes. driver_fault: as well. limit: a switch at an end of an axis"
    )
    is_active: bool = Field(description="Whether it is active now")
    active: Level = Field(description="The level at which it is active")
    pull_up: bool = Field(description="Whether the controller's own pull-up is on")
    axis: int | None = Field(description="Of a limit: of which axis; null for other roles")
    end: End | None = Field(description="Of a limit: at which end of the axis; null for other roles")
    stops: LimitStop | None = Field(
        description="Of a limit: how it stops the axis, with its ramp or at once; null for other roles"
    )


def _own_name(page: str | None) -> str | None:
    return None if page is None else name_of(page)


class DeviceAnswer(Answer):
    """A device as it is now."""

    id: str = Field(description="What the routes call it")
    port: str = Field(description="Where it is")
    name: str = Field(description="What people call it")
    family: str = Field(description="The name of the family of controllers that it is of")
    capabilities: list[CapabilityName] = Field(
        description="What it can do besides what all controllers can; none until it is connected first. keep: store "
        "pushed ramps. try: use them without that, and roll back. restore: bring back those before. settings; trace; "
        "line; zero: as the requests of that name. inputs: it tells them, and can be homed and acknowledged. backup: "
        "its settings are saved before they are written to. prove: it proves by a start that it has stored them. "
        "What it can't do is refused with 409"
    )
    state: DeviceState = Field(
        description="moving: one of its axes moves; stopping: all that move slow down. lost: no longer there; it is "
        "connected again when it comes back"
    )
    message: str | None = Field(
        description="Why it is lost, what keeps its motors from being moved, which backup it lacks, or "
        "which settings it hasn't got since its start"
    )
    position_steps: int = Field(
        description="Where the motor of axis 0 is; of what is lost, where it was when it was last heard of, which is "
        "age_s ago; 0 while age_s is null. Where its `position_told` is false it says nothing, whatever it is [steps]"
    )
    target_steps: int = Field(description="Where axis 0 will come to rest, as in axes [steps]")
    speed_steps_per_s: float = Field(
        description="How fast axis 0 moves, without sign; of what is lost, how fast it did when it was last heard of "
        "[steps/s]"
    )
    axes: list[AxisAnswer] = Field(description="All axes that have a ramp; axis 0 in any case, once connected")
    most_axes: int | None = Field(
        description="How many axes it can have; a push to one beyond is refused. null until it is connected"
    )
    timer_hz: int | None = Field(
        description="Ticks a second of its step timer with the ramps in use [Hz]; null until it is connected, and for "
        "a controller without one"
    )
    clocks_hz: list[int] | None = Field(
        description="Ticks a second that the timer can have, fastest first, none without a step timer [Hz]; null until "
        "it is connected"
    )
    firmware_version: str | None = Field(
        description="Version of its firmware; null until it is connected, and where it isn't told"
    )
    ramp: RampAnswer | None = Field(description="The ramps that it uses; null for none")
    on_trial: bool = Field(description="Whether ramps or settings are in use that are not stored")
    motors_on: bool = Field(description="Whether its enable pin has the motors switched on")
    starved: int | None = Field(
        description="How often a motor's next step was not known in time since it started; 0 when all is well, null "
        "for a controller that doesn't count that"
    )
    inputs: list[InputAnswer] | None = Field(
        description="Its inputs that are for something, as its settings say; null for a controller without any"
    )
    stopped_by: list[StopCause] | None = Field(
        description="What has stopped all motion, and has to be acknowledged before anything moves again; empty for "
        "nothing, null for a controller without inputs"
    )
    pushed: PushAnswer | None = Field(
        description="The last push over this connection, or before it was started anew to prove what it has stored; "
        "once what was on trial is kept, with what that has told. null for none"
    )
    backup: str | None = Field(
        description="The name of the last backup that was saved of it since it was connected first; null for none"
    )
    lacks_backup: str | None = Field(
        description="The name of the backup to restore, since it was lost while it was given settings: of what it had "
        "before. Until that one, or one as old, is written; null for none"
    )
    unproven: list[str] = Field(
        description="Settings that it was given, also before it was connected now, and of which only its next start "
        "proves whether it has stored them, or `POST /devices/{id}/prove`"
    )
    unproven_words: str | None = Field(
        description="The same as sentences, and what can be done; null for none but those that `proof` tells of"
    )
    proving: bool = Field(
        description="Whether its controller is being started anew from here to prove them: its axes, what it can do, "
        "and what was pushed to it, are told as they were before"
    )
    proof: ProofAnswer | None = Field(
        description="What its last start has shown of such settings, until they are written again; null for nothing"
    )
    progress: ProgressAnswer | None = Field(description="How far the push has come that is under way; null for none")
    shuttle: ShuttleAnswer | None = Field(description="What goes there and back; null for nothing")
    unknown_positions: list[int] = Field(
        description="Axes that may be elsewhere than the server has counted with: since the device was lost or "
        "started anew; since homing them has begun and hasn't ended well; and with soft limits, since the device was "
        "disconnected or somebody else has homed them. Until they are set, homed or zeroed. What a controller itself "
        "doesn't know, as after a halt at speed, only `axes[].position_known` tells"
    )
    in_control: Annotated[str | None, BeforeValidator(_own_name)] = Field(
        description="What the page that is in control calls itself: others must take over first. null for none; "
        "programs need none"
    )
    in_control_at: str | None = Field(
        description="Address of the machine where that page is; null for a server that answers its own machine only"
    )
    stops: int = Field(
        description="A number that grows with each stop of it: what is asked with an earlier one in the header "
        "X-StepRamp-Stops moves nothing"
    )
    heard_s: float = Field(description="When the controller said so, by a clock of the server [s]")
    age_s: float | None = Field(
        description="How old that is as this is told, by the same clock: under 1 s as long as all is well. null before "
        "it has said anything [s]"
    )


class KeptAnswer(DeviceAnswer):
    """A device once it has stored what was in use."""

    remarks: list[str] = Field(
        description="What else there is to say, as sentences: what had to be changed besides, and where what it had "
        "before is kept"
    )


class DevicesAnswer(Answer):
    """All devices."""

    devices: list[DeviceAnswer]


class DisconnectedAnswer(Answer):
    """Nothing: the device is gone."""
