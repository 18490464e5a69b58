import os
import tty
from collections.abc import Iterator
from dataclasses import dataclass

import pytest


@dataclass
class Cable:
    """A pseudo-terminal: `port` is what the program opens, and `far_end` what is plugged in."""

    port: str
    far_end: int

    def unplug(self) -> None:
        if self.far_end >= 0:
            os.close(self.far_end)
            self.far_end = -1


@pytest.fixture
def cable() -> Iterator[Cable]:
    far_end, near_end = os.openpty()
    tty.setraw(near_end)
    cable = Cable(os.ttyname(near_end), far_end)
    os.close(near_end)
    yield cable
    cable.unplug()
