"""What a user gets who installs the wheel, away from the checkout."""

import os
import subprocess
import sys
import urllib.request
import zipfile
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "pip", "wheel", "-q", "--disable-pip-version-check"]
    subprocess.run([*command, "--no-deps", "--no-build-isolation", "-w", folder, PROJECT], check=True)
    [wheel] = folder.glob("*.whl")
    return wheel


def test_the_wheel_has_every_file_of_the_page(wheel: Path) -> None:
    packed = {name for name in zipfile.ZipFile(wheel).namelist() if name.startswith("stepramp/frontend/")}
    page = (file.relative_to(PROJECT) for file in (PROJECT / "frontend").rglob("*") if file.is_file())
    assert packed == {f"stepramp/{file.as_posix()}" for file in page}


def test_the_installed_program_serves_the_page_from_any_folder(wheel: Path, tmp_path: Path) -> None:
    site = tmp_path / "site"
    command = [sys.executable, "-m", "pip", "install", "-q", "--disable-pip-version-check"]
    subprocess.run([*command, "--no-deps", "--target", site, wheel], check=True)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    program = [site / "bin" / "stepramp", "--no-browser", "--port", "8600"]
    server = subprocess.Popen(
        program, cwd=elsewhere, env={**os.environ, "PYTHONPATH": str(site)}, stdout=subprocess.PIPE, text=True
    )
    try:
        assert server.stdout is not None
        address = server.stdout.readline().split()[3]
        with urllib.request.urlopen(address, timeout=60) as page:
            assert b"<title>StepRamp" in page.read()
        with urllib.request.urlopen(f"{address}assets/plotly/plotly.min.js", timeout=60) as script:
            assert script.status == 200
    finally:
        server.terminate()
        server.communicate(timeout=60)
    assert server.returncode in (0, -15)


def test_the_container_is_built_by_the_command_that_newcomers_run() -> None:
    assert "RUN ./dev install" in (PROJECT / "Dockerfile").read_text()
    run = (PROJECT / "dev").read_text().split("\nrun)\n")[1].split(";;")[0]
    install = (PROJECT / "dev").read_text().split("\ninstall)\n")[1].split(";;")[0]
    assert install.split() == ["install", "run", "docs"]
    assert run.split()[:2] == ["install", "run"]
