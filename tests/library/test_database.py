"""The database: its tables, and what becomes of one that can't be used."""

import os
import shutil
import signal
import sqlite3
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path
from time import sleep

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory

from designs import design
from stepramp.errors import Outdated, Unavailable
from stepramp.library import database as databases
from stepramp.library.database import FILE_NAME, Database
from stepramp.library.history import Device, History, _see
from stepramp.library.library import About, Library, _count_change
from stepramp.library.schema import METADATA
from waiting import until

SAVES = """
import sys
from pathlib import Path
from designs import design
from stepramp.library.database import Database
from stepramp.library.library import About, Library

library = Library(Database(Path(sys.argv[1])))
kept = library.add(design(), About("Lift"))
print(kept.id, flush=True)
while True:
    kept = library.save(kept.id, kept.version, design(move__steps=kept.revisions + 1))
    print(kept.revisions, flush=True)
"""

NEWER = """
import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade():
    op.create_table("more", sa.Column("id", sa.Integer, primary_key=True))
"""


def test_the_migrations_make_the_tables_that_are_used(tmp_path: Path, url: str | None, library: Library) -> None:
    library.search()
    with closing(Database(tmp_path, url)) as ours, ours.reading() as connection:
        assert compare_metadata(MigrationContext.configure(connection), METADATA) == []


def test_sqlite_writes_ahead_and_waits_for_the_disk(tmp_path: Path) -> None:
    with Database(tmp_path).reading() as connection:
        told = [connection.exec_driver_sql(f"PRAGMA {name}").scalar() for name in ("journal_mode", "synchronous")]
    assert told == ["wal", 2]


@pytest.mark.skipif(os.name != "posix", reason="kill -9")
@pytest.mark.parametrize("saves", [1, 300, 700])
def test_a_kill_loses_nothing_that_was_acknowledged(tmp_path: Path, saves: int) -> None:
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[1])}
    command = [sys.executable, "-c", SAVES, str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as saving:
        assert saving.stdout is not None
        design_id = saving.stdout.readline().strip()
        told = [saving.stdout.readline() for _ in range(saves)]
        saving.send_signal(signal.SIGKILL)
        told += saving.stdout.readlines()
    acknowledged = int(next(line for line in reversed(told) if line.endswith("\n")))
    library = Library(Database(tmp_path))
    kept, history = library.get(design_id)
    assert kept.revisions >= acknowledged
    assert [each.number for each in history] == list(range(kept.revisions, 0, -1))
    steps = [library.content(design_id, number)["move"]["steps"] for number in range(2, kept.revisions + 1)]  # type: ignore[index]
    assert steps == list(range(2, kept.revisions + 1))
    with closing(sqlite3.connect(tmp_path / FILE_NAME)) as file:
        assert file.execute("PRAGMA integrity_check").fetchall() == [("ok",)]


def test_a_locked_database_is_said_and_used_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(databases, "LOCKED_S", 0.01)
    library = Library(Database(tmp_path))
    kept = library.add(design(), About("Lift"))
    with closing(sqlite3.connect(tmp_path / FILE_NAME, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        with pytest.raises(Unavailable, match=r"database is locked\): nothing was saved"):
            library.save(kept.id, kept.version, design())
        assert library.get(kept.id)[0] == kept
    assert library.save(kept.id, kept.version, design()).revisions == 2


def test_a_full_disk_is_said_and_nothing_is_half_saved(tmp_path: Path) -> None:
    library = Library(Database(tmp_path))
    kept = library.add(design(), About("Lift"))
    script = f"""
import resource, shutil, signal, sys
from collections import namedtuple
from pathlib import Path
from designs import design
from stepramp.library.database import Database
from stepramp.library.library import About, Library
shutil.disk_usage = lambda folder: namedtuple("Usage", "free")(4096)
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (30_000, 30_000))
library = Library(Database(Path({str(tmp_path)!r})))
try:
    library.save({kept.id!r}, 1, design(), "x" * 100_000)
except Exception as error:
    print(type(error).__name__, error)
"""
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[1])}
    told = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, env=environment, check=True, timeout=120
    ).stdout
    assert told.startswith("Unavailable The library can't be used (the disk is full: 4,096 bytes are left where")
    assert "nothing was saved" in told
    assert library.get(kept.id)[0] == kept


def test_a_folder_that_is_none_and_a_file_that_is_no_database_are_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(Unavailable, match=r"The library can't be used \(.*file"):
        Library(Database(tmp_path / "file")).search()
    (tmp_path / FILE_NAME).write_text("no database, and long enough to be looked at" * 100)
    with pytest.raises(Unavailable, match="not a database"):
        Library(Database(tmp_path)).search()


