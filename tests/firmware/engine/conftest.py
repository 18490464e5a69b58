import shutil

import pytest

from simulator.avr import missing_tools
from tools import require


@pytest.fixture(autouse=True)
def _tools() -> None:
    require(*missing_tools(), *([] if shutil.which("gcc") else ["gcc"]))
