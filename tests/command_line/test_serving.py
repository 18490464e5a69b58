import asyncio
import http.client
import json
import shutil
import socket
import ssl
import subprocess
import sys
from pathlib import Path

import pytest

from event_loop import run
from server_process import ServerProcess
from stepramp.client.health import are_well
from stepramp.command_line.main import main
from stepramp.command_line.serving import free_port, port_number, public_url, usable_data_folder
from stepramp.data_folder import FOLDER_VARIABLE, RUNTIME_VARIABLE
from stepramp.errors import Rejected
from tools import require


def test_a_taken_port_gives_the_next() -> None:
    with free_port(8800) as first, free_port(first.getsockname()[1]) as second:
        assert first.getsockname()[0] == second.getsockname()[0] == "127.0.0.1"
        assert second.getsockname()[1] > first.getsockname()[1]


def test_a_port_of_a_server_that_ended_is_free_at_once() -> None:
    with free_port(8800) as listener:
        port = listener.getsockname()[1]
        with socket.create_connection(("127.0.0.1", port)) as client, listener.accept()[0]:
            pass
        client.close()
    with free_port(port) as again:
        assert again.getsockname()[1] == port


def test_answers_are_sent_without_waiting_for_more() -> None:
    with free_port(8800) as listener:
        assert run(_has_no_delay(listener))


async def _has_no_delay(listener: socket.socket) -> bool:
    accepted: asyncio.Future[bool] = asyncio.get_running_loop().create_future()

    def note(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        connection = writer.get_extra_info("socket")
        accepted.set_result(connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY) != 0)
        writer.close()

    async with await asyncio.start_server(note, sock=listener):
        _, client = await asyncio.open_connection(*listener.getsockname())
        client.close()
        return await accepted


@pytest.mark.parametrize("text", ["0", "65536", "-1", "http", "", "80.5", "٣"])
def test_a_port_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(Rejected, match=r"--port is .*; allowed: a whole number from 1 to 65,535") as caught:
        port_number(text)
    assert caught.value.rejections[0].value == text


def test_the_command_line_tells_what_is_allowed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--port", "many", "--no-browser"]) == 2
    assert capsys.readouterr().err == "stepramp: --port is 'many'; allowed: a whole number from 1 to 65,535.\n"


def test_a_level_of_the_log_that_is_none_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--log-level", "loud", "--no-browser"]) == 2
    allowed = "critical, error, warning, info, debug"
    assert capsys.readouterr().err == f"stepramp: --log-level is 'loud'; allowed: {allowed}.\n"


@pytest.mark.skipif(sys.platform == "win32", reason="a file of Unix")
def test_what_can_be_no_data_folder_is_refused_by_its_name(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    for name in ("/dev/null", "/dev/null/data"):
        assert main(["serve", "--data-folder", name]) == 2
        told = f"stepramp: --data-folder is '{name}'; allowed: a folder that can be written.\n"
        assert capsys.readouterr().err == told
    monkeypatch.setenv(FOLDER_VARIABLE, "/dev/null")
    assert main(["serve"]) == 2
    assert capsys.readouterr().err.startswith("stepramp: STEPRAMP_DATA is '/dev/null'; allowed: a folder")
    assert usable_data_folder(str(tmp_path / "new")) == tmp_path / "new"


@pytest.mark.parametrize("host", ["nowhere.example", "", "256.1.1.1", "192.0.2.250", "127.0.0.1:80", "localhost"])
def test_an_address_that_is_none_of_this_machine_is_refused(host: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--host", host, "--no-browser"]) == 2
    allowed = "an IP address of this machine; 0.0.0.0 stands for all of its own"
    assert capsys.readouterr().err == f"stepramp: --host is {host!r}; allowed: {allowed}.\n"


@pytest.mark.parametrize(
    "url",
    ["lab.example", "ftp://lab.example", "https://", "https://lab.example/ramps", "https://lab.example?a=b", "",
     "https://a b", "https://me@lab.example", "https://lab.example:0", "https://lab.example:65536",
     "https://lab..example", "https://[::1",
     "https://lab.example:", "https://läb.example", "https://lab.example#x", "https://*.example", "null"],
)  # fmt: skip
def test_an_address_that_the_server_can_t_be_reached_at_is_refused(
    url: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["--public-url", url, "--no-browser"]) == 2
    allowed = "http:// or https://, a host, and its port if it has one, as https://lab.example"
    assert capsys.readouterr().err == f"stepramp: --public-url is {url!r}; allowed: {allowed}.\n"


@pytest.mark.parametrize(
    ("url", "origin"),
    [
        ("https://lab.example", "https://lab.example"),
        (" HTTPS://Lab.Example:443/ ", "https://lab.example"),
        ("https://lab.example:8443", "https://lab.example:8443"),
        ("http://192.168.1.5:80", "http://192.168.1.5"),
        ("http://[2001:DB8:0::1]:8000/", "http://[2001:db8::1]:8000"),
    ],
)
def test_the_address_that_it_is_reached_at_is_told_as_browsers_do(url: str, origin: str) -> None:
    assert public_url(url) == origin


def test_behind_a_proxy_its_links_are_the_proxy_s_and_nobody_is_who_a_header_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = ["--public-url", "https://lab.example/", "--data-folder", str(tmp_path)]
    with ServerProcess(8800, *options) as server:
        assert server.process.stdout is not None
        links = [server.process.stdout.readline().split()[-1] for _ in range(2)]
        assert all(link.startswith("https://lab.example/?token=") for link in links)
        assert server.address.hostname == "127.0.0.1"
        connection = server.connection()
        token = {"authorization": f"Bearer {links[0].split('token=')[1]}"}
        forwarded = {"x-forwarded-for": "192.168.1.77", "x-forwarded-proto": "https", "forwarded": "for=192.168.1.77"}
        connection.request("GET", "/api/v1/access", headers=token | forwarded)
        with connection.getresponse() as response:
            assert json.load(response) == {"role": "operate", "is_shared": True, "place": "127.0.0.1"}
        connection.close()
        # Commands of its user ask it where it listens.
        monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path))
        assert main(["stop"]) == 0
        server.process.terminate()
        assert server.ended() == ""


