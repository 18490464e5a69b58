from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlunsplit

import pytest

import stepramp
from controllers.grbl.emulator import GrblOnACable
from designs import document
from server_process import ServerProcess
from stepramp.command_line.main import main
from stepramp.data_folder import FOLDER_VARIABLE, RUNTIME_VARIABLE


@dataclass(frozen=True)
class Told:
    """What a command came to."""

    code: int
    out: str
    err: str


Ask = Callable[[str], Told]


@pytest.fixture
def ask(capsys: pytest.CaptureFixture[str]) -> Ask:
    """Return what runs a command line, without the program's name, in this process."""

    def asked(words: str) -> Told:
        code = main(shlex.split(words))
        told = capsys.readouterr()
        return Told(code, told.out, told.err)

    return asked


def begun(words: str, **streams: int) -> subprocess.Popen[str]:
    """Begin a command in a process of its own."""
    # The folder is another one than what PYTHONPATH may be relative to.
    path = str(Path(stepramp.__file__).parents[1])
    command = [sys.executable, "-m", "stepramp", *shlex.split(words)]
    return subprocess.Popen(command, env={**os.environ, "PYTHONPATH": path}, text=True, **streams)  # type: ignore[call-overload]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder with the files that examples name."""
    monkeypatch.chdir(tmp_path)
    Path("design.json").write_text(json.dumps(document()))
    Path("other.json").write_text(json.dumps(document(name="Other", move__steps=300)))
    Path("slow.json").write_text(json.dumps(document(ramp__slew_speed_steps_per_s=500)))
    motor = stepramp.MOTORS["NEMA 17 · 17HS19-2004S1"].motor.model_dump()
    with_motor = document(schema="stepramp/2") | {"motor": motor, "drive": {"supply_v": 24}}
    Path("motor.json").write_text(json.dumps(with_motor))
    edges = "".join(f"{n * 0.001:.6f},{n % 2}\n" for n in range(40))
    Path("capture.csv").write_text(f"Time [s],step\n{edges}")
    return tmp_path


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of what outlasts the program, of this module."""
    return tmp_path_factory.mktemp("data")


@pytest.fixture(scope="module")
def server(data: Path) -> Iterator[str]:
    """Return the address of a server of this module, which commands find by its note."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(FOLDER_VARIABLE, str(data))
        patch.setenv(RUNTIME_VARIABLE, str(data))
        with ServerProcess(8750) as running:
            yield urlunsplit(running.address).rstrip("/")
            running.process.terminate()
            running.ended()
        assert list((data / "servers").iterdir()) == []


@pytest.fixture(scope="module")
def grbl(server: str) -> Iterator[str]:
    """Return the port of a grbl."""
    del server
    with GrblOnACable() as cable:
        yield cable.port


@pytest.fixture
def alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Have no server found."""
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path / "data"))
    monkeypatch.setenv(RUNTIME_VARIABLE, str(tmp_path / "data"))
