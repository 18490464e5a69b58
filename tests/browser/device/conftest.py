from __future__ import annotations

import pytest

from browser.conftest import Watch
from browser.stepramp_page import StepRampPage


@pytest.fixture
def watch(shared_watch: Watch) -> Watch:
    return shared_watch


@pytest.fixture
def pushed(shared_page: StepRampPage) -> StepRampPage:
    """Return the module's page with the virtual controller, which has the ramp of the design."""
    shared_page.page.locator('[aria-label="Unit of length"] [data-value="steps"]').click()
    shared_page.connect()
    shared_page.push()
    return shared_page


@pytest.fixture
def pushed_alone(stepramp: StepRampPage) -> StepRampPage:
    """Return a page of the test's own with the same: it is not as it was afterwards."""
    stepramp.connect()
    stepramp.push()
    return stepramp
