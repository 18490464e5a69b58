"""What a controller is spoken to over, whatever opened it."""

from typing import Protocol


class Connection(Protocol):
    """An open connection to one controller. Not for two threads at once."""

    name: str
    """Of its port."""

    def write(self, data: bytes) -> None:
        """Send bytes; DeviceLost when the port is gone."""

    def read(self, timeout_s: float) -> bytes:
        """Return what has come in, at once if there is something, or b"" when nothing came in time [s].

        Raises DeviceLost when the port is gone.
        """

    def pending(self) -> bytes:
        """Return what has come in by now, without waiting; DeviceLost when the port is gone."""

    def close(self) -> None:
        """Close the port; never raises, since it may be gone already."""
