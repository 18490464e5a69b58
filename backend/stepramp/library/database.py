"""The library's database: SQLite in the user's data folder, or PostgreSQL where a URL names one.

It is opened when it is first asked, and again as long as that fails: nothing else of the server needs it.
"""

import shutil
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from datetime import UTC, datetime
from pathlib import Path

from alembic.config import Config
from alembic.migration import MigrationContext
from alembic.runtime.environment import EnvironmentContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, Engine, create_engine, event, make_url
from sqlalchemy.exc import ArgumentError, DataError, DBAPIError, IntegrityError, NoSuchModuleError
from sqlalchemy.pool import NullPool

from stepramp.errors import Unavailable

URL_VARIABLE = "STEPRAMP_DATABASE_URL"
FILE_NAME = "library.sqlite3"
LITTLE_BYTES = 1_000_000
"""With less room left, an I/O error is for want of it."""
LOCKED_S = 5.0
"""So long another program's writing is waited for, and a connection to a server."""


class NeverKept(Unavailable):
    """The database can be used, but keeps no such thing, nor would it later."""


_SCRIPTS = ScriptDirectory(str(Path(__file__).parent / "migrations"))


class Database:
    """Connections to the one database. For any thread."""

    def __init__(self, data: Path, url: str | None = None) -> None:
        """Name the database. data: the folder for SQLite; url: of PostgreSQL, in place of it."""
        self._file = data / FILE_NAME
        self._url = url
        self._engine: Engine | None = None
        self._opening = threading.Lock()

    @contextmanager
    def reading(self) -> Iterator[Connection]:
        """Yield a connection that sees one moment; it raises Unavailable when the database can't be used."""
        # In a transaction SQLite shows nothing else.
        how = {} if self._url is None else {"isolation_level": "REPEATABLE READ"}
        with (
            self._unavailable(),
            self._opened().connect().execution_options(**how) as connection,
            connection.begin(),
        ):
            yield connection

    @contextmanager
    def writing(self) -> Iterator[Connection]:
        """Yield the same for writing, to one at a time.

        Once it is left without an exception, what was written outlasts a power cut.
        """
        with (
            self._unavailable(),
            self._opened().connect().execution_options(writes=True) as connection,
            connection.begin(),
        ):
            yield connection

    def close(self) -> None:
        """Let go of it."""
        with self._opening:
            if self._engine is not None:
                self._engine.dispose()
                self._engine = None

    def _opened(self) -> Engine:
        with self._opening:
            if self._engine is None:
                engine = self._sqlite() if self._url is None else _named(self._url)
                try:
                    self._migrate(engine)
                except BaseException:
                    engine.dispose()
                    raise
                self._engine = engine
            return self._engine

    def _sqlite(self) -> Engine:
        self._file.parent.mkdir(parents=True, exist_ok=True)
        # What SQLite can't write it is told when it writes; a connection each time finds a file that was put back.
        engine = create_engine(f"sqlite:///{self._file}", poolclass=NullPool, connect_args={"timeout": LOCKED_S})
        event.listen(engine, "connect", _prepare)
        event.listen(engine, "begin", _begin)
        return engine

    def _migrate(self, engine: Engine) -> None:
        """Bring the tables up to date; of a file that has some already, a copy is kept first."""
        head = _SCRIPTS.get_current_head()
        with engine.connect() as connection, connection.begin():
            present = MigrationContext.configure(connection).get_current_revision()
        if present == head:
            return
        if present is not None and present not in {each.revision for each in _SCRIPTS.walk_revisions()}:
            raise Unavailable(
                f"The library is of a newer StepRamp (its tables are {present}, known are those up to {head}): "
                "it is left as it is. Use the newer one."
            )
        if present is not None and self._url is None:
            self._copy()
        # The transaction first: another server may be at it, and where it has been there is nothing left to do.
        with (
            engine.connect().execution_options(writes=True) as connection,
            connection.begin(),
            EnvironmentContext(
                Config(), _SCRIPTS, fn=lambda rev, _: _SCRIPTS._upgrade_revs("head", rev)
            ) as environment,
        ):
            environment.configure(connection=connection, transactional_ddl=True)
            environment.run_migrations()

    def _copy(self) -> None:
        now = datetime.now(UTC).strftime("%Y-%m-%dT%H-%M-%S.%fZ")
        with (
            closing(sqlite3.connect(self._file)) as source,
            closing(sqlite3.connect(self._file.with_name(f"library-{now}.sqlite3"))) as copy,
        ):
            source.backup(copy)

    @contextmanager
    def _unavailable(self) -> Iterator[None]:
        """Have whatever keeps the database from being used said in words."""
        try:
            yield
        except (DataError, IntegrityError) as error:
            raise NeverKept(
                f"The library can't keep this ({' '.join(str(error.orig).split())}): nothing was saved."
            ) from error
        except DBAPIError as error:
            reason = self._reason(error.orig)
        except (OSError, sqlite3.Error) as error:
            reason = self._reason(error)
        else:
            return
        raise Unavailable(
            f"The library can't be used ({reason}): nothing was saved in it. All else goes on without it."
        )

    def _reason(self, error: BaseException | None) -> str:
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF  # Above those bits it says which kind of it.
        if code in (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR):
            # For want of room it can't make its shared memory either, and calls that an I/O error.
            free_bytes = shutil.disk_usage(self._file.parent).free
            if code == sqlite3.SQLITE_FULL or free_bytes < LITTLE_BYTES:
                return f"the disk is full: {free_bytes:,} bytes are left where the library is"
        return " ".join(str(error).split())


def _named(url: str) -> Engine:
    try:
        given = make_url(url)
        if given.drivername not in ("postgresql", "postgresql+psycopg"):
            raise Unavailable(f"{URL_VARIABLE} begins with {given.drivername}; allowed: postgresql://…")
        from stepramp.library.postgresql import engine_of  # noqa: PLC0415  # its package may not be there

        return engine_of(given, LOCKED_S)
    except ArgumentError:
        raise Unavailable(f"{URL_VARIABLE} is no URL; allowed: postgresql://user@host/name") from None
    except (ImportError, NoSuchModuleError):
        raise Unavailable(f"{URL_VARIABLE} needs a package: pip install 'stepramp[postgresql]'") from None


def _prepare(connection: sqlite3.Connection, _: object) -> None:
    connection.isolation_level = None  # Transactions begin where SQLAlchemy says so.
    connection.execute("PRAGMA journal_mode=WAL")
    connection.execute("PRAGMA synchronous=FULL")
    connection.execute("PRAGMA foreign_keys=ON")


def _begin(connection: Connection) -> None:
    writes = connection.get_execution_options().get("writes", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")
