"""Exported sketches, compiled as strictly as people compile, and run on a bench of this machine."""

import shutil
import subprocess
from pathlib import Path

from stepramp.design import Design
from stepramp.exports.export import Options, export
from tools import require

HERE = Path(__file__).parent
LIBRARIES = {
    "accelstepper": "AccelStepper.h",
    "fastaccelstepper": "FastAccelStepper.h",
    "teensystep": "TeensyStep.h",
    "switecx25": "SwitecX25.h",
}
STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror", f"-I{HERE / 'declared'}"]
ON_AVR = ["avr-g++", "-std=gnu++11", "-mmcu=atmega328p", "-Os"]
HERE_TOO = ["g++", "-std=gnu++17", "-O1"]


def written(folder: Path, asked: Design, library: str, name: str | None = None) -> Path:
    """Write a sketch for a library; return its path."""
    made = export(asked, library, Options(name=name))
    (folder / made.file_name).write_bytes(made.content)
    return folder / made.file_name


def compile_strictly(compiler: list[str], sketch: Path) -> None:
    """Compile a sketch against the declarations of its library; AssertionError with the first word of complaint."""
    require(*([] if shutil.which(compiler[0]) else [compiler[0]]))
    command = [*compiler, *STRICT, "-x", "c++", "-c", str(sketch), "-o", str(sketch.with_suffix(".o"))]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (result.returncode, result.stderr) == (0, "")


def run_on_bench(sketch: Path, library: str, *presses_ms: int, tick_us: int = 100) -> list[list[str]]:
    """Return what a sketch has its library do while the button is pressed at some instants: a list of words each."""
    require(*([] if shutil.which("g++") else ["g++"]))
    program = sketch.with_suffix("")
    defined = [f'-DSKETCH="{sketch}"', f'-DLIBRARY="{LIBRARIES[library]}"', f"-DTICK_US={tick_us}"]
    folder = f"-I{HERE / 'declared'}"
    subprocess.run([*HERE_TOO, folder, *defined, str(HERE / "bench.cpp"), "-o", str(program)], check=True)
    run = subprocess.run([program, *map(str, presses_ms)], capture_output=True, text=True, check=True)
    return [line.split() for line in run.stdout.splitlines()]
