"""A controller with inputs, with hardware made of variables."""

from collections.abc import Iterator

import pytest

from firmware.controller_host import Driver, missing_compiler
from firmware.inputs.machine import Machine
from tools import require


@pytest.fixture
def driver() -> Iterator[Driver]:
    require(*missing_compiler())
    with Driver(with_inputs=True) as running:
        yield running


@pytest.fixture
def machine(driver: Driver) -> Machine:
    return Machine.started(driver)
