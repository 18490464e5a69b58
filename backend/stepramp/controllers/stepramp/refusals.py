"""What a controller's refusals mean to people."""

from collections.abc import Callable, Sequence

from stepramp.controllers.axes import refusal_of_moving
from stepramp.controllers.inputs import InTheWay, StopCause, at_limit_words, at_soft_limit_words, stopped_words
from stepramp.controllers.stepramp.input_roles import INPUTS, InputRole
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.session import PROTOCOL_VERSION
from stepramp.controllers.stepramp.soft_limits import AT_HIGHEST, AT_LOWEST, SoftLimit
from stepramp.errors import Refused, Rejected, Rejection, StepRampError

WORDS = {
    ReplyStatus.NO_RAMP: "The controller has no ramp yet: push a design first.",
    ReplyStatus.WRITING: "The controller is storing a ramp: try again in a few seconds.",
    ReplyStatus.BAD_CRC: "The ramp arrived damaged; the controller keeps the one it had.",
    ReplyStatus.BAD_VERSION: (
        f"The controller speaks version {{detail}} of the protocol, this program version {PROTOCOL_VERSION}: "
        "update the older of the two."
    ),
    ReplyStatus.TOO_FAST: "The axes are too fast together: they would take {detail} % of the controller's time.",
}
OF_VALUES = (ReplyStatus.OUT_OF_RANGE, ReplyStatus.TOO_FAST)


def exception_for(
    refusal: Refusal,
    rejected: Callable[[Refusal], Rejection] | None,
    roles: Sequence[InputRole] = (),
    soft_limits: Sequence[SoftLimit] = (),
    stopped_by: Callable[[], tuple[StopCause, ...]] = tuple,
    moving_axis: Callable[[], int | None] = lambda: None,
) -> StepRampError:
    """Return a refusal as the exception that says so; see Conversation.ask.

    roles: what the inputs are for. soft_limits: those that the controller keeps. stopped_by: asks what has stopped it.
    moving_axis: tells one that moves, as last heard.
    """
    if refusal.status is ReplyStatus.STOPPED:
        return InTheWay(_stopped(refusal, roles, stopped_by))
    if refusal.status is ReplyStatus.AT_LIMIT:
        return _at_limit(refusal, roles, soft_limits)
    if refusal.status is ReplyStatus.MOVING:
        return refusal_of_moving(moving_axis())
    if refusal.status in OF_VALUES and rejected is not None:
        return Rejected([rejected(refusal)])
    if refusal.status is ReplyStatus.BAD_RAMP:
        ramp, segment = divmod(refusal.detail, 256)
        where = "the ramps' header" if ramp == 255 else f"the header of ramp {ramp}"
        where = where if segment == 255 else f"segment {segment} of ramp {ramp}"
        return Refused(f"The controller refuses {where}; it keeps the ramps it had.")
    unexpected = f"The controller refuses: {refusal.status.name.lower()} ({{detail}})."
    return Refused(WORDS.get(refusal.status, unexpected).format(detail=refusal.detail))


def _stopped(refusal: Refusal, roles: Sequence[InputRole], stopped_by: Callable[[], tuple[StopCause, ...]]) -> str:
    active = [role.status(is_active=True) for role in roles if refusal.detail >> INPUTS.index(role.input) & 1]
    stops = [each for each in active if each.role != "limit"]
    return stopped_words(stops, () if stops else stopped_by())


def _at_limit(refusal: Refusal, roles: Sequence[InputRole], soft_limits: Sequence[SoftLimit]) -> InTheWay:
    number, axis = divmod(refusal.detail, 256)
    if number in (AT_LOWEST, AT_HIGHEST):
        return InTheWay(_at_soft_limit(refusal, soft_limits), "axis", axis, "within its soft limits")
    name = INPUTS[number] if number < len(INPUTS) else None
    end = next((role.end for role in roles if role.input == name), None)
    allowed = "an axis that is on no limit switch that way" if end is None else f"away from its {end} end"
    return InTheWay(at_limit_words(axis, name, end), "axis", axis, allowed)


def _at_soft_limit(refusal: Refusal, soft_limits: Sequence[SoftLimit]) -> str:
    end, axis = divmod(refusal.detail, 256)
    limit = next((each for each in soft_limits if each.axis == axis), SoftLimit(axis=axis))
    at_steps = limit.lowest_steps if end == AT_LOWEST else limit.highest_steps
    return at_soft_limit_words(axis, "low" if end == AT_LOWEST else "high", at_steps)
