"""Tests that need a tool that may be missing."""

import os

import pytest


def require(*missing: str) -> None:
    """Skip the test when tools are missing, saying which; where CI is true they must be there, so it fails."""
    if not missing:
        return
    reason = f"missing: {', '.join(missing)}"
    if os.environ.get("CI") == "true":
        pytest.fail(reason)
    pytest.skip(reason)
