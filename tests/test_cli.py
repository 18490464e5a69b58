import socket
import subprocess
import sys

import pytest

from stepramp.cli import free_port, main, port_number
from stepramp.errors import Rejected


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


@pytest.mark.parametrize("text", ["0", "65536", "-1", "http", "", "80.5", "٣"])
def test_a_port_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(Rejected, match=r"--port is .*; allowed: a whole number from 1 to 65,535") as caught:
        port_number(text)
    assert caught.value.rejections[0].value == text


def test_the_command_line_tells_what_is_allowed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--port", "many", "--no-browser"]) == 2
    assert capsys.readouterr().err == "stepramp: --port is 'many'; allowed: a whole number from 1 to 65,535.\n"


def test_help_and_version_come_without_loading_the_server() -> None:
    code = "import sys, stepramp.cli\nassert 'numba' not in sys.modules and 'fastapi' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
    version = subprocess.run(
        [sys.executable, "-m", "stepramp.cli", "--version"], check=True, capture_output=True, text=True
    )
    assert version.stdout.startswith("StepRamp 0.")
