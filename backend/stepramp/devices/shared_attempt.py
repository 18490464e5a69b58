"""What several ask for at the same time, and is done once for all of them."""

import threading
from collections.abc import Callable
from concurrent.futures import Future


class SharedAttempt:
    """A job that takes long: whoever asks for it while it is being done gets what comes of that. For any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._present: Future[None] | None = None

    def __call__(self, job: Callable[[], None]) -> None:
        """Do it, or wait until it is done that is being done; raise what it raised."""
        with self._lock:
            is_mine = self._present is None
            present = self._present = self._present or Future()
        if is_mine:
            self._do(job, present)
        present.result()

    def _do(self, job: Callable[[], None], present: "Future[None]") -> None:
        error: BaseException | None = None
        try:
            job()
        except BaseException as raised:
            error = raised
        with self._lock:
            self._present = None
        present.set_exception(error) if error is not None else present.set_result(None)
