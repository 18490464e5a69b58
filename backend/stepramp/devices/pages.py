"""The pages that are open."""

import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager


def page_of(name: str, holder: str | None) -> str:
    """Return what tells a page apart from all others, which is more than what it calls itself: others are told that.

    holder: who has opened it, in one line; None where nobody is told apart.
    """
    return name if holder is None else f"{name}\n{holder}"


def name_of(page: str) -> str:
    """Return what a page calls itself."""
    return page.rpartition("\n")[0] or page


class Pages:
    """Those that listen to the devices, each as often as it does. For any thread.

    gone: called with a page that listens no more.
    """

    def __init__(self, gone: Callable[[str], None]) -> None:
        self._gone = gone
        self._lock = threading.Lock()
        self._listening: Counter[str] = Counter()
        self._places: dict[str, str | None] = {}

    def is_there(self, page: str) -> bool:
        """Whether a page listens."""
        with self._lock:
            return self._listening[page] > 0

    def place_of(self, page: str) -> str | None:
        """Return where a page that listens is, if that is known."""
        with self._lock:
            return self._places.get(page)

    @contextmanager
    def present(self, page: str, place: str | None = None) -> Iterator[None]:
        """Note that a page is there and listens. place: where it is."""
        with self._lock:
            self._listening[page] += 1
            self._places[page] = place
        try:
            yield
        finally:
            with self._lock:
                self._listening[page] -= 1
                self._listening += Counter()  # Only those above zero stay.
                if page not in self._listening:
                    self._places.pop(page, None)
            if not self.is_there(page):
                self._gone(page)
