"""What is known of a device as it goes on, and what the log tells of it."""

import logging
import threading
from collections.abc import Callable

from stepramp.devices.view import DeviceView

_logger = logging.getLogger(__name__)


class LiveView:
    """The view of a device as it is now. For any thread; changed: called from any thread after each change."""

    def __init__(self, view: DeviceView, changed: Callable[[], None]) -> None:
        self._view = view
        self._changed = changed
        self._lock = threading.Lock()

    @property
    def now(self) -> DeviceView:
        """The device as it is now."""
        with self._lock:
            return self._view

    def change(self, change: Callable[[DeviceView], DeviceView]) -> None:
        """Put a changed view in place of the present one: at once, since several threads change it."""
        with self._lock:
            before = self._view
            self._view = change(before)
            changed = self._view != before
        if changed:
            self._changed()

    def log(self, words: str, *values: object) -> None:
        """Tell in the log of something that has happened to it."""
        now = self.now
        _logger.info(f"Device %s at %s: {words}", now.id, now.port, *values)
