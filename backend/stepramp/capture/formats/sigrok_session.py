"""Sessions of sigrok and PulseView, `.sr`: sigrok-cli, where it is installed, turns them into VCD."""

import lzma
import re
import shutil
import struct
import subprocess
import tempfile
import threading
import zipfile
import zlib
from io import BytesIO
from pathlib import Path

from stepramp.capture.formats.vcd import read_vcd
from stepramp.capture.recording import Recording, refused_file
from stepramp.errors import Rejected

PROGRAM = "sigrok-cli"
MOST_UNPACKED_BYTES = 2**30
"""Size of all samples, unpacked: a file of zeros is packed to a thousandth."""
MOST_FILES = 100_000
MOST_VCD_BYTES = 2**29
LONGEST_S = 60.0
_PIECE_BYTES = 2**20
_BROKEN = (
    zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error, NotImplementedError, RuntimeError, EOFError, OSError,
    ValueError, OverflowError,
)  # fmt: skip
"""What reading a damaged zip file raises."""
_SAMPLES = re.compile(r"capturefile\s*=\s*(\S+)")


def read_sigrok_session(content: bytes) -> Recording:
    """Return what a session of sigrok has captured.

    Raises Rejected when sigrok-cli isn't installed, and for a file that is none, has lost some of its parts, or is
    larger than it seems.
    """
    _look_into(content)
    program = shutil.which(PROGRAM)
    if program is None:
        raise refused_file(
            "a session of sigrok (.sr), which takes sigrok-cli to read, and that isn't installed here",
            "the same exported as CSV or VCD, or as it is once sigrok-cli is installed",
        )
    with tempfile.TemporaryDirectory(prefix="stepramp-") as folder:
        source = Path(folder) / "capture.sr"
        source.write_bytes(content)
        return read_vcd(_as_vcd(program, source), "sigrok_session")


def _look_into(content: bytes) -> None:
    """Raise Rejected unless a session has all of its parts, and those are small enough."""
    whole = "a whole .sr file, as sigrok saved it"
    try:
        with zipfile.ZipFile(BytesIO(content)) as archive:
            parts = {each.filename: each.file_size for each in archive.infolist()}
            if "meta.json" in parts and "metadata" not in parts:
                allowed = "its digital data as CSV: in Logic 2, File, Export Data"
                raise refused_file("a capture of Saleae Logic 2 (.sal)", allowed)
            if len(parts) > MOST_FILES:
                raise refused_file(f"a .sr file of {len(parts):,} parts", f"up to {MOST_FILES:,}: capture less time")
            if sum(parts.values()) > MOST_UNPACKED_BYTES:
                size = f"a .sr file that has {sum(parts.values()):,} bytes when it is unpacked"
                raise refused_file(size, f"up to {MOST_UNPACKED_BYTES:,} bytes: capture less time, or more slowly")
            missing = [each for each in ("version", "metadata") if each not in parts]
            if missing:
                raise refused_file(
                    f"a zip file without {missing[0]!r}, which .sr files have in them",
                    f"{whole}, or what else is packed so, unpacked",
                )
            if parts["metadata"] > _PIECE_BYTES:
                raise refused_file(
                    f"a .sr file whose metadata has {parts['metadata']:,} bytes", f"up to {_PIECE_BYTES:,} bytes"
                )
            metadata = archive.read("metadata").decode("utf-8", "replace")
    except Rejected:
        raise
    except _BROKEN as error:
        raise refused_file(f"a broken zip file ({error})", whole) from None
    _look_for_samples(metadata, set(parts), whole)


def _look_for_samples(metadata: str, parts: set[str], whole: str) -> None:
    match = _SAMPLES.search(metadata)
    if match is None:
        raise refused_file("a .sr file without logic channels", "one with a step channel")
    name = match[1]
    numbers = {int(each[len(name) + 1 :]) for each in parts if re.fullmatch(re.escape(name) + r"-\d{1,9}", each)}
    if name in parts:
        return
    missing = next(number for number in range(1, len(numbers) + 2) if number not in numbers)
    if not numbers or missing <= max(numbers):
        raise refused_file(f"a .sr file that lacks its part {f'{name}-{missing}'!r}", whole)


def _as_vcd(program: str, source: Path) -> bytes:
    """Return a session as VCD.

    Raises Rejected when sigrok-cli can't read it, takes too long or writes too much.
    """
    command = [program, "-l", "1", "-i", str(source), "-O", "vcd"]
    with tempfile.TemporaryFile() as said:
        running = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=said)
        was_late = threading.Event()

        def end_late() -> None:
            was_late.set()
            running.kill()

        late = threading.Timer(LONGEST_S, end_late)
        late.start()
        written: list[bytes] = []
        try:
            assert running.stdout is not None
            while piece := running.stdout.read(_PIECE_BYTES):
                written.append(piece)
                if len(written) * _PIECE_BYTES > MOST_VCD_BYTES:
                    raise refused_file(
                        f"a .sr file of more than {MOST_VCD_BYTES:,} bytes as VCD",
                        "up to as many: capture fewer channels, or less time",
                    )
        finally:
            late.cancel()
            running.kill()
            running.wait()
            if running.stdout is not None:
                running.stdout.close()
        said.seek(0)
        complaint = said.read(200).decode("utf-8", "replace").replace(str(source), "the file").strip()
    if was_late.is_set():
        raise refused_file(
            f"a .sr file that takes sigrok-cli more than {LONGEST_S:.0f} s to read", "up to as many: capture less time"
        )
    if complaint or not written:
        raise refused_file(
            f"a .sr file that sigrok-cli can't read ({complaint or 'it says nothing'})",
            "one that it can read, or the same exported as CSV or VCD",
        )
    return b"".join(written)
