"""The pinned packages are those that pyproject.toml asks for, and what those need; else `./dev lock` is to be run."""

import tomllib
from importlib.metadata import requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PROJECT = Path(__file__).parents[1]
DESCRIBED = tomllib.loads((PROJECT / "pyproject.toml").read_text())
OURS = DESCRIBED["project"]["dependencies"]
GROUPS = DESCRIBED["dependency-groups"]
ASKED = {"run": OURS, "test": OURS + GROUPS["test"], "build": GROUPS["build"]}


def pinned(name: str) -> dict[str, Requirement]:
    """Return the packages of a list that are for this machine."""
    lines = (PROJECT / "requirements" / f"{name}.txt").read_text().splitlines()
    all_of_them = [Requirement(line) for line in lines if line and not line.startswith("#")]
    return {canonicalize_name(one.name): one for one in all_of_them if one.marker is None or one.marker.evaluate()}


def version(pin: Requirement) -> str:
    [specifier] = pin.specifier
    assert specifier.operator == "=="
    return specifier.version


@pytest.mark.parametrize("name", ASKED)
def test_the_list_is_what_is_needed_and_no_more(name: str) -> None:
    pins = pinned(name)
    needed, to_look_at = set[tuple[str, frozenset[str]]](), [Requirement(one) for one in ASKED[name]]
    while to_look_at:
        one = to_look_at.pop()
        key = (canonicalize_name(one.name), frozenset(one.extras))
        if key in needed:
            continue
        needed.add(key)
        assert key[0] in pins, f"{one} isn't pinned: run ./dev lock"
        assert one.specifier.contains(version(pins[key[0]])), f"{pins[key[0]]} isn't {one}: run ./dev lock"
        for text in requires(one.name) or ():
            other = Requirement(text)
            extras = one.extras or {""}
            if other.marker is None or any(other.marker.evaluate({"extra": extra}) for extra in extras):
                to_look_at.append(other)
    assert set(pins) == {package for package, _ in needed}, "run ./dev lock"


@pytest.mark.parametrize("name", ASKED)
def test_a_list_has_no_addresses(name: str) -> None:
    text = (PROJECT / "requirements" / f"{name}.txt").read_text()
    assert "://" not in text
    assert "@" not in text
