"""The real firmware in a simulated ATmega328P behind a pseudo-terminal, or a sketch on a board, and its pins' edges."""

import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import threading
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Self

import numpy as np
import numpy.typing as npt

CLOCK_HZ = 16_000_000
STEP_PIN = 2
DIRECTION_PIN = 3
EDGE = np.dtype([("cycle", "<i8"), ("pin", "i1"), ("value", "i1")])

_HERE = Path(__file__).parent
_CONTROLLER = _HERE.parent.parent / "firmware" / "controller"
_SIMAVR_HEADER = Path("/usr/include/simavr/sim_avr.h")
_LIBRARIES = ["-lsimavrparts", "-lsimavr", "-lelf", "-lpthread", "-lutil"]
_POWER_CUT_EXIT = 3


@dataclass(frozen=True)
class Chip:
    """What is simulated. `timer`: the one that plays steps."""

    name: str = "atmega328p"
    timer: int = 1

    @property
    def options(self) -> list[str]:
        return ["--chip", self.name, "--timer", str(self.timer)]


class BuildError(RuntimeError):
    """The firmware or the simulator can't be built."""


def missing_tools() -> list[str]:
    """Return the names of the tools that building and running the simulator need and this machine lacks."""
    missing = [tool for tool in ("avr-gcc", "make", "gcc") if shutil.which(tool) is None]
    return missing if _SIMAVR_HEADER.exists() else [*missing, "simavr (libsimavr-dev)"]


_building = threading.Lock()
"""Threads that want the same for the first time would all build it, into the same files."""


def _run(command: list[str]) -> None:
    with _building:
        result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode:
        raise BuildError(f"{' '.join(command)} failed:\n{result.stdout}{result.stderr}")


def _refuse_missing_tools() -> None:
    if missing := missing_tools():
        raise BuildError(f"missing: {', '.join(missing)}")


@cache
def folder_of_builds() -> Path:
    """Return a folder of this process, so that two test runs at a time don't build into the same files."""
    folder = tempfile.TemporaryDirectory(prefix="stepramp-build-")
    _build_folders.append(folder)
    return Path(folder.name)


_build_folders: list[tempfile.TemporaryDirectory[str]] = []


@cache
def build_firmware(*options: str) -> Path:
    """Build the firmware, once a process; return its ELF file. BuildError when a tool is missing or the build fails.

    options: of its Makefile.
    """
    _refuse_missing_tools()
    build = folder_of_builds() / re.sub(r"[^\w=]+", "-", "-".join(["firmware", *options]))
    _run(["make", "-C", str(_CONTROLLER), f"BUILD={build}", *options])
    return build / "stepramp.elf"


def build_program(name: str, sources: Sequence[Path]) -> Path:
    """Build a program for the chip from its sources, the way the firmware is built. BuildError as above."""
    _refuse_missing_tools()
    program = folder_of_builds() / f"{name}.elf"
    includes = [f"-I{folder}" for folder in sorted({str(source.parent) for source in sources})]
    words = ["program", f"PROGRAM={program}", f"PROGRAM_SOURCES={' '.join(map(str, sources))}"]
    _run(["make", "-C", str(_CONTROLLER), *words, f"INCLUDES={' '.join(includes)}"])
    return program


@cache
def build_harness() -> Path:
    """Build the simulator, once a process; return its program. BuildError as above."""
    _refuse_missing_tools()
    program = folder_of_builds() / "avr_host"
    sources = sorted(str(source) for source in _HERE.glob("*.c"))
    flags = ["-std=gnu11", "-O2", "-Wall", "-Wextra", "-Werror", "-I/usr/include/simavr"]
    _run(["gcc", *flags, "-o", str(program), *sources, *_LIBRARIES])
    return program


