"""Reading and using settings."""

from dataclasses import dataclass

from stepramp.controllers.stepramp.messages.body import Reply, Request

SETTINGS_BYTES = 12


@dataclass(frozen=True)
class ReadSettingsRequest(Request):
    """Ask for the settings in use."""

    KIND = 0x17


@dataclass(frozen=True)
class SettingsReply(Reply):
    """The settings in use, packed."""

    LAYOUT = f"<{SETTINGS_BYTES}s"
    settings: bytes


@dataclass(frozen=True)
class WriteSettingsRequest(Request):
    """Use other settings from now on, without storing them."""

    KIND = 0x18
    LAYOUT = f"<{SETTINGS_BYTES}s"
    settings: bytes
