"""The whole portable firmware on this machine, under the sanitizers: the controller of protocol_driver.c."""

import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import Self

_HERE = Path(__file__).parent
_SOURCES = _HERE.parent.parent / "firmware" / "src"
_FLAGS = ["-std=c99", "-g", "-O1", "-Wall", "-Wextra", "-Werror", "-fsanitize=address,undefined"]
_build_folders: list[tempfile.TemporaryDirectory[str]] = []


def missing_compiler() -> list[str]:
    return [] if shutil.which("gcc") else ["gcc"]


@cache
def build(main: str, *, with_inputs: bool = False) -> Path:
    """Build the firmware with a program around it, a file or a folder here, once a process; return the program."""
    folder = tempfile.TemporaryDirectory(prefix="stepramp-controller-")
    _build_folders.append(folder)
    program = Path(folder.name) / Path(main).stem
    own = sorted((_HERE / main).glob("*.c")) or [_HERE / main]
    sources = [str(source) for source in (*sorted(_SOURCES.rglob("*.c")), _HERE / "protocol_port.c", *own)]
    command = [
        "gcc",
        *_FLAGS,
        "-fno-sanitize-recover=all",
        f"-DHAS_INPUTS={int(with_inputs)}",
        *(["-DSTEPRAMP_COUNTS_LATENESS"] if with_inputs else []),
        f"-I{_SOURCES}",
        f"-I{_HERE}",
        "-o",
        str(program),
        *sources,
        "-lm",
    ]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return program


class Driver:
    """A running driver. A crash, or anything that a sanitizer finds, fails the next `ask`."""

    def __init__(self, *, with_inputs: bool = False) -> None:
        program = build("protocol_driver.c", with_inputs=with_inputs)
        self._process = subprocess.Popen([str(program)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, *words: object) -> str:
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.write(" ".join(str(word) for word in words) + "\n")
        self._process.stdin.flush()
        answer = self._process.stdout.readline()
        assert answer, f"The driver died of: {words}"
        return answer.strip()

    def send(self, data: bytes) -> bytes:
        """Send bytes to the controller's serial port; return what it sends, until its line is quiet."""
        return bytes.fromhex(self.ask("serial", data.hex() or "-").replace("-", ""))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate()
        assert self._process.returncode == 0
