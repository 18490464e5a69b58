"""What several ask for at the same time, and is done once for all of them."""

import threading
from collections.abc import Callable
from concurrent.futures import Future


class SharedAttempt:
    """A job that takes long: whoever asks for it while it is being done gets what comes of that. For any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._present: dict[str, Future[None]] = {}

    def __call__(self, what: str, job: Callable[[], None]) -> None:
        """Do it, or wait until that is done which is being done; raise what it raised. what: tells jobs apart."""
        with self._lock:
            is_mine = what not in self._present
            present = self._present.setdefault(what, Future())
        if is_mine:
            self._do(what, job, present)
        present.result()

    def _do(self, what: str, job: Callable[[], None], present: "Future[None]") -> None:
        error: BaseException | None = None
        try:
            job()
        except BaseException as raised:
            error = raised
        with self._lock:
            del self._present[what]
        present.set_exception(error) if error is not None else present.set_result(None)
