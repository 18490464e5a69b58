"""Files that commands read and write; `-` stands for standard input and output."""

import json
import os
import shutil
import sys
from pathlib import Path
from typing import Annotated

import typer

from stepramp.client.design_calls import MOST_FILE_BYTES
from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.json_text import MOST_VALUES, parsed_json

MOST_BYTES = 2_000_000
"""Size of the largest file with a design, as of the largest body with one [bytes]."""
DesignFile = Annotated[str, typer.Argument(metavar="DESIGN", help="file with a design document, - for standard input")]
DesignFiles = Annotated[
    list[str], typer.Argument(metavar="DESIGN...", help="files with a design document each, - for standard input")
]


def design_of(source: str, field: str = "DESIGN") -> Design:
    """Return the design of a file. Raises Rejected when it can't be read, or is none."""
    document = document_of(source, field, "a file with a design document")
    return Design.checked(document)


def designs_of(sources: list[str]) -> list[Design]:
    """Return the designs of files; what is refused of one names its file."""
    if sources.count("-") > 1:
        raise Rejected([Rejection("DESIGN", "-", "standard input once only, files besides")])
    designs = []
    for source in sources:
        try:
            designs.append(design_of(source))
        except Rejected as error:
            if len(sources) == 1:
                raise
            raise Rejected([each.within(f"{source}: ") for each in error.rejections], error.more) from None
    return designs


def document_of(
    source: str, field: str, allowed: str, most_bytes: int | None = None, most_values: int = MOST_VALUES
) -> object:
    """Return the JSON of a file. Raises Rejected, with what is allowed, when it can't be read."""
    try:
        return parsed_json(text_of(source, most_bytes), most_values)
    except (OSError, ValueError) as error:
        if isinstance(error, Rejected):
            raise
        raise Rejected([Rejection(field, source, f"{allowed} ({why(error)})")]) from None


def text_of(source: str, most_bytes: int | None = None) -> str:
    """Return the text of a file that may be a design; ValueError when it is none, or larger than any."""
    most_bytes = most_bytes or MOST_BYTES
    with sys.stdin.buffer if source == "-" else Path(source).open("rb") as file:
        content = file.read(most_bytes + 1)
    if len(content) > most_bytes:
        raise ValueError(f"it is larger than {most_bytes:,} bytes")
    return content.decode(json.detect_encoding(content))


def bytes_of(source: str, field: str, most_bytes: int | None = None) -> bytes:
    """Return the content of a file of any kind. Raises Rejected when it can't be read, or is larger than any taken."""
    most_bytes = most_bytes or MOST_FILE_BYTES
    try:
        with sys.stdin.buffer if source == "-" else Path(source).open("rb") as file:
            content = file.read(most_bytes + 1)
    except OSError as error:
        raise Rejected([Rejection(field, source, f"a file that can be read ({why(error)})")]) from None
    if len(content) > most_bytes:
        raise Rejected([Rejection(field, source, f"a file of up to {most_bytes:,} bytes")])
    return content


def refuse_same(source: str, target: str) -> None:
    """Refuse to overwrite the file that something was made of."""
    if "-" not in (source, target) and Path(target).exists() and Path(source).samefile(target):
        raise Rejected([Rejection("FILE", target, "another file than that of the design")])


def write(target: str, content: bytes, field: str = "FILE") -> None:
    """Write a file. Raises Rejected when it can't be written: what was there before stays then."""
    try:
        if target == "-":
            sys.stdout.buffer.write(content)
            sys.stdout.buffer.flush()
        elif Path(target).exists() and not Path(target).is_file():
            Path(target).write_bytes(content)  # A device, or what another program reads from.
        else:
            _write_whole(Path(target).resolve(), content)
    except BrokenPipeError:
        raise
    except OSError as error:
        raise Rejected([Rejection(field, target, f"a file that can be written ({why(error)})")]) from None


def _write_whole(file: Path, content: bytes) -> None:
    """Have a file there whole, or as it was before; raises OSError when it can't be written."""
    part = file.with_name(f".{file.name[:200]}.{os.getpid()}.part")
    try:
        opened = part.open("xb")
    except PermissionError:
        file.write_bytes(content)  # In a folder of others, the file itself may be one's own.
        return
    try:
        with opened:
            opened.write(content)
        if file.exists():
            shutil.copymode(file, part)
        part.replace(file)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def why(error: OSError | ValueError) -> str:
    """Return why a file can't be read or written, in words without the program's own."""
    if isinstance(error, UnicodeDecodeError):
        return "it is no text in UTF-8 or UTF-16"
    if isinstance(error, json.JSONDecodeError):
        return f"it is no JSON: line {error.lineno:,}, column {error.colno:,}" if error.doc.strip() else "it is empty"
    return (error.strerror if isinstance(error, OSError) else None) or str(error)
