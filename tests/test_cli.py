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

from designs import document
from event_loop import run
from server_process import ServerProcess
from stepramp.cli import free_port, main, port_number
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


@pytest.mark.parametrize("host", ["nowhere.example", "", "256.1.1.1", "192.0.2.250", "127.0.0.1:80", "localhost"])
def test_an_address_that_is_none_of_this_machine_is_refused(host: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--host", host, "--no-browser"]) == 2
    allowed = "an IP address of this machine; 0.0.0.0 stands for all of its own"
    assert capsys.readouterr().err == f"stepramp: --host is {host!r}; allowed: {allowed}.\n"


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


def test_it_is_spoken_to_over_tls_with_the_token_that_it_prints(tmp_path: Path) -> None:
    require(*([] if shutil.which("openssl") else ["openssl"]))
    cert, key = str(tmp_path / "cert.pem"), str(tmp_path / "key.pem")
    subject = ["-subj", "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1"]
    command = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-keyout", key, "-out", cert]
    subprocess.run([*command, *subject], check=True, capture_output=True)
    options = ["--require-token", "--certfile", cert, "--keyfile", key, "--data-folder", str(tmp_path / "data")]
    with ServerProcess(8800, *options) as server:
        assert server.process.stdout is not None
        assert server.address.scheme == "https"
        token = server.process.stdout.readline().split("token=")[1].strip()
        context = ssl.create_default_context(cafile=cert)
        connection = http.client.HTTPSConnection("127.0.0.1", server.address.port, context=context, timeout=60)
        for headers, status in (({}, 401), ({"authorization": f"Bearer {token}"}, 200)):
            connection.request("GET", "/api/v1/access", headers=headers)
            with connection.getresponse() as response:
                assert (response.status, "operate" in response.read().decode()) == (status, status == 200)
        connection.close()
        server.process.terminate()
        assert server.ended() == ""


def test_a_remote_port_that_is_none_is_refused_and_each_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--allow-remote-port", "http://a:1/", "--allow-remote-port", "a:1", "--allow-remote-port", "a"]
    assert main([*options, "--no-browser"]) == 2
    told = capsys.readouterr().err
    assert "--allow-remote-port is 'http://a:1/'; allowed: host:port, as printer.local:2217 or [::1]:2217" in told
    assert "--allow-remote-port is 'a'; allowed" in told


def test_help_and_version_come_without_loading_the_server() -> None:
    code = "import sys, stepramp.cli\nassert 'numba' not in sys.modules and 'fastapi' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
    version = subprocess.run(
        [sys.executable, "-m", "stepramp.cli", "--version"], check=True, capture_output=True, text=True
    )
    assert version.stdout.startswith("StepRamp 0.")


def test_a_design_is_exported_to_a_file(tmp_path: Path) -> None:
    (tmp_path / "design.json").write_text(json.dumps(document(name="Stage", move__steps=7)))
    assert main(["export", "csv", str(tmp_path / "design.json"), str(tmp_path / "steps.csv")]) == 0
    assert len((tmp_path / "steps.csv").read_text().splitlines()) == 8
    assert main(["export", "grbl", "--axis-letter", "Z", str(tmp_path / "design.json"), str(tmp_path / "z.txt")]) == 0
    # 200 · 2 / 8 = 50 steps/mm.
    assert "\n$102=50\n" in (tmp_path / "z.txt").read_text()


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_a_design_is_read_in_whatever_encoding_an_editor_saved_it(tmp_path: Path, encoding: str) -> None:
    text = json.dumps(document(name="Größe", move__steps=7), ensure_ascii=False)
    (tmp_path / "design.json").write_text(text, encoding=encoding)
    assert main(["export", "json", str(tmp_path / "design.json"), str(tmp_path / "again.json")]) == 0
    assert json.loads((tmp_path / "again.json").read_bytes())["name"] == "Größe"


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="has no file without an end")
def test_a_file_without_an_end_is_no_design(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "csv", "/dev/zero", "-"]) == 2
    assert "(it is larger than 2,000,000 bytes)" in capsys.readouterr().err


@pytest.mark.parametrize("way", ["the same", "another spelling", "a link"])
def test_a_design_is_not_overwritten_by_what_is_made_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], way: str
) -> None:
    monkeypatch.chdir(tmp_path)
    text = json.dumps(document())
    Path("design.json").write_text(text)
    Path("link.json").symlink_to("design.json")
    target = {"the same": "design.json", "another spelling": f"../{tmp_path.name}/design.json", "a link": "link.json"}
    assert main(["export", "c_newton", "design.json", target[way]]) == 2
    told = f"stepramp: file is {target[way]!r}; allowed: another file than that of the design.\n"
    assert capsys.readouterr().err == told
    assert Path("design.json").read_text() == text


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["pdf", "design.json", "-"], "format is 'pdf'; allowed: c_table, c_table_progmem"),
        (["grbl", "design.json", "-", "--axis-letter", "z"], "axis_letter is 'z'; allowed: X, Y, Z, A, B, C."),
        (["csv", "absent.json", "-"], "design is 'absent.json'; allowed: a file with a design document (No such"),
        (
            ["csv", "text.json", "-"],
            "design is 'text.json'; allowed: a file with a design document (it is no JSON: line 1",
        ),
        (
            ["csv", "latin.json", "-"],
            "design is 'latin.json'; allowed: a file with a design document (it is no text in UTF-8 or UTF-16).",
        ),
        (
            ["csv", "large.json", "-"],
            "design is 'large.json'; allowed: a file with a design document (it is larger than 2,000,000 bytes).",
        ),
        (["csv", "empty.json", "-"], "design is 'empty.json'; allowed: a file with a design document (it is empty)."),
        (["csv", "design.json", "."], "file is '.'; allowed: a file that can be written (Is a directory)."),
        (["csv", "twice.json", "-"], 'name is ["A", "B"]; allowed: one value, given once.'),
        (["csv", "wrong.json", "-"], "timer.frequency_hz is 0; allowed: a number from 1,000"),
        (["csv", "design.json", "absent/steps.csv"], "file is 'absent/steps.csv'; allowed: a file that can be written"),
    ],
)
def test_what_can_t_be_exported_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: list[str], message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("design.json").write_text(json.dumps(document()))
    Path("text.json").write_text("not JSON")
    Path("latin.json").write_bytes(b'{"name": "Rampe f\xfcr Zeiger"}')
    Path("large.json").write_bytes(b" " * 2_000_001)
    Path("empty.json").write_text("\n")
    Path("twice.json").write_text('{"name": "A", "name": "B"}')
    Path("wrong.json").write_text(json.dumps(document(timer__frequency_hz=0)))
    assert main(["export", *words]) == 2
    assert capsys.readouterr().err.startswith(f"stepramp: {message}")
