"""What the site has besides the files of this folder: the project's other pages, and links that lead to them.

Read by mkdocs (mkdocs.yml). What a link leads to that is no page, as a file of the code, stands there as its name.
"""

import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

PROJECT = Path(__file__).parents[1]
PAGES = {
    "README.md": "about.md",
    "firmware/README.md": "firmware.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security.md",
    "CHANGELOG.md": "changes.md",
}
"""Files outside of this folder, and what they are called in the site."""
LINK = re.compile(r"(?P<image>!?)\[(?P<text>[^\]]*)\]\((?P<to>[^)#\s]*)(?P<part>#[^)\s]*)?\)")
NO_PAGES = {"openapi.json"}
DECISIONS = "decisions/index.md"
"""A page that lists them."""


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the project's other pages and the page's icon."""
    for source, name in PAGES.items():
        text = _linked((PROJECT / source).read_text(encoding="utf-8"), Path(source).parent, "")
        files.append(File.generated(config, name, content=text))
    files.append(File.generated(config, DECISIONS, content=_list_of_decisions()))
    icon = (PROJECT / "frontend" / "favicon.svg").read_bytes()
    files.append(File.generated(config, "favicon.svg", content=icon))
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Have the links of a page of this folder lead to where things are in the site."""
    del config, files
    if page.file.src_uri in (*PAGES.values(), DECISIONS):
        return markdown
    folder = Path("docs") / Path(page.file.src_uri).parent
    return _linked(markdown, folder, "../" * (len(Path(page.file.src_uri).parts) - 1))


def _list_of_decisions() -> str:
    files = sorted((PROJECT / "docs" / "decisions").glob("*.md"))
    titles = [(each.name, each.read_text(encoding="utf-8").partition("\n")[0].lstrip("# ")) for each in files]
    lines = [f"- [{title.partition('. ')[2]}]({name})" for name, title in titles]
    return "\n".join(["# Decisions", "", "Why things are as they are, half a page each.", "", *lines, ""])


def _linked(markdown: str, folder: Path, up: str) -> str:
    """Return a text of a folder of the project with its links; up: from its place in the site to the site's root."""

    def link(found: re.Match[str]) -> str:
        to, part = found["to"], found["part"] or ""
        if "://" in to or to == "":
            return found[0]
        target = _within(folder / to)
        if target in PAGES:
            return f"{found['image']}[{found['text']}]({up}{PAGES[target]}{part})"
        if target in ("docs/decisions", "docs/decisions/"):
            return f"[{found['text']}]({up}{DECISIONS})"
        below = target.removeprefix("docs/")
        if target.startswith("docs/") and (PROJECT / target).is_file() and below not in NO_PAGES:
            return f"{found['image']}[{found['text']}]({up}{below}{part})"
        return found["text"]

    return LINK.sub(link, markdown)


def _within(path: Path) -> str:
    parts: list[str] = []
    for each in path.parts:
        if each == "..":
            parts.pop()
        elif each != ".":
            parts.append(each)
    return "/".join(parts)
