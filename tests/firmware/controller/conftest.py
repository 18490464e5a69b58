"""The controller through frames, with hardware made of variables."""

from collections.abc import Iterator

import pytest

from firmware.controller.client import Controller, started
from firmware.controller_host import Driver, missing_compiler
from tools import require


@pytest.fixture
def driver() -> Iterator[Driver]:
    require(*missing_compiler())
    with Driver() as running:
        yield running


@pytest.fixture
def controller(driver: Driver) -> Controller:
    return started(driver)
