"""The documentation as a site: every page of it, offline, from the server."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urljoin, urlsplit

import pytest
from starlette.testclient import TestClient

from stepramp.http_api import pages
from stepramp.http_api.app import create_app
from tools import require

PROJECT = Path(__file__).parents[1]
SITE = "http://127.0.0.1:8000/help/"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    program = Path(sys.executable).with_name("mkdocs")
    require(*([] if program.exists() or shutil.which("mkdocs") else ["mkdocs"]))
    folder = tmp_path_factory.mktemp("site")
    command = [program, "build", "--quiet", "--strict", "--site-dir", folder]
    subprocess.run(command, cwd=PROJECT, check=True, capture_output=True)
    return folder


@pytest.fixture(scope="module")
def client(site: Path) -> Iterator[TestClient]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pages, "documentation", lambda: site)
        with TestClient(create_app(), base_url="http://127.0.0.1:8000") as client:
            yield client


class Links(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.to: list[str] = []
        self.ids: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        del tag
        for name, value in attrs:
            if name in ("href", "src") and value:
                self.to.append(value)
            if name == "id" and value:
                self.ids.add(value)


def test_every_page_is_reached_and_no_link_leads_nowhere(client: TestClient, site: Path) -> None:
    read: dict[str, Links] = {}
    left, wanted = [SITE], list[tuple[str, str]]()
    while left:
        address = left.pop()
        if address in read:
            continue
        answer = client.get(address)
        assert answer.status_code == 200, address
        is_page = answer.headers["content-type"].startswith("text/html")
        read[address] = Links(answer.text if is_page else "")
        for to in read[address].to:
            target = urljoin(address, to)
            parts = urlsplit(target)
            if target.startswith(SITE):
                wanted.append((target.partition("#")[0], unquote(parts.fragment)))
                left.append(target.partition("#")[0])
    pages_of_site = {path.parent.relative_to(site).as_posix() for path in site.rglob("index.html")}
    reached = {
        urlsplit(each).path.removeprefix("/help/").strip("/") or "." for each, links in read.items() if links.ids
    }
    assert pages_of_site - reached == set()
    dead = {(page, part) for page, part in wanted if part and part not in read[page].ids and not part.startswith("__")}
    assert dead == set()


def test_it_loads_nothing_from_elsewhere(client: TestClient, site: Path) -> None:
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        loaded = re.findall(r'<(?:script|link|img)[^>]*(?:src|href)="(https?:[^"]+)"', text)
        assert loaded == [], page
    policy = client.get(SITE).headers["content-security-policy"]
    assert "script-src 'self' 'unsafe-inline'" in policy
    assert "script-src" not in client.get("/").headers["content-security-policy"]


def test_where_it_was_not_built_that_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pages, "documentation", lambda: None)
    with TestClient(create_app(), base_url="http://127.0.0.1:8000") as client:
        for path in ("/help", "/help/", "/help/tuning/"):
            answer = client.get(path)
            assert (answer.status_code, "./dev docs" in answer.text) == (404, True), path
