"""What a controller's refusals mean to people."""

from collections.abc import Callable, Sequence

from stepramp.controllers.inputs import at_limit_words, at_soft_limit_words, stopped_words
from stepramp.controllers.stepramp.input_roles import INPUTS, InputRole
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.session import PROTOCOL_VERSION
from stepramp.controllers.stepramp.soft_limits import AT_HIGHEST, AT_LOWEST, SoftLimit
from stepramp.errors import Refused, Rejected, Rejection, StepRampError

WORDS = {
    ReplyStatus.MOVING: "The motor moves: stop it first.",
    ReplyStatus.NO_RAMP: "The controller has no ramp yet: push a design first.",
    ReplyStatus.WRITING: "The controller is storing a ramp: try again in a few seconds.",
    ReplyStatus.BAD_CRC: "The ramp arrived damaged; the controller keeps the one it had.",
    ReplyStatus.BAD_VERSION: (
        f"The controller speaks version {{detail}} of the protocol, this program version {PROTOCOL_VERSION}: "
        "update the older of the two."
    ),
    ReplyStatus.TOO_FAST: "The axes are too fast together: they would take {detail} % of the controller's time.",
}
OF_INPUTS = (ReplyStatus.STOPPED, ReplyStatus.AT_LIMIT)
OF_VALUES = (ReplyStatus.OUT_OF_RANGE, ReplyStatus.TOO_FAST)


def exception_for(
    refusal: Refusal,
    rejected: Callable[[Refusal], Rejection] | None,
    roles: Sequence[InputRole] = (),
    soft_limits: Sequence[SoftLimit] = (),
) -> StepRampError:
    """Return a refusal as the exception that says so; see Conversation.ask.

    roles: what the inputs are for. soft_limits: those that the controller keeps.
    """
    if refusal.status is ReplyStatus.AT_LIMIT and refusal.detail >> 8 in (AT_LOWEST, AT_HIGHEST):
        return Refused(_at_soft_limit(refusal, soft_limits))
    if refusal.status in OF_INPUTS:
        return Refused(_of_inputs(refusal, roles))
    if refusal.status in OF_VALUES and rejected is not None:
        return Rejected([rejected(refusal)])
    if refusal.status is ReplyStatus.BAD_RAMP:
        ramp, segment = divmod(refusal.detail, 256)
        where = "the ramps' header" if ramp == 255 else f"the header of ramp {ramp}"
        where = where if segment == 255 else f"segment {segment} of ramp {ramp}"
        return Refused(f"The controller refuses {where}; it keeps the ramps it had.")
    unexpected = f"The controller refuses: {refusal.status.name.lower()} ({{detail}})."
    return Refused(WORDS.get(refusal.status, unexpected).format(detail=refusal.detail))


def _of_inputs(refusal: Refusal, roles: Sequence[InputRole]) -> str:
    if refusal.status is ReplyStatus.STOPPED:
        active = [role.status(is_active=True) for role in roles if refusal.detail >> INPUTS.index(role.input) & 1]
        return stopped_words([each for each in active if each.role != "limit"])
    number, axis = divmod(refusal.detail, 256)
    name = INPUTS[number] if number < len(INPUTS) else None
    return at_limit_words(axis, name, next((role.end for role in roles if role.input == name), None))


def _at_soft_limit(refusal: Refusal, soft_limits: Sequence[SoftLimit]) -> str:
    end, axis = divmod(refusal.detail, 256)
    limit = next((each for each in soft_limits if each.axis == axis), SoftLimit(axis=axis))
    at_steps = limit.lowest_steps if end == AT_LOWEST else limit.highest_steps
    return at_soft_limit_words(axis, "low" if end == AT_LOWEST else "high", at_steps)