class SimulatedController:
    """A controller that can be opened at `port`, and whose pins can be looked at.

    `boot_ms`: opening the port resets it, and it is deaf for so long, like an Arduino Uno (0: opening does nothing).
    `real_time`: at 16 MHz; otherwise as fast as this machine can. `eeprom`: the file that keeps its EEPROM (default: a
    new one in `workdir`). `cut_power_at_write`: the power fails in the middle of that EEPROM write, counted from 1;
    `start` runs it again, with the power on for good. `press`: a button between a pin and ground, from when to
    when it is pressed [ms]. `boot_loader`: the bytes, in a file, of one that it begins in, after each reset.
    `chip`: on which it runs. `surroundings`: more options of the simulator, such as its limit switches.
    """

    def __init__(
        self,
        firmware_elf: Path,
        workdir: Path,
        *,
        boot_ms: int = 0,
        real_time: bool = True,
        eeprom: Path | None = None,
        cut_power_at_write: int | None = None,
        press: tuple[int, int, int] | None = None,
        boot_loader: Path | None = None,
        chip: Chip | None = None,
        surroundings: Sequence[str] = (),
    ) -> None:
        self.port = str(workdir / "avr-tty")
        self.eeprom = eeprom or workdir / "eeprom.bin"
        self.statistics: dict[str, Any] = {}
        """What the last run counted; filled by `stop`."""
        self._firmware = firmware_elf
        self._edges = workdir / "edges.bin"
        self._boot_ms = boot_ms
        self._real_time = real_time
        self._cut_power_at_write = cut_power_at_write
        self._press = press
        self._boot_loader = boot_loader
        self._chip = chip or Chip()
        self._surroundings = surroundings
        self._process: subprocess.Popen[str] | None = None

    def start(self) -> None:
        """Switch it on. RuntimeError when the simulator doesn't start, or runs already."""
        if self._process:
            raise RuntimeError("The simulated controller runs already.")
        command = [str(build_harness()), "--link", self.port, "--edges", str(self._edges), "--eeprom", str(self.eeprom)]
        command += ["--boot-ms", str(self._boot_ms), *self._chip.options]
        command += [] if self._real_time else ["--free-running"]
        if self._cut_power_at_write is not None:
            command += ["--cut-power-at", str(self._cut_power_at_write)]
            self._cut_power_at_write = None
        command += [] if self._press is None else ["--press", "{}:{}-{}".format(*self._press)]
        command += self._surroundings
        command += [] if self._boot_loader is None else ["--boot-loader", str(self._boot_loader)]
        self._process = subprocess.Popen([*command, str(self._firmware)], stdout=subprocess.PIPE, text=True)
        if self._process.stdout is None or self._process.stdout.readline() != "ready\n":
            self._process.kill()
            self._process.communicate()
            self._process = None
            raise RuntimeError(f"The simulator did not start: {' '.join(command)}")

    def stop(self) -> None:
        """Switch it off, and read what it counted. Does nothing when it doesn't run."""
        if self._process is None:
            return
        process, self._process = self._process, None
        process.terminate()
        try:
            output, _ = process.communicate(timeout=10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            raise
        if process.returncode not in (0, _POWER_CUT_EXIT):
            raise RuntimeError(f"The simulator ended with {process.returncode}.")
        self.statistics = json.loads(output)

    def wait_for_power_cut(self, timeout_s: float = 30.0) -> None:
        """Wait until the power has been cut. subprocess.TimeoutExpired when that doesn't happen."""
        if self._process:
            self._process.wait(timeout_s)

    def press_reset(self) -> None:
        """Press the reset button. RuntimeError when it doesn't run."""
        self._signal(signal.SIGUSR1)

    def overwrite_variables(self) -> None:
        """Have what is behind the last variable overwritten, as by a stack that has come so far. As press_reset."""
        self._signal(signal.SIGUSR2)

    def _signal(self, number: signal.Signals) -> None:
        if self._process is None:
            raise RuntimeError("The simulated controller doesn't run.")
        os.kill(self._process.pid, number)

    def edges(self) -> npt.NDArray[np.void]:
        """Return the edges of the pins since `start`: cycle [1/16 µs], pin, value.

        While it runs, the last 10 ms may be missing; after `stop` they are complete.
        """
        data = self._edges.read_bytes()
        return np.frombuffer(data[: len(data) - len(data) % EDGE.itemsize], dtype=EDGE)

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()


@dataclass(frozen=True)
class Frame:
    """A frame on the serial line, and when [cycles]: one for the controller from its first bit to its last, one of the
    controller's from when its first byte was given to the transmitter to when its last one was."""

    is_sent: bool
    begin: int
    end: int
    data: bytes


@dataclass(frozen=True)
class TimedFrame:
    """A frame to be sent, and when: so long after the answer to the one before, and so long after the last edge of a
    step pin; but at once when a pin has had so many edges since that answer."""

    data: bytes
    wait_cycles: int = 0
    quiet_cycles: int = 0
    pin: int = 0
    edges: int = 0

    @property
    def line(self) -> str:
        return f"{self.wait_cycles} {self.quiet_cycles} {self.pin} {self.edges} {self.data.hex()}\n"


@dataclass(frozen=True)
class Conversation:
    """What a simulated controller was told, what it said and did."""

    frames: Sequence[Frame]
    edges: npt.NDArray[np.void]
    statistics: dict[str, Any]


def converse(
    firmware_elf: Path,
    workdir: Path,
    asked: Iterable[TimedFrame],
    presses: Sequence[tuple[int, float, float]] = (),
    switches: Sequence[str] = (),
) -> Conversation:
    """Let a controller answer some frames, as fast as this machine can, and always in the same way to the cycle.

    presses: pins that are connected to ground, from when to when [ms]. switches: limit switches, such as 9:0<-40.

    RuntimeError when the simulator fails.
    """
    requests, log, edges = (workdir / name for name in ("requests.txt", "log.txt", "edges.bin"))
    requests.write_text("".join(one.line for one in asked))
    command = [str(build_harness()), "--requests", str(requests), "--log", str(log), "--edges", str(edges)]
    command += ["--press", ",".join(f"{pin}:{begin}-{end}" for pin, begin, end in presses)] if presses else []
    command += ["--switch", ",".join(switches)] if switches else []
    result = subprocess.run([*command, str(firmware_elf)], capture_output=True, text=True, check=False)
    if result.returncode:
        raise RuntimeError(f"The simulator ended with {result.returncode}: {result.stderr}")
    words = [line.split() for line in log.read_text().splitlines()]
    frames = [Frame(way == ">", int(begin), int(end), bytes.fromhex(data)) for way, begin, end, data in words]
    return Conversation(frames, np.frombuffer(edges.read_bytes(), dtype=EDGE), json.loads(result.stdout))


def pulses(edges: npt.NDArray[np.void]) -> npt.NDArray[np.int64]:
    """Return the cycles at which the step pin rises."""
    return edges["cycle"][(edges["pin"] == STEP_PIN) & (edges["value"] == 1)]