def test_a_copy_is_kept_before_the_tables_change(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = tmp_path / "data"
    kept = Library(Database(data)).add(design(), About("Lift"))
    newer = tmp_path / "newer"
    shutil.copytree(databases._SCRIPTS.dir, newer)
    (newer / "versions" / "v0003_more.py").write_text(NEWER)
    monkeypatch.setattr(databases, "_SCRIPTS", ScriptDirectory(str(newer)))
    assert Library(Database(data)).get(kept.id)[0] == kept
    [copy] = data.glob("library-*.sqlite3")
    for path, tables in ((copy, 0), (data / FILE_NAME, 1)):
        with closing(sqlite3.connect(path)) as file:
            more = file.execute("SELECT count(*) FROM sqlite_master WHERE name = 'more'").fetchone()[0]
            assert (more, file.execute("SELECT name FROM designs").fetchall()) == (tables, [("Lift",)])


def test_tables_that_cannot_be_changed_stay_as_they_were(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = tmp_path / "data"
    kept = Library(Database(data)).add(design(), About("Lift"))
    newer = tmp_path / "newer"
    shutil.copytree(databases._SCRIPTS.dir, newer)
    (newer / "versions" / "v0003_more.py").write_text(NEWER + '    op.execute("no SQL")\n')
    with monkeypatch.context() as patch:
        patch.setattr(databases, "_SCRIPTS", ScriptDirectory(str(newer)))
        with pytest.raises(Unavailable, match="syntax error"):
            Library(Database(data)).search()
    assert Library(Database(data)).get(kept.id)[0] == kept
    with closing(sqlite3.connect(data / FILE_NAME)) as file:
        assert file.execute("SELECT name FROM sqlite_master WHERE name = 'more'").fetchall() == []


def test_a_library_of_a_newer_version_is_left_alone(tmp_path: Path) -> None:
    Library(Database(tmp_path)).search()
    with closing(sqlite3.connect(tmp_path / FILE_NAME)) as file, file:
        file.execute("UPDATE alembic_version SET version_num = '9999'")
    with pytest.raises(Unavailable, match="of a newer StepRamp"):
        Library(Database(tmp_path)).search()


@pytest.mark.parametrize(
    ("url", "told"),
    [
        ("nothing", "is no URL"),
        ("mysql://somewhere/x", "begins with mysql"),
        ("postgresql://tests@/library?host=/nowhere", "can't be used"),
    ],
)
def test_a_database_that_is_not_there_is_said(tmp_path: Path, url: str, told: str) -> None:
    with pytest.raises(Unavailable, match=told):
        Library(Database(tmp_path, url)).search()


def ask_while_it_stands_still(database: Database) -> None:
    with database.writing() as connection:
        process = connection.exec_driver_sql("SELECT pg_backend_pid()").scalar_one()
        os.kill(process, signal.SIGSTOP)
        try:
            connection.exec_driver_sql("SELECT 1")
        finally:
            os.kill(process, signal.SIGCONT)


@pytest.mark.parametrize("url", ["postgresql"], indirect=True)
def test_a_database_that_stands_still_is_said_and_used_again(
    database: Database, library: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    from stepramp.library import postgresql

    monkeypatch.setattr(postgresql, "SILENT_S", 0.2)
    kept = library.add(design(), About("Lift"))
    with pytest.raises(Unavailable, match=r"the database has not answered for 0.2 s\): nothing was saved"):
        ask_while_it_stands_still(database)
    assert library.get(kept.id)[0] == kept


def test_two_servers_that_begin_at_once_make_the_tables_once(tmp_path: Path, url: str | None) -> None:
    with (
        ThreadPoolExecutor(4) as servers,
        closing(Database(tmp_path, url)) as one,
        closing(Database(tmp_path, url)) as other,
    ):
        assert list(servers.map(lambda each: Library(each).search(), [one, other])) == [(0, []), (0, [])]


def test_one_server_writes_at_a_time(tmp_path: Path, url: str | None, database: Database) -> None:
    device = Device("grbl", "A1", "CH340", "/dev/ttyUSB0")
    kept = Library(database).add(design(), About("Lift"))
    with ThreadPoolExecutor(2) as pool, closing(Database(tmp_path, url)) as other:
        Library(other).search()
        with database.writing() as connection:
            noting = pool.submit(History(other).note_device, device)
            saving = pool.submit(Library(other).save, kept.id, 1, design(move__steps=9))
            sleep(0.2)
            assert not noting.done()
            assert not saving.done()
            _see(connection, device)
            _count_change(connection, kept.id, 1)
        noting.result()
        with pytest.raises(Outdated, match="it is at 2"):
            saving.result()
        assert len(History(other).devices()) == 1


@pytest.mark.parametrize("url", ["postgresql"], indirect=True)
def test_a_change_by_who_takes_no_lock_is_overwritten_by_nobody(url: str, database: Database) -> None:
    """An older server at the same database takes none, as while one after the other is brought up to date."""
    from psycopg import connect

    library = Library(database)
    kept = library.add(design(), About("Lift"))
    waits = "SELECT count(*) FROM pg_stat_activity WHERE wait_event_type = 'Lock'"
    with ThreadPoolExecutor(1) as pool, connect(url) as older, connect(url, autocommit=True) as watching:
        older.execute("UPDATE designs SET version = 2, name = 'Hoist'")
        describing = pool.submit(library.describe, kept.id, 1, About("Mine"))
        until(lambda: watching.execute(waits).fetchone() == (1,))
        older.commit()
        with pytest.raises(Outdated, match=r"'Hoist' was changed .* version 1, it is at 2"):
            describing.result()
    assert library.get(kept.id)[0].name == "Hoist"


@pytest.mark.parametrize("url", ["postgresql"], indirect=True)
def test_a_statement_that_takes_too_long_is_ended(url: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from stepramp.library import postgresql

    monkeypatch.setattr(postgresql, "STATEMENT_S", 0.1)
    with (
        closing(Database(tmp_path, url)) as slow,
        pytest.raises(Unavailable, match="statement timeout"),
        slow.reading() as connection,
    ):
        connection.exec_driver_sql("SELECT pg_sleep(60)")
