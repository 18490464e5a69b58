"""Keeps what was pushed in the library, in a thread of its own: no push waits for a database, or fails by it."""

import logging
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial

from stepramp.design import Design
from stepramp.devices.device import Device
from stepramp.errors import Rejected, Unavailable
from stepramp.http_api.devices_models import PushedAnswer
from stepramp.library.database import NeverKept
from stepramp.library.history import Device as SeenDevice
from stepramp.library.history import History, Push
from stepramp.link.protocol_sim import VIRTUAL_PORT

MOST_WAITING = 1000
"""So many entries wait for a library that can't be used; then the oldest one is lost."""
SETTLED_S = 10.0
ENDING_S = 1.0
"""So long the server's end waits for pushes that fail by it: all of it takes no longer than 4 s."""

_logger = logging.getLogger(__name__)


class Pushing:
    """A push that goes on; report: what comes of it, once it has."""

    report: PushedAnswer | None = None


class HistoryKeeper:
    """Notes devices and pushes, one after the other. What can't be written waits for the next one. From any thread."""

    def __init__(self, history: History) -> None:
        self._history = history
        self._waiting: deque[Callable[[], object]] = deque(maxlen=MOST_WAITING)
        self._pool = ThreadPoolExecutor(1, "history")
        self._going_on = 0
        self._one_ended = threading.Condition()

    def note_device(self, device: Device) -> None:
        """Have it noted that a device is there, unless it is the virtual one."""
        if not _is_virtual(device):
            self._later(partial(self._history.note_device, _seen(device)))

    @contextmanager
    def noting(
        self, device: Device, designs: Sequence[Design], first_axis: int | None, mode: str, client: str | None
    ) -> Iterator[Pushing]:
        """Have a push noted as it ends, also by an exception, unless its designs were rejected."""
        with self._counted():
            pushing, trouble = Pushing(), None
            try:
                yield pushing
            except Rejected:
                raise
            except Exception as error:
                trouble = str(error)
                raise
            finally:
                if not _is_virtual(device) and (trouble is not None or pushing.report is not None):
                    push = Push(
                        _seen(device),
                        dict(enumerate(designs, start=first_axis or 0)),
                        mode,
                        client,
                        None if pushing.report is None else pushing.report.model_dump(mode="json"),
                        trouble,
                        device.view.backup,
                    )
                    self._later(partial(self._history.note_push, push))

    def settled(self) -> History:
        """Return the history once what was noted is written, or can't be."""
        writing = self._pool.submit(self._write)
        with suppress(TimeoutError):
            writing.result(SETTLED_S)
        writing.cancel()
        return self._history

    def close(self) -> None:
        """Write what still waits, also of pushes that fail by the end of their devices, if that can be done."""
        with self._one_ended:
            self._one_ended.wait_for(lambda: self._going_on == 0, ENDING_S)
        self._pool.submit(self._write)
        self._pool.shutdown()
        if self._waiting:
            _logger.error("The server ends; lost are %d entries of the history of pushes.", len(self._waiting))

    @contextmanager
    def _counted(self) -> Iterator[None]:
        """Count a push until it is noted."""
        with self._one_ended:
            self._going_on += 1
        try:
            yield
        finally:
            with self._one_ended:
                self._going_on -= 1
                self._one_ended.notify_all()

    def _later(self, entry: Callable[[], object]) -> None:
        try:
            self._pool.submit(self._write, entry)
        except RuntimeError:
            _logger.error("The server has ended; an entry of the history of pushes that came since is lost.")

    def _write(self, *entries: Callable[[], object]) -> None:
        self._waiting.extend(entries)
        while self._waiting and self._is_settled(self._waiting[0]):
            self._waiting.popleft()

    def _is_settled(self, entry: Callable[[], object]) -> bool:
        """Write an entry; return whether it needn't wait: it is written, or never can be."""
        try:
            entry()
        except Exception as error:
            if isinstance(error, Unavailable) and not isinstance(error, NeverKept):
                _logger.warning("The history of pushes waits for the library, %d so far. %s", len(self._waiting), error)
                return False
            _logger.exception("An entry of the history of pushes is lost.")
        return True


def _is_virtual(device: Device) -> bool:
    return device.view.port.startswith(VIRTUAL_PORT)


def _seen(device: Device) -> SeenDevice:
    view = device.view
    return SeenDevice(view.family, device.called, view.name, view.port)
