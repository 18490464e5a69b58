"""Files as analysers and simulators write them, of levels that are known."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import numpy.typing as npt

from simulator.avr import folder_of_builds, missing_tools
from tools import require

Changes = Sequence[tuple[int, int, int]]
"""Instant, channel and level of each."""


def pulses(instants: Sequence[int], width: int, channel: int = 0) -> list[tuple[int, int, int]]:
    """Return the changes of pulses of so many ticks each."""
    return [each for instant in instants for each in ((instant, channel, 1), (instant + width, channel, 0))]


def saleae_csv(changes: Changes, names: Sequence[str], tick: Fraction = Fraction(1, 10**6), begin: int = 0) -> str:
    """Return a file of Saleae Logic 2: a line for the levels at the beginning, all 0, and one for each instant."""
    levels = [0] * len(names)
    lines = [",".join(["Time [s]", *names])]
    rows: dict[int, list[int]] = {begin: levels.copy()}
    for instant, channel, level in sorted(changes):
        levels[channel] = level
        rows[instant] = levels.copy()
    for instant, row in rows.items():
        # Of twelve decimals, as Python's own arithmetic of fractions rounds them.
        picoseconds = round(Fraction(instant) * tick * 10**12)
        seconds = f"{'-' if picoseconds < 0 else ''}{abs(picoseconds) // 10**12}.{abs(picoseconds) % 10**12:012}"
        lines.append(",".join([seconds, *map(str, row)]))
    return "\n".join((*lines, ""))


def vcd(changes: Changes, names: Sequence[str], timescale: str = "1 us") -> str:
    """Return a value change dump: all 0 at first."""
    codes = [chr(33 + number) for number in range(len(names))]
    declared = "".join(f"$var wire 1 {code} {name} $end\n" for code, name in zip(codes, names, strict=True))
    head = f"$timescale {timescale} $end\n$scope module top $end\n{declared}$upscope $end\n$enddefinitions $end\n"
    values = "".join(f"#{instant}\n{level}{codes[channel]}\n" for instant, channel, level in sorted(changes))
    return f"{head}#0\n{''.join(f'0{code} ' for code in codes)}\n{values}"


def sampled(changes: Changes, count: int) -> bytes:
    """Return samples of a byte each, a bit for each channel."""
    samples = np.zeros(count, np.uint8)
    for instant, channel, level in sorted(changes):
        samples[instant:] &= np.uint8(~(1 << channel) & 255)
        samples[instant:] |= np.uint8(level << channel)
    return samples.tobytes()


def zipped(parts: dict[str, bytes]) -> bytes:
    """Return a zip file."""
    held = BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in parts.items():
            archive.writestr(name, content)
    return held.getvalue()


def sigrok_session(samples: bytes, rate_hz: int, names: Sequence[str]) -> bytes:
    """Return a session as sigrok keeps it."""
    probes = "".join(f"probe{number + 1}={name}\n" for number, name in enumerate(names))
    metadata = (
        "[global]\nsigrok version=0.5.2\n\n[device 1]\ncapturefile=logic-1\n"
        f"total probes={len(names)}\nsamplerate={rate_hz}\ntotal analog=0\n{probes}unitsize=1\n"
    )
    return zipped({"version": b"2", "metadata": metadata.encode(), "logic-1-1": samples})


def written_by_sigrok(samples: bytes, rate_hz: int, output: str, names: Sequence[str]) -> bytes:
    """Return the file that sigrok-cli writes of samples, in one of its formats with its options."""
    require(*(["sigrok-cli"] if shutil.which("sigrok-cli") is None else []))
    with TemporaryDirectory() as folder:
        source, target = Path(folder, "samples.sr"), Path(folder, "out")
        source.write_bytes(sigrok_session(samples, rate_hz, names))
        subprocess.run(["sigrok-cli", "-i", source, "-O", output, "-o", target], check=True)
        return target.read_bytes()


@cache
def _simavr_writer() -> Path:
    program = folder_of_builds() / "simavr_vcd"
    flags = ["-std=gnu11", "-O1", "-Wall", "-Wextra", "-Werror", "-I/usr/include/simavr"]
    source = Path(__file__).with_name("simavr_vcd.c")
    subprocess.run(["gcc", *flags, "-o", program, source, "-lsimavr", "-lelf"], check=True)
    return program


def written_by_simavr(changes: Changes, names: Sequence[str]) -> bytes:
    """Return the VCD file that simavr writes; instants in cycles of 16 MHz."""
    require(*missing_tools())
    with TemporaryDirectory() as folder:
        target = Path(folder, "out.vcd")
        lines = "".join(f"{instant} {channel} {level}\n" for instant, channel, level in sorted(changes))
        command = [_simavr_writer(), target, *names]
        subprocess.run(command, input=lines, text=True, check=True, capture_output=True)
        return target.read_bytes()


def instants_of(intervals: npt.NDArray[np.int64], begin: int = 0) -> list[int]:
    """Return the instants of pulses with these waits after them."""
    return [begin, *(begin + np.cumsum(intervals[:-1])).tolist()]
