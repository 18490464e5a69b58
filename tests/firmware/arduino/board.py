"""The Arduino library built for boards as the Arduino IDE builds it, with Debian's package of Arduino's AVR core."""

import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from simulator.avr import folder_of_builds, missing_tools

LIBRARY = Path(__file__).parents[3] / "firmware"
EXAMPLES = sorted(folder.name for folder in (LIBRARY / "examples").iterdir())
_HARDWARE = Path("/usr/share/arduino/hardware/arduino/avr")
"""Where Debian's arduino-core-avr lies."""
_COMMON = ["-g", "-Os", "-ffunction-sections", "-fdata-sections", "-flto", "-DARDUINO=10819", "-DARDUINO_ARCH_AVR"]
_C = ["-std=gnu11", "-fno-fat-lto-objects"]
_CPP = ["-std=gnu++11", "-fpermissive", "-fno-exceptions", "-fno-threadsafe-statics"]
_COMPILERS = {
    ".c": ["avr-gcc", *_C],
    ".cpp": ["avr-g++", *_CPP, "-x", "c++"],
    ".S": ["avr-gcc", "-x", "assembler-with-cpp"],
}
_WARNINGS = ["-Wall", "-Wextra"]
_CORE_ONLY = ["-w", "-DDECIMAL_DIG=17"]
"""This avr-gcc's float.h lacks DECIMAL_DIG, which the core's String asks for."""


@dataclass(frozen=True)
class Board:
    name: str
    chip: str
    variant: str
    flash_bytes: int
    ram_bytes: int
    more: tuple[str, ...] = ()

    @property
    def flags(self) -> list[str]:
        core = [f"-I{_HARDWARE}/cores/arduino", f"-I{_HARDWARE}/variants/{self.variant}"]
        return [f"-mmcu={self.chip}", "-DF_CPU=16000000L", f"-DARDUINO_AVR_{self.name}", *_COMMON, *core, *self.more]


UNO = Board("UNO", "atmega328p", "standard", 32_256, 2048)
MEGA = Board("MEGA2560", "atmega2560", "mega", 253_952, 8192)
_USB = ("-DUSB_VID=0x2341", "-DUSB_PID=0x8036", '-DUSB_MANUFACTURER="Unknown"', '-DUSB_PRODUCT="Leonardo"')
LEONARDO = Board("LEONARDO", "atmega32u4", "leonardo", 28_672, 2560, _USB)


@dataclass(frozen=True)
class Sketch:
    elf: Path
    flash_bytes: int
    ram_bytes: int
    """Of variables: what is left is the stack's."""
    warnings: str
    """Of the library and the sketch."""

    def has_formulas(self) -> bool:
        """Tell whether it can compute ramps."""
        names = subprocess.run(["avr-nm", str(self.elf)], capture_output=True, text=True, check=True).stdout
        return "formula" in names


def sources_of(library: Path) -> list[Path]:
    """Return what the IDE compiles of a library: all that lies in its src/, at any depth."""
    return sorted(path for path in (library / "src").rglob("*") if path.suffix in {".c", ".cpp", ".S"})


def missing() -> list[str]:
    """Return what building and running sketches needs and this machine lacks."""
    return missing_tools() + ([] if _HARDWARE.exists() else ["arduino-core-avr"])


def _compile(board: Board, source: Path, target: Path, *more: str) -> str:
    """Compile a file; return the compiler's warnings. AssertionError when it isn't good."""
    compiler = _COMPILERS[source.suffix]
    command = [*compiler, *board.flags, *more, "-c", str(source), "-o", str(target)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return result.stderr


@cache
def _folder(board: Board, part: str) -> Path:
    folder = folder_of_builds() / "arduino" / board.name / part
    folder.mkdir(parents=True)
    return folder


@cache
def _core(board: Board) -> Path:
    folder = _folder(board, "core")
    for source in sorted((_HARDWARE / "cores/arduino").glob("*.c*")):
        _compile(board, source, folder / f"{source.name}.o", *_CORE_ONLY)
    archive = folder / "core.a"
    subprocess.run(["avr-gcc-ar", "rcs", str(archive), *map(str, sorted(folder.glob("*.o")))], check=True)
    return archive


@cache
def _library(board: Board) -> tuple[list[Path], str]:
    """Return the library's object files, of all that lies in its src/, and their warnings."""
    folder, warnings = _folder(board, "library"), ""
    for number, source in enumerate(sources_of(LIBRARY)):
        target = folder / f"{number:02}_{source.name}.o"
        warnings += _compile(board, source, target, *_WARNINGS, f"-I{LIBRARY / 'src'}")
    return sorted(folder.glob("*.o")), warnings


@cache
def build(example: str, board: Board = UNO) -> Sketch:
    """Build an example, once a process. AssertionError when that fails, as when it doesn't fit."""
    return build_sketch(LIBRARY / "examples" / example / f"{example}.ino", board)


def build_sketch(source: Path, board: Board = UNO, *, with_library: bool = True) -> Sketch:
    """Build a sketch of one file. AssertionError as above."""
    folder = _folder(board, source.stem)
    sketch = folder / "sketch.cpp"
    sketch.write_text(f'#include <Arduino.h>\n#line 1 "{source}"\n{source.read_text()}')
    return build_files([sketch], folder, board, with_library=with_library)


def build_files(
    sources: Sequence[Path], folder: Path, board: Board, *options: str, with_library: bool = True
) -> Sketch:
    """Build a sketch of some files, compiled with options of their own. AssertionError as above."""
    objects, warnings = _library(board) if with_library else ([], "")
    includes = [f"-I{LIBRARY / 'src'}"] if with_library else []
    own = [folder / f"{source.name}.o" for source in sources]
    for source, target in zip(sources, own, strict=True):
        warnings += _compile(board, source, target, *_WARNINGS, *includes, *options)
    elf = folder / "sketch.elf"
    link = ["avr-gcc", "-w", "-Os", f"-mmcu={board.chip}", "-flto", "-fuse-linker-plugin", "-Wl,--gc-sections"]
    command = [*link, "-o", str(elf), *map(str, own), *map(str, objects), str(_core(board)), "-lm"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    sizes = subprocess.run(["avr-size", str(elf)], capture_output=True, text=True, check=True).stdout.splitlines()[1]
    text, data, bss = (int(number) for number in sizes.split()[:3])
    return Sketch(elf, text + data, data + bss, warnings)
