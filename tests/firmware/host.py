"""A part of the firmware on this machine, in a program that answers a line with a line."""

import shutil
import subprocess
from pathlib import Path
from typing import Self


def missing_compiler() -> list[str]:
    return [] if shutil.which("gcc") else ["gcc"]


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
