"""The portable part of the firmware on this machine, under the sanitizers: see host_driver.c."""

import shutil
import subprocess
from pathlib import Path
from typing import Self

_HERE = Path(__file__).parent
_SOURCES = _HERE.parent.parent / "firmware" / "src"
_FLAGS = ["-std=c99", "-g", "-O1", "-Wall", "-Wextra", "-Werror", "-fsanitize=address,undefined"]


def missing_compiler() -> list[str]:
    return [] if shutil.which("gcc") else ["gcc"]


def build(folder: Path) -> Path:
    """Build the driver in a folder; return the program."""
    program = folder / "host_driver"
    sources = [str(source) for source in sorted(_SOURCES.glob("*.c"))]
    command = ["gcc", *_FLAGS, "-fno-sanitize-recover=all", f"-I{_SOURCES}", "-o", str(program), *sources]
    result = subprocess.run([*command, str(_HERE / "host_driver.c")], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return program


class Host:
    """A running driver. A crash, or anything that a sanitizer finds, fails the next `ask`."""

    def __init__(self, program: Path) -> None:
        self._process = subprocess.Popen([str(program)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, *words: object) -> str:
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.write(" ".join(str(word) for word in words) + "\n")
        self._process.stdin.flush()
        answer = self._process.stdout.readline()
        assert answer, f"The driver died of: {words}"
        return answer.strip()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate()
        assert self._process.returncode == 0
