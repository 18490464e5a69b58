"""Connecting devices again that were lost, once they are back. Nothing moves by that."""

import logging
import threading
from collections.abc import Callable, Sequence
from time import monotonic

from stepramp.devices.device import Device
from stepramp.errors import StepRampError

LOOK_S = 1.0
"""How often what was lost is looked for [s]."""
LONGEST_PAUSE_S = 30.0
"""After attempts that fail, each pause is twice the one before, up to this [s]."""

_logger = logging.getLogger(__name__)


class Returning:
    """Looks for lost devices in a thread of its own, from when it begins until it ends."""

    def __init__(self, lost: Callable[[], Sequence[Device]]) -> None:
        self._lost = lost
        self._ended = threading.Event()
        self._pauses: dict[Device, tuple[float, float]] = {}
        """Of each lost device: when to try next, by the monotonic clock, and the pause after that [s]."""

    def begin(self) -> None:
        """Look for them from now on."""
        threading.Thread(target=self._run, name="returning devices", daemon=True).start()

    def end(self) -> None:
        """Look no more."""
        self._ended.set()

    def _run(self) -> None:
        while not self._ended.wait(LOOK_S):
            lost = self._lost()
            self._pauses = {device: pause for device, pause in self._pauses.items() if device in lost}
            for device in lost:
                self._look_for(device)

    def _look_for(self, device: Device) -> None:
        due_s, pause_s = self._pauses.setdefault(device, (monotonic() + LOOK_S, LOOK_S))
        if monotonic() < due_s or self._ended.is_set():
            return
        try:
            if not device.reconnect():
                return
        except StepRampError:
            pass  # It isn't answering yet, or isn't what it was: another attempt may follow.
        except Exception:
            # The others, and this one later, are to be found all the same.
            _logger.exception("Device %s could not be looked for.", device.view.id)
        longer_s = min(LONGEST_PAUSE_S, 2 * pause_s)
        self._pauses[device] = (monotonic() + longer_s, longer_s)
