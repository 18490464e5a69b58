"""Servers of this machine: each leaves a note of where it is and how it is asked, for as long as it runs.

Only what Python itself has is loaded here: a stop waits for it.
"""

import json
import os
import socket
import sys
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TextIO
from urllib.parse import parse_qsl, quote, urlsplit

from stepramp.data_folder import data_folder, runtime_folder
from stepramp.errors import Rejected, Rejection

if sys.platform != "win32":
    import fcntl

URL_VARIABLE = "STEPRAMP_URL"
TOKEN_VARIABLE = "STEPRAMP_TOKEN"
KNOCK_S = 0.5
"""So long a server of this machine may take to accept a connection, which its system does for it [s]."""
_FOLDER = "servers"
_ALLOWED = "the address of a server, as http://127.0.0.1:8000"


@dataclass(frozen=True)
class Server:
    """Where a server is, and how it is asked."""

    url: str
    """Without a slash at its end."""
    token: str | None = None
    certificate: str | None = None
    """File with the certificate that it shows, where that is not one of those that the system trusts."""

    @property
    def place(self) -> tuple[str, int]:
        """Its host and port."""
        parts = urlsplit(self.url)
        return parts.hostname or "", parts.port or (443 if parts.scheme == "https" else 80)


def named(url: str | None = None, token: str | None = None, field: str = "url") -> Server | None:
    """Return the server that is named here, or else by STEPRAMP_URL; None where none is. Raises Rejected for no URL.

    The link that a server prints may stand for its address and its token. token: else that of the link, else
    STEPRAMP_TOKEN's. field: what a refusal calls the url.
    """
    given = url if url is not None else os.environ.get(URL_VARIABLE)
    if not given:
        return None
    name = field if url is not None else URL_VARIABLE
    try:
        parts = urlsplit(given.strip())
        is_one = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
        shown = dict(parse_qsl(parts.query))
    except ValueError:
        is_one, shown = False, {}
    if not is_one or parts.fragment or parts.username is not None or set(shown) - {"token"}:
        raise Rejected([Rejection(name, given, _ALLOWED)])
    url = f"{parts.scheme}://{parts.netloc}{parts.path}".rstrip("/")
    return Server(url, token or shown.get("token") or os.environ.get(TOKEN_VARIABLE) or None)


def running(data: Path | None = None) -> list[Server]:
    """Return the servers of this machine that run, the one that began last first, wherever they keep their data.

    data: a folder where servers keep what outlasts them, which is looked at besides; None: the user's own.
    """
    notes = [note for folder in _folders(data) for note in folder.glob("*.json")]
    with suppress(OSError):  # One has just ended.
        notes.sort(key=lambda note: note.stat().st_mtime_ns, reverse=True)
    servers = dict.fromkeys(server for note in notes if (server := _read(note)) is not None)
    return [server for server in servers if _answers(server.place)]


def _folders(data: Path | None) -> list[Path]:
    """Return where notes are: where all servers of a user tell that they run, and beside the data of each.

    The former may be taken away when the user logs out, though a server goes on.
    """
    beside_data = (data or data_folder()) / _FOLDER
    # Where the system has none, and the folder in its place is another user's, there is none.
    with suppress(OSError):
        return list(dict.fromkeys([runtime_folder() / _FOLDER, beside_data]))
    return [beside_data]


@contextmanager
def noted(server: Server, data: Path | None = None) -> Iterator[None]:
    """Leave a note of a server as long as the context lasts. Nobody but its user may read it: it has the token.

    Where none of the folders that commands look into can be written to, that is told, and keeps it from nothing.
    """
    looked_into = _folders(None)
    with ExitStack() as notes:
        refusals = {folder: notes.enter_context(_noted_in(folder, server)) for folder in _folders(data)}
        if all(refusals.get(folder, "no note") for folder in looked_into):
            why = refusals.get(looked_into[0]) or f"{looked_into[0]} has no note of it"
            print(
                f"{why}: commands of this machine have to be told where this server is, by --server or {URL_VARIABLE}.",
                file=sys.stderr,
                flush=True,
            )
        yield


@contextmanager
def _noted_in(folder: Path, server: Server) -> Iterator[str | None]:
    """Leave a note in a folder; yield why there is none, or None."""
    host, port = server.place
    # Servers at two addresses of this machine may have the same port.
    note = folder / f"{quote(host, safe='')}-{port}.json"
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        file, ours = _written(note, server)
    except OSError as error:
        yield f"{folder} has no note of it ({error.strerror or error})"
        return
    with closing(file):
        try:
            yield None
        finally:
            with suppress(OSError):
                # Another server may have come to its place meanwhile.
                if os.path.samestat(note.stat(), ours):
                    note.unlink()


def _written(note: Path, server: Server) -> tuple[TextIO, os.stat_result]:
    """Write the note of a server; return its file, locked where there are locks, and which it is. Raises OSError."""
    import tempfile  # noqa: PLC0415  # a stop does without

    # A new file, which nobody but its user may read.
    descriptor, unfinished = tempfile.mkstemp(prefix=".", dir=note.parent)
    file = os.fdopen(descriptor, "w", encoding="utf-8")
    try:
        if sys.platform != "win32":
            fcntl.flock(file, fcntl.LOCK_EX)
        json.dump(asdict(server), file)
        file.flush()
        ours = os.fstat(file.fileno())
        if sys.platform == "win32":
            file.close()
        Path(unfinished).replace(note)
    except OSError:
        with suppress(OSError):
            file.close()
        Path(unfinished).unlink()
        raise
    return file, ours


def _read(note: Path) -> Server | None:
    """Return the server of a note; None where it has ended without taking that away, or isn't of this machine."""
    try:
        with note.open(encoding="utf-8") as file:
            # In a folder of temporary files anybody could leave one.
            if sys.platform != "win32" and not (_is_ours(file.fileno()) and _is_held(file.fileno())):
                return None
            server = Server(**json.load(file))
        return server if _is_here(server.place[0]) else None
    except (OSError, ValueError, TypeError, AttributeError):
        return None


def _is_ours(descriptor: int) -> bool:
    """Tell whether a file is of the user whose program this is."""
    return os.fstat(descriptor).st_uid == os.getuid()


def _is_held(descriptor: int) -> bool:
    """Tell whether the server still has its note locked, as the system sees to until its process has ended."""
    if sys.platform == "win32":
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    return False


def _is_here(host: str) -> bool:
    """Tell whether an address is this machine's own: a token goes nowhere else unless somebody says so."""
    try:
        with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as probe:
            probe.bind((host, 0))
    except OSError:
        return False
    return True


def is_here(server: Server) -> bool:
    """Tell whether a server is named by an address, or a name, of this machine alone."""
    host, port = server.place
    with suppress(OSError):
        found = {str(address[0]) for *_, address in socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)}
        return bool(found) and all(map(_is_here, found))
    return False


def _answers(place: tuple[str, int]) -> bool:
    with suppress(OSError), socket.create_connection(place, KNOCK_S):
        return True
    return False