def test_files_for_tls_that_make_no_sense_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    some, none = "some.pem", "none.pem"
    Path(some).write_text("nothing")
    for options, told in (
        (["--certfile", some], "--keyfile is missing; allowed: a file, since --certfile is given."),
        (["--keyfile", some], "--certfile is missing; allowed: a file, since --keyfile is given."),
        (["--certfile", none, "--keyfile", some], f"--certfile is {none!r}; allowed: a file that can be read."),
        (["--certfile", some, "--keyfile", some], "allowed: a certificate in PEM, whose key --keyfile has"),
    ):
        assert main([*options, "--no-browser"]) == 2
        assert told in capsys.readouterr().err


def test_it_is_spoken_to_over_tls_with_the_token_that_it_prints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    require(*([] if shutil.which("openssl") else ["openssl"]))
    ca, ca_key, cert, key = (str(tmp_path / name) for name in ("ca.pem", "ca_key.pem", "cert.pem", "key.pem"))
    command = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1"]
    subprocess.run([*command, "-subj", "/CN=ca", "-keyout", ca_key, "-out", ca], check=True, capture_output=True)
    subject = [
        "-subj",
        "/CN=localhost",
        "-addext",
        "subjectAltName=IP:127.0.0.1",
        "-addext",
        "basicConstraints=CA:FALSE",
    ]
    signed = [*command, *subject, "-CA", ca, "-CAkey", ca_key, "-keyout", key, "-out", cert]
    subprocess.run(signed, check=True, capture_output=True)
    options = ["--require-token", "--certfile", cert, "--keyfile", key, "--data-folder", str(tmp_path / "data")]
    with ServerProcess(8800, *options) as server:
        assert server.process.stdout is not None
        assert server.address.scheme == "https"
        token = server.process.stdout.readline().split("token=")[1].strip()
        context = ssl.create_default_context(cafile=ca)
        connection = http.client.HTTPSConnection("127.0.0.1", server.address.port, context=context, timeout=60)
        for headers, status in (({}, 401), ({"authorization": f"Bearer {token}"}, 200)):
            connection.request("GET", "/api/v1/access", headers=headers)
            with connection.getresponse() as response:
                assert (response.status, "operate" in response.read().decode()) == (status, status == 200)
        connection.close()
        # Commands of its user know its token and its certificate, by its note; who has another folder knows neither.
        monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path / "data"))
        assert (main(["devices"]), main(["stop"]), are_well()) == (0, 0, True)
        monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path))
        assert main(["devices", "--server", f"http://127.0.0.1:{server.address.port}"]) == 3
        server.process.terminate()
        [told] = server.ended().splitlines()
        assert "127.0.0.1 asked without a token of this server: 'GET /api/v1/access'" in told


def test_at_all_addresses_the_links_are_such_as_others_can_open(tmp_path: Path) -> None:
    with ServerProcess(8800, "--host", "0.0.0.0", "--data-folder", str(tmp_path)) as server:
        assert server.process.stdout is not None
        assert server.address.hostname not in (None, "0.0.0.0")
        assert f"//{server.address.netloc}/?token=" in server.process.stdout.readline()


def test_folders_that_cannot_be_written_are_told_in_a_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file, as root may write to any folder."""
    (tmp_path / "servers").write_text("")
    monkeypatch.setenv(RUNTIME_VARIABLE, str(tmp_path))
    with ServerProcess(8800, "--data-folder", str(tmp_path)) as server:
        assert server.process.stderr is not None
        told = server.process.stderr.readline()
        server.process.terminate()
        assert server.ended() == ""
    assert "has no note of it" in told
    assert str(tmp_path / "servers") in told


def test_a_remote_port_that_is_none_is_refused_and_each_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--allow-remote-port", "http://a:1/", "--allow-remote-port", "a:1", "--allow-remote-port", "a"]
    assert main([*options, "--no-browser"]) == 2
    told = capsys.readouterr().err
    assert "--allow-remote-port is 'http://a:1/'; allowed: host:port, as printer.local:2217 or [::1]:2217" in told
    assert "--allow-remote-port is 'a'; allowed" in told


def test_help_and_version_come_without_loading_the_server() -> None:
    code = (
        "import sys, stepramp.command_line.main as program\n"
        "assert program.main(['serve', '--help']) == 0\n"
        "assert not {'numba', 'numpy', 'fastapi', 'httpx2'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)
    version = subprocess.run(
        [sys.executable, "-m", "stepramp", "--version"], check=True, capture_output=True, text=True
    )
    assert version.stdout.startswith("StepRamp 0.")
