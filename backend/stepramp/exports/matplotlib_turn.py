"""Drawing with matplotlib: one thread at a time, with settings that give the same file for the same design."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from stepramp.design import MethodName
from stepramp.methods import METHODS

SETTINGS: Any = {
    "svg.hashsalt": "stepramp", "svg.fonttype": "path", "axes.grid": True, "grid.alpha": 0.3,
    # As fonts, so that a PDF's text can be searched and copied.
    "pdf.fonttype": 42,
}  # fmt: skip

_one_at_a_time = threading.Lock()
"""matplotlib's settings and fonts are shared by all threads."""


@contextmanager
def matplotlib_turn() -> Iterator[None]:
    """Draw in one's turn. matplotlib loads slowly, and only now."""
    import matplotlib as mpl  # noqa: PLC0415

    with _one_at_a_time, mpl.rc_context(SETTINGS):
        yield


def style_of(method: MethodName) -> dict[str, Any]:
    """Return what matplotlib draws a method's lines with: the page's colours, in its light theme."""
    style = METHODS[method].style
    dashes = {} if style.file_dash is None else {"dashes": style.file_dash}
    return {"color": style.light, "linewidth": style.file_width, **dashes}
