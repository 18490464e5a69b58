"""What a Tic's error conditions mean to people."""

from collections.abc import Mapping

from stepramp.controllers.tic.variables import Condition

WORDS = {
    Condition.DEENERGIZED: "its motor was switched off on purpose (de-energized)",
    Condition.MOTOR_DRIVER: "its motor driver reports a fault, such as too much current or heat (motor driver error)",
    Condition.LOW_VIN: "the supply of its motor is off or too low (low VIN)",
    Condition.KILL_SWITCH: "its kill switch is active",
    Condition.INPUT_INVALID: "its input gives no valid signal (required input invalid)",
    Condition.SERIAL: "bytes on its serial line were damaged or lost (serial error)",
    Condition.COMMAND_TIMEOUT: "it heard no command for longer than its command timeout",
    Condition.SAFE_START: "it stays in safe start",
    Condition.ERR_LINE: "its ERR line is high, so another device that is wired to it reports an error",
}
PAST_WORDS = WORDS | {
    Condition.MOTOR_DRIVER: "its motor driver reported a fault, such as too much current or heat (motor driver error)",
    Condition.LOW_VIN: "the supply of its motor was off or too low (low VIN)",
    Condition.KILL_SWITCH: "its kill switch was active",
    Condition.INPUT_INVALID: "its input gave no valid signal (required input invalid)",
    Condition.SAFE_START: "it went into safe start",
    Condition.ERR_LINE: "its ERR line was high, since another device that is wired to it reported an error",
}
BY_ITSELF = (
    Condition.MOTOR_DRIVER | Condition.LOW_VIN | Condition.KILL_SWITCH | Condition.INPUT_INVALID | Condition.ERR_LINE
)
"""Conditions that last until something is mended at the machine: no command ends them."""
LETTING_GO = Condition.DEENERGIZED | Condition.MOTOR_DRIVER | Condition.LOW_VIN
"""Conditions in which the motor has no current."""
CONSEQUENCES = Condition.COMMAND_TIMEOUT | Condition.SAFE_START
"""Conditions that come with any other: alone they say why, beside others they say nothing."""


def told(conditions: Condition) -> str:
    """Return what keeps a Tic from moving, as part of a sentence."""
    return _joined(conditions, WORDS)


def told_afterwards(conditions: Condition, *, stopped: bool, let_go: bool) -> str:
    """Return what came of conditions that may be over by now.

    stopped: they ended a motion. let_go: the motor had no current.
    """
    begun = "The Tic has stopped by itself" if stopped else "The motor of the Tic has been without current"
    sentence = f"{begun}: {_joined(conditions, PAST_WORDS) or 'its driver was started anew'}."
    return sentence + " It may be elsewhere than it counts." if let_go else sentence


def _joined(conditions: Condition, words: Mapping[Condition, str]) -> str:
    causes = conditions & ~CONSEQUENCES or conditions
    return ", and ".join(each for condition, each in words.items() if condition in causes)
