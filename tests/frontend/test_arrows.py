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


PANELS = sorted(folder.name for folder in (FRONTEND / "panels").iterdir())
MOST_FILES = 3
"""That a new panel, or a new action of devices, has to touch; of the panel's own folder none counts."""


def naming(pattern: str, *endings: str) -> set[str]:
    """Return the files of the page in which something is named."""
    files = (path for ending in endings for path in FRONTEND.rglob(f"*.{ending}"))
    return {str(path.relative_to(FRONTEND)) for path in files if re.search(pattern, path.read_text())}


@pytest.mark.parametrize("panel", PANELS)
def test_a_panel_is_named_by_the_page_and_by_main_alone(panel: str) -> None:
    named = naming(rf"panels/{panel}/", "js", "html", "css")
    assert {path for path in named if not path.startswith(f"panels/{panel}/")} == {"index.html", "app/main.js"}


@pytest.mark.parametrize(("panel", "has_area"), [("offer", False), ("axes", False), ("tabs", True), ("status", True)])
def test_a_panel_is_added_in_two_files_or_with_an_area_of_its_own_in_three(panel: str, has_area: bool) -> None:
    """Small panels, which have no more than the page has to have of any: folder, element, and area."""
    own = naming(rf"panels/{panel}/|id=\"{panel}\"|part\('{panel}'\)", "js", "html")
    own |= {path for path in naming(rf"grid-area: {panel};", "css") if path.startswith("ui/")}
    outside = {path for path in own if not path.startswith(f"panels/{panel}/")}
    assert outside == {"index.html", "app/main.js", *(["ui/layout.css"] if has_area else [])}
    assert len(outside) <= MOST_FILES


@pytest.mark.parametrize(
    ("names", "section"),
    [
        ("saveTrace|traceFile", "trace_section.js"),
        ("useSettings", "settings_dialog.js"),
        ("disconnect", "device.js"),
        # What goes by one of the calls that are there already needs none of its own.
        ("setPosition", "jog_section.js"),
        ("takeOver", "device.js"),
    ],
)
def test_what_devices_do_is_in_three_files(names: str, section: str) -> None:
    """Its call, its action, its button."""
    named = naming(rf"\b(?:{names})\b", "js")
    assert named | {"server/api.js"} == {"server/api.js", "app/effects/device_actions.js", f"panels/device/{section}"}
    assert len(named) <= MOST_FILES
