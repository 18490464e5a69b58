"""News of the devices: what has changed, written once for all who listen."""

import asyncio
import logging
from collections.abc import AsyncGenerator
from contextlib import suppress

from stepramp.devices.registry import Devices
from stepramp.http_api.devices_models import DevicesAnswer

_logger = logging.getLogger(__name__)

PAUSE_S = 1 / 50
"""Between two editions at least."""
BEAT_S = 1.0
"""An edition is published so often at least [s], so that who listens knows that nothing has changed."""
MOST_MESSAGES_A_SECOND = 2000
"""To all listeners together: more than forty of them get fewer editions, so that there is time for all else."""


class News:
    """The state of all devices, as ever new editions of a text. It lives in one event loop."""

    def __init__(self, devices: Devices, beat_s: float = BEAT_S) -> None:
        self._devices = devices
        self._beat_s = beat_s
        self._loop = asyncio.get_running_loop()
        self._changed = asyncio.Event()
        self._edition, self._number = "", 0
        self._published = self._loop.create_future()
        self._listeners = 0

    async def publish(self) -> None:
        """Publish an edition after each change, and now and then without one, until cancelled."""
        with self._devices.listening(self._wake):
            while True:
                with suppress(TimeoutError):
                    await asyncio.wait_for(self._changed.wait(), self._beat_s)
                self._changed.clear()
                if self._listeners:
                    self._publish_one()
                await asyncio.sleep(max(PAUSE_S, self._listeners / MOST_MESSAGES_A_SECOND))

    async def editions(self) -> AsyncGenerator[str, None]:
        """Yield the devices as they are now, and then each edition; who takes long over one gets only the newest."""
        self._listeners += 1
        try:
            edition, number = self._written(), self._number
            while True:
                yield edition
                if number == self._number:
                    await asyncio.shield(self._published)
                edition, number = self._edition, self._number
        finally:
            self._listeners -= 1

    def _publish_one(self) -> None:
        try:
            self._edition, self._number = self._written(), self._number + 1
        except Exception:
            # Who listens hears nothing then, and knows that what it has is old. The next edition may do.
            _logger.exception("The devices' state could not be told.")
            return
        self._published.set_result(None)
        self._published = self._loop.create_future()

    def _wake(self) -> None:
        """Note a change, in whatever thread."""
        with suppress(RuntimeError):  # The server ended in this very moment; nobody listens any more.
            self._loop.call_soon_threadsafe(self._changed.set)

    def _written(self) -> str:
        return DevicesAnswer.model_validate({"devices": self._devices.views()}).model_dump_json()
