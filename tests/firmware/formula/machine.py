"""formula.c on this machine under the sanitizers, or with its assembly in a simulated ATmega328P: see driver.c."""

import struct
import subprocess
from pathlib import Path
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

_HERE = Path(__file__).parent
_SOURCES = _HERE.parents[2] / "firmware" / "src"
_FORMULA = _SOURCES / "stepramp" / "motion" / "formula.c"
_WARNINGS = ["-Wall", "-Wextra", "-Werror"]
MOST_AT_ONCE = 60
LIMITS = (1, 2**28 - 1)


class Status(NamedTuple):
    """What formula.h says about a motor."""

    steps_down: int
    hold_interval: int
    creep_interval: int
    slews: bool


class Stepped(NamedTuple):
    """x after some steps, and their intervals [ticks]."""

    mantissa: int
    exponent: int
    intervals: NDArray[np.int64]


def _run(command: list[str]) -> str:
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, f"{' '.join(command)}\n{result.stdout}{result.stderr}"
    return result.stdout


def build_for_host(folder: Path) -> list[str]:
    """Return the command that runs the driver on this machine."""
    program = folder / "formula_driver"
    flags = ["-std=c99", "-g", "-O1", *_WARNINGS, "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    sources = [str(_FORMULA), str(_HERE / "driver.c")]
    _run(["gcc", *flags, f"-I{_SOURCES}", "-o", str(program), *sources])
    return [str(program)]


def build_for_chip(folder: Path) -> list[str]:
    """Return the command that runs the driver in the simulator; `formula.elf` is left in the folder."""
    elf, simulator = folder / "formula.elf", folder / "formula_simulator"
    size = ["-Os", "-mcall-prologues", "-fno-jump-tables", "-fira-algorithm=priority", "-mstrict-X"]
    flags = ["-mmcu=atmega328p", "-DSTEPRAMP_IN_ASSEMBLY", *size, "-flto", "-std=c99", *_WARNINGS]
    sources = [_FORMULA, _SOURCES / "boards" / "avr" / "formula.S", _HERE / "driver.c"]
    _run(["avr-gcc", *flags, f"-I{_SOURCES}", "-o", str(elf), *map(str, sources)])
    libraries = ["-lsimavr", "-lelf", "-lpthread", "-lutil"]
    source = str(_HERE / "simulator.c")
    _run(["gcc", "-std=gnu11", "-O2", *_WARNINGS, "-I/usr/include/simavr", "-o", str(simulator), source, *libraries])
    addresses = {name: address for address, _, name in map(str.split, _run(["avr-nm", str(elf)]).splitlines())}
    return [str(simulator), str(elf), *(addresses[name] for name in ("request", "reply", "length"))]


class Machine:
    """A running driver. A crash, or anything that a sanitizer finds, fails the next request."""

    def __init__(self, command: list[str]) -> None:
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.cycles = 0
        """That the last request took; 0 on this machine."""

    def check(self, constants: bytes, limits: tuple[int, int] = LIMITS) -> bool:
        return self._ask(b"c" + struct.pack("<II", *limits) + constants) == b"\1"

    def up(self, most: int, steps_left: int = 2**32 - 1) -> NDArray[np.int64]:
        return _intervals(self._ask(struct.pack("<cIB", b"u", steps_left, most)))

    def down(self, most: int) -> NDArray[np.int64]:
        return _intervals(self._ask(bytes((ord("d"), most))))

    def status(self) -> Status:
        return Status(*struct.unpack("<III?", self._ask(b"s")))

    def step(self, count: int, flags: int, index: int, mantissa: int, exponent: int, way: bytes) -> Stepped:
        reply = self._ask(struct.pack("<cBBIIB", b"k", count, flags, index, mantissa, exponent) + way)
        return Stepped(*struct.unpack_from("<IB", reply), _intervals(reply[5:]))

    def _ask(self, request: bytes) -> bytes:
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.write(bytes((len(request),)) + request)
        self._process.stdin.flush()
        length = self._process.stdout.read(1)
        assert length, f"The driver died of: {request!r}"
        reply = self._process.stdout.read(length[0])
        (self.cycles,) = struct.unpack("<I", self._process.stdout.read(4))
        return reply

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate()
        assert self._process.returncode == 0


def _intervals(data: bytes) -> NDArray[np.int64]:
    return np.frombuffer(data, "<u4").astype(np.int64)
