"""Klipper's configuration: sections of options in files that include one another, read as it reads them.

What is written to it changes one option's value and nothing else: comments, order and line ends stay.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from configparser import Error, RawConfigParser
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import PurePosixPath

from stepramp.errors import Refused

Sections = Mapping[str, Mapping[str, str]]
"""The options by section, as texts."""
MAIN = "printer.cfg"
SAVED = """
#*# <---------------------- SAVE_CONFIG ---------------------->
#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.
#*#
"""
"""Above what Klipper has written itself, each line of which begins as these do."""
_SAVED_LINE = re.compile(r"#\*# ?")
_LINE_END = re.compile(r"\r\n|\r|\n")
"""What ends a line of a file that Klipper reads; other characters that Unicode has for that do not."""
_HEADER = re.compile(r"\[(?P<name>[^\]]+)\]")
_OPTION = re.compile(
    r"(?P<name>(?!\[)[^\s:=#;](?:\s*[^\s:=#;])*+)(?P<between>\s*[:=]\s*)"
    r"(?P<value>(?:\s*[^\s#;])*+)(?P<rest>\s*(?:[#;].*)?)"
)
_INCLUDE = "include "
_GAP = re.compile(r"(?<=\S)\s{2,}")
"""Blanks of which one says as much; a long row of them would keep the library busy for minutes."""


@dataclass(frozen=True)
class Place:
    """Where an option stands that counts."""

    path: str
    line: int | None
    """Counted from 0; None: the option isn't there, but its section."""
    header: int
    """The line with the section's name."""


class Configuration:
    """What files say together. files: their texts by path below the folder of configurations."""

    def __init__(self, files: Mapping[str, str], main: str = MAIN) -> None:
        """Read them; Refused when they can't be read as such."""
        self._files = files
        self._parser = RawConfigParser(strict=False, inline_comment_prefixes=(";", "#"))
        self.paths: list[str] = []
        """Of the files that are part of it."""
        try:
            self._read(main)
        except Error as error:
            raise Refused(f"The configuration can't be read: {' '.join(str(error).split())}.") from error

    @property
    def sections(self) -> dict[str, dict[str, str]]:
        """The options by section."""
        return {name: dict(self._parser.items(name)) for name in self._parser.sections()}

    def place(self, section: str, option: str) -> Place | None:
        """Return where an option stands, the last time, since that counts; None where there is no such section."""
        found: Place | None = None
        for path in self.paths:
            for at_header, line, name in _options(self._files[path], section):
                if name is None and found is None:
                    found = Place(path, None, at_header)
                elif name == option:
                    found = Place(path, line, at_header)
        return found

    def _read(self, path: str) -> None:
        if path in self.paths:
            return
        self.paths.append(path)
        lines: list[str] = []
        own, saved = _lines(self._files[path])
        for line in own:
            header = _HEADER.match(line)
            if header is None or not header["name"].startswith(_INCLUDE):
                lines.append(line.partition("#")[0])
                continue
            self._take(lines)
            for each in _named(self._files, path, header["name"].removeprefix(_INCLUDE).strip()):
                self._read(each)
        self._take(lines)
        self._take([_SAVED_LINE.sub("", line, count=1) for line in saved])

    def _take(self, lines: list[str]) -> None:
        self._parser.read_string("\n".join(_GAP.sub(" ", line) for line in lines))
        lines.clear()


def includes_of(text: str) -> list[str]:
    """Return what a file includes."""
    headers = (_HEADER.match(line) for line in _lines(text)[0])
    names = (header["name"] for header in headers if header is not None)
    return [name.removeprefix(_INCLUDE).strip() for name in names if name.startswith(_INCLUDE)]


def paths_of(files: Mapping[str, str], main: str) -> list[str]:
    """Return the files that a configuration consists of, among some, whether they make sense or not."""
    found, left = [main], [main]
    while left:
        path = left.pop()
        for pattern in includes_of(files[path]):
            new = [each for each in _named(files, path, pattern) if each not in found]
            found += new
            left += new
    return found


def with_option(text: str, place: Place, option: str, value: str) -> str:
    """Return a file's text with another value of an option; one that isn't there comes below its section's name.

    Each line keeps its end.
    """
    lines, ends = _LINE_END.split(text), [*_LINE_END.findall(text), ""]
    if place.line is None:
        end = ends[place.header] or "\n"
        lines[place.header] += f"{end}{option}: {value}"
        ends[place.header] = end
    else:
        found = _OPTION.fullmatch(lines[place.line])
        assert found is not None
        lines[place.line] = f"{found['name']}{found['between']}{value}{found['rest']}"
    return "".join(line + end for line, end in zip(lines, ends, strict=True))


def same_sections(one: Sections, other: Sections) -> bool:
    """Tell whether two say the same, whatever the blanks."""
    return _bare(one) == _bare(other)


def _bare(sections: Sections) -> dict[str, dict[str, str]]:
    return {
        name: {option: " ".join(str(value).split()) for option, value in options.items()}
        for name, options in sections.items()
    }


def _options(text: str, section: str) -> Iterator[tuple[int, int, str | None]]:
    """Yield the section's header, and each option of it: the lines of both, and the option's name."""
    header: int | None = None
    for number, line in enumerate(_lines(text)[0]):
        if (found := _HEADER.match(line)) is not None:
            header = number if found["name"].strip() == section else None
            if header is not None:
                yield header, number, None
        elif header is not None and (option := _OPTION.fullmatch(line)) is not None:
            yield header, number, option["name"].strip().lower()


def _lines(text: str) -> tuple[list[str], list[str]]:
    """Return a file's lines: its own, and those that Klipper has written itself."""
    own, _, saved = _LINE_END.sub("\n", text).partition(SAVED)
    return own.split("\n"), saved.split("\n")


def _named(files: Iterable[str], path: str, pattern: str) -> list[str]:
    """Return the files that an include of a file means, in the order of their names."""
    parts = (PurePosixPath(path).parent / pattern).parts
    return sorted(each for each in files if _is_meant(PurePosixPath(each).parts, parts))


def _is_meant(path: tuple[str, ...], pattern: tuple[str, ...]) -> bool:
    return len(path) == len(pattern) and all(map(fnmatchcase, path, pattern))
