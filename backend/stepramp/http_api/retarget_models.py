"""What the route for targets that change in flight takes and answers."""

from typing import Annotated, Self

from pydantic import FailFast, Field, model_validator

from stepramp.design import MOST_STEPS, SLOWEST_STEPS_PER_S, Design
from stepramp.errors import Limits
from stepramp.http_api.answer import Answer, WholeNumbers
from stepramp.http_api.planning_models import MostPoints
from stepramp.ramp.retarget import Command, PlayedSteps
from stepramp.validation import Document, ListOf, Within, refuse

MOST_COMMANDS = 10_000


class CommandPayload(Document):
    """What a motor is told, and when."""

    at_s: Annotated[float, Within(0, 1_000_000, "s")] = Field(description="Instant [s]")
    target_steps: Annotated[int, Within(-MOST_STEPS, MOST_STEPS, "steps")] | None = Field(
        None, description="Position to go to [steps]"
    )
    speed_steps_per_s: Annotated[float, Within(-1_000_000, 1_000_000, "steps/s")] | None = Field(
        None, description="Speed to go on with, negative for backwards; 0: slow down to rest [steps/s]"
    )

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        if (self.target_steps is None) == (self.speed_steps_per_s is None):
            refuse("target_steps", self.target_steps, "a target or speed_steps_per_s, one of them")
        if self.speed_steps_per_s and abs(self.speed_steps_per_s) < SLOWEST_STEPS_PER_S:
            allowed = f"0, or from {SLOWEST_STEPS_PER_S:g} to 1,000,000 steps/s either way"
            refuse("speed_steps_per_s", self.speed_steps_per_s, allowed)
        return self


class RetargetPayload(Document):
    """A ramp, and what a motor that plays it is told one after another."""

    design: Design = Field(
        description="Whose ramp is played: the one that a push of the design sends, which has the peak of the move "
        "where that is too short for the slew speed and move.plan is this_move"
    )
    commands: Annotated[list[CommandPayload], FailFast(), ListOf("commands", most=MOST_COMMANDS, least=1)] = Field(
        description="In order of time; after the last one the motor comes to rest"
    )
    direction_setup_us: Annotated[float, Within(0, 1_000_000, "µs")] = Field(
        5.0, description="From a change of direction to the next pulse [µs]"
    )
    max_points: MostPoints = None

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        for number in range(1, len(self.commands)):
            before, at_s = self.commands[number - 1].at_s, self.commands[number].at_s
            if at_s < before:
                limits = Limits(lowest=before, unit="s", note=", when the command before it comes")
                refuse(f"commands.{number}.at_s", at_s, limits)
        return self

    @property
    def told(self) -> list[Command]:
        """The commands as the numerics take them."""
        return [Command(each.at_s, each.target_steps, each.speed_steps_per_s) for each in self.commands]


class RestAnswer(Answer):
    """The motor came to rest."""

    at_s: float = Field(description="When the last interval ended [s]")
    position_steps: int = Field(description="Where [steps]")


class RetargetAnswer(Answer):
    """The steps that are played, one value a step in each list, or the steps that max_points leaves, and all turns."""

    timer_hz: float = Field(description="Ticks a second [Hz]")
    at_ticks: WholeNumbers = Field(description="Instant of the pulse [ticks]")
    interval_ticks: WholeNumbers = Field(description="From the pulse to the next one, or to rest [ticks]")
    position_steps: WholeNumbers = Field(description="Position after the pulse [steps]")
    direction: WholeNumbers = Field(description="1 forwards, -1 backwards")
    rests: list[RestAnswer]
    told_position_steps: WholeNumbers = Field(description="Where the motor was at the instant of each command [steps]")

    @classmethod
    def of(cls, played: PlayedSteps, timer_hz: float, most_points: int | None) -> Self:
        """Return what was played as an answer."""
        shown = slice(None) if most_points is None else played.kept(most_points)
        rests = zip((played.rest_at_ticks / timer_hz).tolist(), played.rest_position_steps.tolist(), strict=True)
        return cls(
            timer_hz=timer_hz,
            at_ticks=played.at_ticks[shown],
            interval_ticks=played.interval_ticks[shown],
            position_steps=played.position_steps[shown],
            direction=played.direction[shown],
            rests=[RestAnswer(at_s=at_s, position_steps=position) for at_s, position in rests],
            told_position_steps=played.told_position_steps,
        )
