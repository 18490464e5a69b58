"""What the routes over backups answer."""

from typing import Annotated

from pydantic import Field

from stepramp.http_api.answer import Answer
from stepramp.http_api.devices_models import DeviceAnswer
from stepramp.validation import Document, Text

UNREADABLE = "Which folders of them can't be listed, and why, as sentences"


class BackupAnswer(Answer):
    """A backup of a device."""

    name: str = Field(description="When it was saved, in UTC; what the routes call it")
    bytes: int = Field(description="Length of its text [bytes]")


class BackupsAnswer(Answer):
    """The backups of a device."""

    backups: list[BackupAnswer] = Field(description="The newest first; also those of earlier connections")
    unreadable: list[str] = Field(description=UNREADABLE)


class SourceAnswer(Answer):
    """What backups are of."""

    name: str = Field(description="What the routes call it")
    family: str = Field(description="The family of the controller")
    plugged_in: str = Field(description="The port, or the USB numbers, of what was plugged in: letters and digits")
    backups: list[BackupAnswer] = Field(description="The newest first")


class ArchiveAnswer(Answer):
    """All backups that there are, of devices that are connected or not."""

    sources: list[SourceAnswer] = Field(description="That with the newest backup first")
    unreadable: list[str] = Field(description=UNREADABLE)


class RestorePayload(Document):
    """Which of all backups is to be written."""

    source: Annotated[str, Text(200)] = Field(description="What it is of, as `/backups` names it: of the same family")
    name: Annotated[str, Text(200)] = Field(description="The backup's own name")


class RestoredAnswer(Answer):
    """What came of a restore."""

    device: DeviceAnswer
    remarks: list[str] = Field(description="What couldn't be written, or isn't proven, as sentences")
