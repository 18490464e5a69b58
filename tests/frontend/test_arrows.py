"""Which modules of the page may know which: the arrows point one way."""

import re

import pytest

from frontend.modules import FRONTEND

KNOWS = {
    "model": {"assets"},
    "server": {"model"},
    "documents": {"server", "model", "ui"},
    "devices": {"server", "model"},
    "plotting": {"server", "model"},
    "ui": {"model"},
    "app": {"plotting", "devices", "documents", "server", "model", "ui"},
    "panels": {"app", "plotting", "devices", "documents", "server", "model", "ui"},
    "docs": set(),
}
"""What the modules of a folder may import, besides each other. Only app/main.js, which connects all, knows panels."""
IMPORT = re.compile(r"^(?:import|export)\b[^;]*?from '([^']+)';", re.MULTILINE)
MODULES = sorted(FRONTEND.rglob("*.js"))


def imported(path: str) -> list[str]:
    """Return what a module imports, as paths in the page."""
    module = FRONTEND / path
    found = [(module.parent / name).resolve() for name in IMPORT.findall(module.read_text())]
    return [str(one.relative_to(FRONTEND)) for one in found]


@pytest.mark.parametrize("path", [str(module.relative_to(FRONTEND)) for module in MODULES])
def test_a_module_knows_only_what_is_beneath_it(path: str) -> None:
    folder = path.split("/", maxsplit=1)[0]
    allowed = {folder, *KNOWS[folder], *({"panels"} if path == "app/main.js" else ())}
    assert {one for one in imported(path) if one.split("/")[0] not in allowed} == set()


def test_no_panel_knows_another() -> None:
    for module in (FRONTEND / "panels").rglob("*.js"):
        path = str(module.relative_to(FRONTEND))
        own = "/".join(path.split("/")[:2])
        panels = [one for one in imported(path) if one.startswith("panels/")]
        assert [one for one in panels if not one.startswith(f"{own}/")] == [], path


def test_only_main_changes_what_listens() -> None:
    """A panel gets show and dispatch: the store itself it does not see, and nobody else knows main.js."""
    for module in MODULES:
        path = str(module.relative_to(FRONTEND))
        assert path == "app/main.js" or "createStore(" not in module.read_text() or path == "app/state.js", path
        assert "app/main.js" not in imported(path), path


@pytest.mark.parametrize(
    ("names", "lists"),
    [
        (["shortest_interval_us:", "'timer.shortest_interval_us'"], {"model/fields.js", "documents/documents.js"}),
        (["label: 'Velocity'"], {"plotting/plots.js"}),
    ],
)
def test_what_is_listed_is_listed_once(names: list[str], lists: set[str]) -> None:
    """The table "to add … touch" of docs/architecture.md: a parameter is in two files of the page, a plot in one."""
    found = {
        str(module.relative_to(FRONTEND))
        for module in MODULES
        for name in names
        if name in re.sub(r"values: \{[^}]*\}", "", re.sub(r"/\*\*.*?\*/", "", module.read_text(), flags=re.DOTALL))
    }
    assert found == lists
