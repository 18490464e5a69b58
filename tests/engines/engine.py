"""What every browser can be told, whichever way it is spoken to."""

import shutil
from typing import Any, Protocol


class Engine(Protocol):
    """A browser with one window. What is pressed in it is pressed as by hand, not by its own scripts."""

    def open(self, url: str) -> None:
        """Load a page; what it reports from now on is kept for `errors`."""

    def call(self, function: str, *arguments: object) -> Any:
        """Call a JavaScript function in the page and return what it returns, as JSON knows it."""

    def perform(self, device: dict[str, Any]) -> None:
        """Press and move the keys or the pointer, as WebDriver describes their actions."""

    def errors(self) -> list[str]:
        """Return the errors that the page has reported since it was opened."""


def missing(*programs: str) -> list[str]:
    """Return those programs that are not installed."""
    return [program for program in programs if shutil.which(program) is None]
