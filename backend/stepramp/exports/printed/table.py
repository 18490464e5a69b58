"""Tables of texts, as reports have them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Table:
    """Rows of texts under a head, which names each column."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
