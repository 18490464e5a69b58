"""The rules of arduino-lint for libraries, as it documents them, on the folder that make_library.py makes.

Left out are those that ask the network or the Library Manager's index (LP017, LP018, LP022, LP042, LP048) or a speller
(LP033, LP035), and those for fields that aren't there (LP047 to LP050, LP053 to LP055, LP058)."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from firmware.arduino.board import EXAMPLES, LIBRARY
from firmware.arduino.test_library import CATEGORIES

KNOWN_FIELDS = {
    *("name", "version", "author", "maintainer", "email", "license", "sentence", "paragraph", "category", "url"),
    *("architectures", "depends", "dot_a_linkage", "includes", "precompiled", "ldflags"),
}
"""Of the Arduino library specification."""
HEADERS = {".h", ".hh", ".hpp"}
SOURCES = {".c", ".cpp", ".S", ".ino"}
KEYWORD_KINDS = {"KEYWORD1", "KEYWORD2", "KEYWORD3", "LITERAL1", "LITERAL2"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("libraries") / "StepRamp"
    subprocess.run([sys.executable, str(LIBRARY / "make_library.py"), str(made)], check=True)
    return made


@pytest.fixture(scope="module")
def properties(folder: Path) -> dict[str, str]:
    lines = (folder / "library.properties").read_text(encoding="utf-8").splitlines()
    pairs = [line.split("=", 1) for line in lines if line.strip() and not line.startswith("#")]
    assert len(dict(pairs)) == len(pairs)
    return dict(pairs)


def test_folders_and_files_have_the_names_they_must(folder: Path, properties: dict[str, str]) -> None:
    """LS002 to LS012, LD003, LD005, LD006: also the header named like the library, no links, nothing that is run."""
    assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,62}", folder.name)
    names = {path.name for path in folder.iterdir()}
    assert {"src", "examples", "library.properties", "keywords.txt"} <= names
    assert not names & {".development", ".gitmodules", "Src", "SRC", "Examples", "example", "extra", "Extras", "doc"}
    assert (folder / "src" / f"{properties['name']}.h").is_file()
    everything = sorted(folder.rglob("*"))
    assert not [path for path in everything if path.is_symlink() or path.suffix == ".exe" or path.name == "utility"]
    assert [path for path in everything if path.suffix in {".ino", ".pde"}] == sorted(
        (folder / "examples").glob("*/*.ino")
    )
    assert [path for path in everything if path.name.lower() == "library.properties"] == [folder / "library.properties"]


def test_it_has_a_readme_and_a_licence(folder: Path) -> None:
    """LD001, LD002."""
    assert (folder / "README.md").stat().st_size > 0
    assert (folder / "LICENSE").stat().st_size > 0


def test_its_fields_are_known_ones(properties: dict[str, str]) -> None:
    """LP005, LP006: no other field, none empty, no blanks around a value."""
    assert set(properties) <= KNOWN_FIELDS
    assert all(value and value == value.strip() for value in properties.values())


def test_its_name_and_makers(properties: dict[str, str]) -> None:
    """LP007 to LP016, LP023 to LP030, LP057: a short name without blanks, and nothing that claims to be Arduino's."""
    name = properties["name"]
    assert re.fullmatch(r"[A-Za-z][A-Za-z0-9 _.-]*", name)
    assert len(name) <= 16
    assert not re.search("arduino|library", name, re.IGNORECASE)
    assert not re.search("arduino", properties["maintainer"] + properties["author"], re.IGNORECASE)


def test_its_version_is_a_semantic_one(properties: dict[str, str]) -> None:
    """LP019 to LP021."""
    assert re.fullmatch(r"(0|[1-9]\d*)\.(0|[1-9]\d*)\.(0|[1-9]\d*)", properties["version"])


def test_it_says_what_it_is(properties: dict[str, str]) -> None:
    """LP031, LP032, LP034, LP036 to LP039: sentence and paragraph are shown together, below a category."""
    assert properties["sentence"] not in properties["paragraph"]
    assert properties["category"] in CATEGORIES - {"Uncategorized"}


def test_its_address_has_the_form_of_one(properties: dict[str, str]) -> None:
    """LP040, LP041, LP056. Without a page of its own, a name that can never be anybody's, and the file says so."""
    url = properties["url"]
    assert re.fullmatch(r"https?://[a-z0-9.-]+(/\S*)?", url)
    text = (LIBRARY / "library.properties").read_text(encoding="utf-8")
    assert ".invalid" not in url or "no page of its own yet" in text


def test_its_architectures_and_includes(folder: Path, properties: dict[str, str]) -> None:
    """LP043 to LP046, LP051, LP052."""
    architectures = properties["architectures"].split(",")
    assert all(re.fullmatch(r"\*|[a-z0-9_]+", architecture) for architecture in architectures)
    for header in properties["includes"].split(","):
        assert (folder / "src" / header.strip()).is_file()
        assert Path(header.strip()).suffix in HEADERS


def test_its_keywords_are_in_the_form_that_the_editor_reads(folder: Path) -> None:
    """One tab between a word and its kind, no blanks, no word twice."""
    lines = (folder / "keywords.txt").read_text(encoding="utf-8").splitlines()
    pairs = [line.split("\t") for line in lines if line and not line.startswith("#")]
    assert all(len(pair) == 2 and pair[1] in KEYWORD_KINDS and " " not in pair[0] for pair in pairs)
    assert len({word for word, _ in pairs}) == len(pairs)


def test_its_examples_are_sketches(folder: Path) -> None:
    """SS001 to SS004, LD004: a folder each, whose sketch has its name."""
    examples = folder / "examples"
    assert sorted(path.name for path in examples.iterdir()) == EXAMPLES
    for example in examples.iterdir():
        assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,62}", example.name)
        assert (example / f"{example.name}.ino").is_file()
        assert not [path for path in example.rglob("*.ino") if path.stem != example.name]


def test_the_cores_header_is_included_by_the_case_it_has(folder: Path) -> None:
    """LC001."""
    texts = [path.read_text(encoding="utf-8") for path in folder.rglob("*") if path.suffix in HEADERS | SOURCES]
    assert {name for text in texts for name in re.findall(r"#include <(arduino\.h)>", text, re.IGNORECASE)} == {
        "Arduino.h"
    }
