"""How far a push has come."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum


class PushStage(StrEnum):
    """What a push does at a moment, in this order."""

    PLANNING = "planning"
    SENDING = "sending"
    CHECKING = "checking"
    STORING = "storing"
    READING_BACK = "reading_back"


@dataclass(frozen=True)
class Progress:
    """How far a stage of a push has come [bytes]."""

    stage: PushStage
    bytes_done: int
    bytes_total: int


Tell = Callable[[Progress], None]
