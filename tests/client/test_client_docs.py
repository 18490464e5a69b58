"""The examples of docs/client.md run as they stand there, one after the other, and its table has every method."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from stepramp.client.clients import AsyncClient, Client, Requests

TEXT = (Path(__file__).parents[2] / "docs/client.md").read_text("utf-8")


def test_the_examples_run(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STEPRAMP_URL", url)
    code = "\n".join(re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL))
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert "0.671791 [20000, 14142, 11547]" in ran.stdout
    assert "rows 0 a whole number from 1 to 1,000 rows" in ran.stdout
    assert "200 200" in ran.stdout


def test_the_table_has_every_method() -> None:
    table = set(re.findall(r"`(\w+)`", TEXT.partition("| | methods of both |")[2].partition("\n\n")[0]))
    stops = {"stop", "halt", "stop_all"}
    assert table == {name for name in vars(Requests) if not name.startswith("_")} | stops
    assert all(hasattr(kind, name) for kind in (Client, AsyncClient) for name in stops)
    assert "read it back" in (Requests.push.__doc__ or "")
