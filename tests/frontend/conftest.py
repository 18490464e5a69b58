import shutil
from collections.abc import Iterator

import pytest

from frontend.modules import Modules
from tools import require


@pytest.fixture(scope="session")
def modules(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Modules]:
    """Return the page's modules, without a page."""
    require(*([] if shutil.which("node") else ["node"]))
    with Modules(tmp_path_factory.mktemp("modules")) as running:
        yield running
