"""Puts the documentation's site into a wheel, where it has been built before: read by hatchling (pyproject.toml)."""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class SiteHook(BuildHookInterface[Any]):
    """Adds build/help as stepramp/help."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add it, unless the wheel is only a link to this folder."""
        site = Path(self.root) / "build" / "help"
        if version != "editable" and site.is_dir():
            build_data["force_include"][str(site)] = "stepramp/help"
