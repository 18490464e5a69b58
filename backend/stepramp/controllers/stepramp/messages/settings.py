"""Reading and using settings."""

from dataclasses import dataclass

from stepramp.controllers.stepramp.messages.body import Reply, Request

SETTINGS_BYTES = 12
"""Of a controller without inputs; one with inputs has more, and these first."""
MOST_SETTINGS_BYTES = 51


@dataclass(frozen=True)
class ReadSettingsRequest(Request):
    """Ask for the settings in use."""

    KIND = 0x17


@dataclass(frozen=True)
class SettingsReply(Reply):
    """The settings in use, packed."""

    TAIL = range(SETTINGS_BYTES, MOST_SETTINGS_BYTES + 1)
    settings: bytes


@dataclass(frozen=True)
class WriteSettingsRequest(Request):
    """Use other settings from now on, without storing them: all of them, or the first ones only."""

    KIND = 0x18
    TAIL = range(SETTINGS_BYTES, MOST_SETTINGS_BYTES + 1)
    settings: bytes


@dataclass(frozen=True)
class ReadLimitsRequest(Request):
    """Ask for an axis' soft limits."""

    KIND = 0x19
    LAYOUT = "<B"
    axis: int


@dataclass(frozen=True)
class LimitsReply(Reply):
    """An axis' lowest and highest position [steps]; where positions end, there is no limit."""

    LAYOUT = "<ii"
    lowest_steps: int
    highest_steps: int


@dataclass(frozen=True)
class WriteLimitsRequest(Request):
    """Use other soft limits of an axis from now on, without storing them."""

    KIND = 0x1A
    LAYOUT = "<Bii"
    axis: int
    lowest_steps: int
    highest_steps: int
