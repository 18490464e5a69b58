"""How servers of this machine are found, and which are not."""

from __future__ import annotations

import json
import shutil
import socket
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import platformdirs
import pytest

from stepramp.client.servers import Server, named, noted, running
from stepramp.data_folder import RUNTIME_VARIABLE
from stepramp.errors import Rejected


@pytest.fixture(autouse=True)
def runtime(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "runtime"
    monkeypatch.setenv(RUNTIME_VARIABLE, str(folder))
    return folder


@pytest.fixture
def listening() -> Iterator[socket.socket]:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        yield listener


def url_of(listener: socket.socket) -> str:
    return f"http://127.0.0.1:{listener.getsockname()[1]}"


def test_a_server_is_found_as_long_as_it_runs_and_its_token_is_its_user_s_alone(
    listening: socket.socket, tmp_path: Path
) -> None:
    server = Server(url_of(listening), "token")
    assert running(tmp_path) == []
    with noted(server, tmp_path):
        assert running(tmp_path) == [server]
        [note] = (tmp_path / "servers").glob("*.json")
        if sys.platform != "win32":
            assert note.stat().st_mode & 0o777 == 0o600
    assert running(tmp_path) == []


@pytest.mark.parametrize("taken_away", ["data", "runtime"])
def test_a_server_is_found_whatever_its_data_folder_is(
    listening: socket.socket, tmp_path: Path, runtime: Path, taken_away: str
) -> None:
    server = Server(url_of(listening))
    with noted(server, tmp_path / "data"):
        assert running(tmp_path / "other") == [server]
        shutil.rmtree(tmp_path / "data" if taken_away == "data" else runtime)
        assert running(tmp_path / "data") == [server]
    with noted(server, Path("/dev/null")):
        assert running(tmp_path / "data") == [server]


def test_the_one_that_began_last_comes_first(listening: socket.socket, tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        older, newer = Server(url_of(listening)), Server(url_of(other))
        with noted(older, tmp_path), noted(newer, tmp_path):
            assert running(tmp_path) == [newer, older]


@pytest.mark.skipif(sys.platform != "linux", reason="all of 127.0.0.0/8 is this machine")
def test_servers_at_one_port_of_two_addresses_are_found_both(listening: socket.socket, tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.2", listening.getsockname()[1])) as other:
        older, newer = Server(url_of(listening)), Server(f"http://127.0.0.2:{other.getsockname()[1]}", "token")
        with ExitStack() as first, noted(newer, tmp_path):
            first.enter_context(noted(older, tmp_path))
            assert running(tmp_path) == [older, newer]
            first.close()
            assert running(tmp_path) == [newer]


def test_a_server_that_ends_leaves_the_note_of_one_that_came_to_its_place(
    listening: socket.socket, tmp_path: Path
) -> None:
    older, newer = Server(url_of(listening)), Server(url_of(listening), "token")
    with ExitStack() as first:
        first.enter_context(noted(older, tmp_path))
        with noted(newer, tmp_path):
            first.close()
            assert running(tmp_path) == [newer]
        assert running(tmp_path) == []


@pytest.mark.skipif(sys.platform == "win32", reason="locks of Unix")
def test_a_note_of_a_server_that_was_killed_is_ignored(listening: socket.socket, tmp_path: Path) -> None:
    """Whoever listens at its port now is somebody else, who gets no token."""
    folder = tmp_path / "servers"
    folder.mkdir()
    (folder / "1.json").write_text(json.dumps({"url": url_of(listening), "token": "token", "certificate": None}))
    (folder / "2.json").write_text("{")
    assert running(tmp_path) == []


def test_a_server_that_listens_no_more_is_ignored(listening: socket.socket, tmp_path: Path) -> None:
    with noted(Server(url_of(listening)), tmp_path):
        listening.close()
        assert running(tmp_path) == []


def test_another_machine_s_address_is_not_asked_unless_it_is_named(tmp_path: Path) -> None:
    with noted(Server("http://192.0.2.7:8000", "token"), tmp_path):
        assert running(tmp_path) == []


def test_a_server_is_named_by_its_address_its_link_or_the_surroundings(monkeypatch: pytest.MonkeyPatch) -> None:
    assert named() is None
    monkeypatch.setenv("STEPRAMP_URL", "http://127.0.0.1:8000/")
    monkeypatch.setenv("STEPRAMP_TOKEN", "abc")
    assert named() == Server("http://127.0.0.1:8000", "abc")
    assert named("https://shop.local:8000/?token=xyz") == Server("https://shop.local:8000", "xyz")
    for wrong in ("127.0.0.1:8000", "http://", "http://a:0", "http://me@a", "http://a/?b=c", "http://a:x"):
        with pytest.raises(Rejected, match=r"--server is .*; allowed: the address of a server"):
            named(wrong, field="--server")


def test_a_folder_that_can_t_be_written_to_keeps_no_server_from_running(tmp_path: Path, runtime: Path) -> None:
    (tmp_path / "servers").write_text("")
    runtime.write_text("")
    with noted(Server("http://127.0.0.1:1"), tmp_path):
        assert running(tmp_path) == []


def test_a_server_that_commands_don_t_find_says_so(
    listening: socket.socket, tmp_path: Path, runtime: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    runtime.write_text("")
    server = Server(url_of(listening))
    with noted(server, tmp_path / "data of its own"):
        assert server not in running()
    assert "have to be told where this server is, by --server or STEPRAMP_URL" in capsys.readouterr().err


def test_a_runtime_folder_of_another_user_is_done_without(
    listening: socket.socket, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_: object, **__: object) -> Path:
        raise PermissionError("it is another user's")

    monkeypatch.delenv(RUNTIME_VARIABLE)
    monkeypatch.setattr(platformdirs, "user_runtime_path", refused)
    server = Server(url_of(listening))
    with noted(server, tmp_path):
        assert running(tmp_path) == [server]


def test_a_note_that_can_t_be_put_in_its_place_leaves_nothing(tmp_path: Path) -> None:
    in_its_place = tmp_path / "servers" / "127.0.0.1-1.json"
    in_its_place.mkdir(parents=True)
    with noted(Server("http://127.0.0.1:1"), tmp_path):
        assert list(in_its_place.parent.iterdir()) == [in_its_place]
