"""Moves: the firmware's machine on its engine in C, against the rule that the protocol states."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from firmware.host import Host, missing_compiler
from firmware.motion import build
from tools import require


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    require(*missing_compiler())
    return build(tmp_path_factory.mktemp("motion"))


@pytest.fixture(scope="module")
def host(program: Path) -> Iterator[Host]:
    with Host(program) as running:
        yield running
