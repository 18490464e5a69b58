"""The container, as far as it goes without an engine: linted, its steps done, its check of health answered."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import venv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from stepramp.client import Client
from stepramp.command_line.serving import free_port

PROJECT = Path(__file__).parents[1]
STEPS = re.sub(r"\\\n", " ", re.sub(r"^#.*\n", "", (PROJECT / "Dockerfile").read_text("utf-8"), flags=re.MULTILINE))
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="containers are of Linux")


def steps(word: str) -> list[str]:
    """Return what the Dockerfile says after a word."""
    return [
        re.sub(r"\s+", " ", line[len(word) :]).strip() for line in STEPS.splitlines() if line.startswith(f"{word} ")
    ]


def test_its_file_is_linted() -> None:
    hadolint = Path(sys.executable).with_name("hadolint")
    linted = subprocess.run([hadolint, PROJECT / "Dockerfile"], capture_output=True, text=True, check=False)
    assert (linted.returncode, linted.stdout) == (0, "")


@pytest.fixture(scope="module")
def image(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with what COPY takes, and what `./dev install` makes of it, with the tests' own packages."""
    folder = tmp_path_factory.mktemp("image")
    ignored = shutil.ignore_patterns("__pycache__", ".git", ".venv")
    for step in steps("COPY"):
        *sources, target = step.split()
        for source in (found for each in sources for found in PROJECT.glob(each)):
            if target == "./":
                shutil.copy2(source, folder)
            elif source.is_dir():
                shutil.copytree(source, folder / target, ignore=ignored)
            else:
                (folder / target).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(source, folder / target)
    venv.create(folder / ".venv", with_pip=True)
    [found] = (folder / ".venv").glob("lib/python*/site-packages")
    (found / "tests.pth").write_text(sysconfig.get_path("purelib"))
    # What pip finds there already it makes no program of.
    mkdocs = folder / ".venv/bin/mkdocs"
    mkdocs.write_text('#!/bin/sh\nexec .venv/bin/python -m mkdocs "$@"\n')
    mkdocs.chmod(0o755)
    subprocess.run(["./dev", "install"], cwd=folder, check=True)
    return folder


def test_all_that_it_is_built_from_is_copied(image: Path) -> None:
    [run] = steps("RUN")
    install, psycopg, *users = run.split(" && ")
    assert install == "./dev install"
    assert (image / "build/help.built").exists()
    assert psycopg.endswith('--constraint requirements/test.txt "psycopg[binary]"')
    assert re.search(r"^psycopg==", (image / "requirements/test.txt").read_text(), re.MULTILINE)
    assert users == [
        "useradd --create-home --uid 1000 stepramp",
        "install --directory --owner=stepramp --group=stepramp /data",
    ]


@pytest.fixture
def container(image: Path, tmp_path: Path) -> Iterator[tuple[Path, Path, int]]:
    """Start what the image starts, with a volume; return that, the image and the port."""
    [entry] = steps("ENTRYPOINT")
    variables = dict(each.split("=") for step in steps("ENV") for each in step.split())
    assert variables["STEPRAMP_DATA"] == steps("VOLUME")[0] == "/data"
    assert steps("USER") == ["1000"]
    environment = os.environ | {"STEPRAMP_DATA": str(tmp_path / "data"), "STEPRAMP_RUNTIME": str(tmp_path / "run")}
    with free_port(8940) as listener:
        port = listener.getsockname()[1]
    command = [*json.loads(entry), "--port", str(port)]
    server = subprocess.Popen(command, cwd=image, env=environment, stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None
    try:
        assert f":{port}/" in server.stdout.readline()
        yield tmp_path / "data", image, port
    finally:
        server.terminate()
        server.communicate(timeout=60)


def test_its_server_is_healthy_and_keeps_what_it_has_in_the_volume(container: tuple[Path, Path, int]) -> None:
    data, image, port = container
    [check] = steps("HEALTHCHECK")
    for folder, is_well in ((data, True), (data / "nobody's", False)):
        environment = os.environ | {"STEPRAMP_DATA": str(folder), "STEPRAMP_RUNTIME": str(folder)}
        asked = subprocess.run(json.loads(check.partition("CMD ")[2]), cwd=image, env=environment, check=False)
        assert (asked.returncode == 0) is is_well
    design = {"schema": "stepramp/2", "timer": {"frequency_hz": 2_000_000}, "move": {"steps": 500}} | {
        "ramp": {"slew_speed_steps_per_s": 1000, "acceleration_steps_per_s2": 5000}
    }
    with Client(f"http://127.0.0.1:{port}/") as client:
        client.add_design(design, name="kept")
    assert list(data.glob("*.db*")) or list(data.glob("*.sqlite*"))


def test_with_postgresql_everything_is_named_that_it_needs() -> None:
    composed: dict[str, Any] = yaml.safe_load((PROJECT / "compose.yaml").read_text("utf-8"))
    services = composed["services"]
    stepramp, database = services["stepramp"], services["database"]
    # Reached from this machine only; within, from the engine's network, for which a token is asked.
    assert stepramp["ports"] == ["127.0.0.1:8000:8000"]
    *options, public = stepramp["command"]
    assert options == ["--host", "0.0.0.0", "--public-url"]
    assert public == "${STEPRAMP_PUBLIC_URL:-http://127.0.0.1:8000}"
    url = stepramp["environment"]["STEPRAMP_DATABASE_URL"]
    assert re.fullmatch(r"postgresql\+psycopg://stepramp:\$\{POSTGRES_PASSWORD:\?[^}]+\}@database/stepramp", url)
    assert database["environment"]["POSTGRES_USER"] == database["environment"]["POSTGRES_DB"] == "stepramp"
    assert stepramp["depends_on"] == {"database": {"condition": "service_healthy"}}
    mounted = {each.partition(":")[0] for service in services.values() for each in service["volumes"]}
    assert mounted == set(composed["volumes"])
    assert stepramp["volumes"] == [f"data:{steps('VOLUME')[0]}"]
