"""In which form an answer with columns is sent: as JSON, or its columns only, as CSV or as a file of numpy's."""

import csv
import io
import zipfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any

import mimeparse
import numpy as np
from fastapi import Depends, Request

from stepramp.errors import NotAcceptable, Rejection
from stepramp.http_api.columns import Table
from stepramp.http_api.error_items import ErrorList
from stepramp.http_api.json_response import PIECE_BYTES, json_pieces

JSON, CSV, NPZ = "application/json", "text/csv", "application/x-npz"
OFFERED = (NPZ, CSV, JSON)
"""The last of them is sent to who takes any."""
QUICKLY = 1
"""How hard long answers are compressed: a network is quicker than what would save a few bytes more."""
ROWS = 2048
"""So many rows of a table are written at a time, while which no other thread goes on for long."""


@dataclass(frozen=True)
class Format:
    """A form in which answers are sent."""

    media_type: str
    pieces: Callable[[Any], Iterator[bytes]]
    """What writes an answer, bit by bit, none of them empty; CSV and npz take what has `tables`."""
    is_packed: bool = False
    """Whether it is compressed already."""


async def wanted_format(request: Request) -> Format:
    """Return the form that a request's Accept likes best. Raises NotAcceptable where it takes none of them.

    A coroutine, since FastAPI has a thread do what is none.
    """
    accept = ", ".join(request.headers.getlist("accept")) or "*/*"
    media_type = _best_of_offered(accept.lower())
    if not media_type:
        raise NotAcceptable([Rejection("Accept", accept, f"one of {', '.join(reversed(OFFERED))}, or */*")])
    return FORMATS[media_type]


@lru_cache(maxsize=64)
def _best_of_offered(accept: str) -> str:
    """Return which media type a client likes best; an empty text where it takes none. Most send the same Accept."""
    try:
        best: str = mimeparse.best_match(OFFERED, accept)
    except mimeparse.MimeTypeParseException:
        return ""
    return best


def csv_pieces(tables: Iterable[Table]) -> Iterator[bytes]:
    """Yield tables that have the same columns as CSV, with a first column `name` where they are named."""
    for number, table in enumerate(tables):
        named = [table.name] if table.name else []
        if number == 0:
            yield _lines([[*(["name"] if named else []), *table.columns]])
        arrays = list(table.columns.values())
        for begin in range(0, arrays[0].size, ROWS):
            # Python's own numbers: they are written with as many digits as tell them apart.
            rows = zip(*(each[begin : begin + ROWS].tolist() for each in arrays), strict=True)
            yield _lines([*named, *row] for row in rows)


def npz_pieces(tables: Iterable[Table]) -> Iterator[bytes]:
    """Yield tables as numpy.load reads them: an array a column, `name/column` where tables are named."""
    sink = _Sink()
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_DEFLATED, compresslevel=QUICKLY) as archive:
        for table in tables:
            for column, values in table.columns.items():
                name = f"{table.name}/{column}" if table.name else column
                with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                    header = np.lib.format.header_data_from_array_1_0(np.ascontiguousarray(values))
                    np.lib.format.write_array_header_1_0(file, header)
                    for begin in range(0, values.size, PIECE_BYTES // 8):
                        file.write(np.ascontiguousarray(values[begin : begin + PIECE_BYTES // 8]).tobytes())
                        yield from sink.taken()
    yield from sink.taken()


def _lines(rows: Iterable[Iterable[object]]) -> bytes:
    text = io.StringIO()
    csv.writer(text).writerows(rows)
    return text.getvalue().encode()


class _Sink(io.RawIOBase):
    """What is written into it is taken out of it bit by bit; a file that can't be gone back in."""

    def __init__(self) -> None:
        self._bits: list[bytes] = []

    def writable(self) -> bool:
        return True

    def write(self, bit: Any) -> int:
        self._bits.append(bytes(bit))
        return len(bit)

    def taken(self) -> Iterator[bytes]:
        if taken := b"".join(self._bits):
            yield taken
        self._bits = []


FORMATS = {
    JSON: Format(JSON, json_pieces),
    CSV: Format("text/csv; charset=utf-8", lambda answer: csv_pieces(answer.tables)),
    NPZ: Format(NPZ, lambda answer: npz_pieces(answer.tables), is_packed=True),
}

AnyFormat = Annotated[Format, Depends(wanted_format)]
IN_ANY_FORMAT: dict[int | str, dict[str, Any]] = {
    406: {"model": ErrorList, "description": "Accept takes none of the forms that there are"},
    200: {
        "content": {
            CSV: {"schema": {"type": "string", "description": "The columns, with their names in the first line"}},
            NPZ: {"schema": {"type": "string", "format": "binary", "description": "The columns, for numpy.load"}},
        }
    },
}
"""What a route that sends any of them answers, beside JSON."""
