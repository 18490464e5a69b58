"""The files of Klipper's configuration, as Moonraker keeps them: read, and written whole or not at all."""

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import PurePosixPath
from urllib.parse import quote

from stepramp.controllers.klipper.configuration import Configuration, includes_of, paths_of
from stepramp.controllers.klipper.conversation import Answered, Conversation
from stepramp.controllers.klipper.told import told_json
from stepramp.errors import Refused

ROOT = "config"
"""What Moonraker calls the folder of configurations."""
MOST_FILES = 100
_BOUNDARY = "stepramp-7f3a1c5e9b2d4860"


class NoFile(Refused):
    """There is no such file."""


class Unreadable(Refused):
    """There may be such a file, and its text isn't known."""


class Files:
    """The files below the folder of configurations, by their paths there."""

    def __init__(self, conversation: Conversation) -> None:
        self._conversation = conversation
        self._main: str | None = None

    def learn(self, config_file: str) -> None:
        """Find out where the configuration that Klipper reads is, given its path on the printer's disk."""
        roots = self._conversation.ask("server.files.roots")
        folders = [
            PurePosixPath(each["path"])
            for each in (roots if isinstance(roots, list) else [])
            if isinstance(each, dict) and each.get("name") == ROOT and isinstance(each.get("path"), str)
        ]
        path = PurePosixPath(config_file)
        self._main = next((str(path.relative_to(each)) for each in folders if path.is_relative_to(each)), None)

    @property
    def main(self) -> str:
        """The path of the file that Klipper reads first; Refused when Moonraker doesn't show it."""
        if self._main is None:
            raise Refused(
                "Moonraker doesn't show the file that Klipper reads: it is not in its folder of configurations."
            )
        return self._main

    def configuration(self) -> tuple[Configuration, dict[str, str]]:
        """Read the configuration: what it says, and the texts of its files."""
        files = self.texts()
        return Configuration(files, self.main), files

    def texts(self) -> dict[str, str]:
        """Read all files that the configuration consists of."""
        found = {self.main: self.read(self.main)}
        if not includes_of(found[self.main]):
            return found
        listed = self._conversation.ask("server.files.list", {"root": ROOT})
        paths = [
            each["path"]
            for each in (listed if isinstance(listed, list) else [])
            if isinstance(each, dict) and isinstance(each.get("path"), str)
        ]
        # Which of them are meant is known once they all could be read: names first, then texts.
        while wanted := self._included(found, paths):
            if len(found) + len(wanted) > MOST_FILES:
                raise Refused(f"The configuration consists of more than {MOST_FILES} files.")
            found |= {path: self.read(path) for path in wanted}
        return found

    def read(self, path: str) -> str:
        """Return a file's text; NoFile when there is none, Unreadable when it isn't given, or isn't text."""
        reply = self._conversation.request("GET", f"/server/files/{ROOT}/{quote(path)}")
        if reply.status != 200:
            kind = NoFile if reply.status == 404 else Unreadable
            raise kind(f"Moonraker doesn't give {path}: {_words(reply.body)}")
        try:
            return reply.body.decode()
        except UnicodeDecodeError as error:
            raise Unreadable(f"{path} isn't UTF-8, so it can't be written again as it is.") from error

    def present(self, paths: Iterable[str]) -> dict[str, str | None]:
        """Return files' texts, None where there is no such file; those that can't be read are left out."""
        found: dict[str, str | None] = {}
        for path in paths:
            try:
                found[path] = self.read(path)
            except NoFile:
                found[path] = None
            except Unreadable:
                pass
        return found

    def write(self, path: str, text: str, before: Mapping[str, str | None]) -> None:
        """Write a file and read it again; Refused when it isn't taken, or isn't what was sent.

        before: what was in files, as present returns it.
        """
        data = text.encode()
        place = PurePosixPath(path)
        fields = {"root": ROOT, "path": "" if str(place.parent) == "." else str(place.parent)}
        fields["checksum"] = hashlib.sha256(data).hexdigest()
        parts = [
            f'--{_BOUNDARY}\r\nContent-Disposition: form-data; name="{name}"\r\n\r\n{value}\r\n'.encode()
            for name, value in fields.items()
            if value
        ]
        disposition = f'Content-Disposition: form-data; name="file"; filename="{_quoted(place.name)}"'
        head = f"--{_BOUNDARY}\r\n{disposition}\r\nContent-Type: application/octet-stream\r\n\r\n".encode()
        body = b"".join([*parts, head, data, f"\r\n--{_BOUNDARY}--\r\n".encode()])
        kind = f"multipart/form-data; boundary={_BOUNDARY}"
        reply = self._conversation.request("POST", "/server/files/upload", body, kind)
        if reply.status not in (200, 201):
            # What fails in the midst of it may leave a part.
            is_whole = path in before and self.present([path]) == {path: before[path]}
            whole = "" if is_whole else f" {path} isn't as it was: restore a backup of this device."
            raise Refused(f"Moonraker doesn't take {path}: {_words(reply.body)}{whole}")
        if self.read(path) != text:
            raise Refused(f"{path} is not what was sent: restore a backup of this device.")

    def copy(self, path: str, to: str) -> None:
        """Have a file copied beside the others; Refused when that fails."""
        try:
            self._conversation.ask("server.files.copy", {"source": f"{ROOT}/{path}", "dest": f"{ROOT}/{to}"})
        except Answered as error:
            raise Refused(f"{path} can't be copied, so it isn't written to. {error}") from error

    def _included(self, found: dict[str, str], paths: Iterable[str]) -> list[str]:
        """Return the files that those which are known include, and that aren't known yet."""
        named = dict.fromkeys(paths, "") | found
        return [path for path in paths_of(named, self.main) if path not in found]


def _quoted(name: str) -> str:
    return name.replace("\\", "\\\\").replace('"', '\\"')


def _words(body: bytes) -> str:
    """Return what Moonraker says of a request that it refuses."""
    try:
        told = told_json(body)
    except ValueError:
        return "it doesn't say why."
    error = told.get("error") if isinstance(told, dict) else None
    return f"{error.get('message')}." if isinstance(error, dict) else "it doesn't say why."
