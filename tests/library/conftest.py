"""The same tests on both databases: SQLite, and a PostgreSQL of their own, which never runs as root."""

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from stepramp.library.database import Database
from stepramp.library.library import Library

SOMEBODY = "nobody"


def program(name: str) -> str | None:
    found = sorted(Path("/usr/lib/postgresql").glob(f"*/bin/{name}"))
    return shutil.which(name) or (str(found[-1]) if found else None)


@pytest.fixture(scope="session")
def postgresql() -> Iterator[Path]:
    """Serve PostgreSQL at a socket in a folder, and nowhere else; yield the folder."""
    initdb, pg_ctl = program("initdb"), program("pg_ctl")
    if initdb is None or pg_ctl is None:
        pytest.skip("PostgreSQL isn't installed: apt-get install postgresql")
    is_root = os.geteuid() == 0
    as_somebody = ["setpriv", "--reuid", SOMEBODY, "--regid", "nogroup", "--clear-groups"] if is_root else []
    folder = Path(tempfile.mkdtemp(prefix="pg"))  # Short: a socket's path has 107 bytes at most.
    if is_root:
        shutil.chown(folder, SOMEBODY)
    control = [*as_somebody, pg_ctl, "-D", str(folder / "data"), "-w"]

    def run(*command: str) -> None:
        subprocess.run(command, check=True, cwd=folder, stdout=subprocess.DEVNULL, timeout=120)

    try:
        run(*as_somebody, initdb, "-D", str(folder / "data"), "-U", "tests", "-A", "trust", "-E", "UTF8", "--no-locale")
        run(*control, "-l", str(folder / "log"), "-o", f"-k {folder} -c listen_addresses=''", "start")
        try:
            yield folder
        finally:
            run(*control, "-m", "fast", "stop")
    finally:
        shutil.rmtree(folder)


@pytest.fixture(params=["sqlite", "postgresql"])
def url(request: pytest.FixtureRequest) -> str | None:
    """Return the URL of an empty database; None for SQLite."""
    if request.param == "sqlite":
        return None
    import psycopg

    folder = request.getfixturevalue("postgresql")
    with psycopg.connect(f"host={folder} user=tests dbname=postgres", autocommit=True) as connection:
        connection.execute("DROP DATABASE IF EXISTS library WITH (FORCE)")
        connection.execute("CREATE DATABASE library")
    return f"postgresql://tests@/library?host={folder}"


@pytest.fixture
def database(tmp_path: Path, url: str | None) -> Iterator[Database]:
    made = Database(tmp_path, url)
    yield made
    made.close()


@pytest.fixture
def library(database: Database) -> Library:
    return Library(database)
