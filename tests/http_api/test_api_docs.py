"""The examples of docs/api.md run as they stand there, one after the other."""

from __future__ import annotations

import asyncio
import csv
import json
import os
import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import uvicorn

from stepramp.command_line.serving import free_port
from stepramp.http_api.app import create_app

TEXT = (Path(__file__).parents[2] / "docs/api.md").read_text("utf-8")


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    listener = free_port(8920)
    app = create_app(data=tmp_path_factory.mktemp("data"))
    server = uvicorn.Server(uvicorn.Config(app, log_level="error", ws="websockets-sansio"))
    thread = threading.Thread(target=lambda: asyncio.run(server.serve([listener])))
    thread.start()
    yield f"http://127.0.0.1:{listener.getsockname()[1]}"
    server.should_exit = True
    thread.join()
    listener.close()


@pytest.mark.skipif(sys.platform == "win32", reason="a shell of Unix")
def test_the_examples_in_the_shell_run(url: str, tmp_path: Path) -> None:
    script = "set -eu\n" + "\n".join(re.findall(r"```sh\n(.*?)```", TEXT, re.DOTALL))
    environment = os.environ | {"STEPRAMP_URL": url}
    ran = subprocess.run(
        ["sh", "-c", script], capture_output=True, text=True, check=False, cwd=tmp_path, env=environment
    )
    assert (ran.returncode, ran.stderr) == (0, ""), ran.stdout
    assert '"message":"rows is 0; allowed: a whole number from 1 to 1,000 rows."' in ran.stdout
    rows = list(csv.reader(ran.stdout.partition("step,")[2].partition("{")[0].splitlines()))
    assert [row[0] for row in rows[1:4]] == ["1", "2", "3"]
    with np.load(tmp_path / "profile.npz") as arrays:
        assert arrays["intervals_ticks"].tolist() == told(tmp_path, "profile")["intervals_ticks"]
    assert told(tmp_path, "pushed")["verified"]
    assert (told(tmp_path, "moved")["state"], told(tmp_path, "moved")["position_steps"]) == ("ready", 200)
    assert (told(tmp_path, "again")["position_steps"], told(tmp_path, "stopped")["position_steps"]) == (0, 0)


def test_the_examples_in_python_run(url: str) -> None:
    code = "\n".join(re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL))
    ran = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"STEPRAMP_URL": url},
    )
    assert (ran.returncode, ran.stderr) == (0, "")


def told(folder: Path, name: str) -> dict:
    return json.loads((folder / f"{name}.json").read_text())
