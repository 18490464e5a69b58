"""Connections to PostgreSQL on which nothing is waited for without end: it can stand still, or its cable be cut.

Loaded where a URL names one: the package psycopg is needed for nothing else.
"""

from time import monotonic
from typing import Any

import psycopg
from psycopg.abc import PQGen
from sqlalchemy import URL, Connection, Engine, create_engine, event

STATEMENT_S = 8.0
"""So long a statement may take; then the database itself ends it."""
SILENT_S = 9.0
"""So long a database that says nothing at all is waited for: longer than it may take over a statement."""
WRITING = 0x57E9_4A3B
"""What tells the lock of who writes apart from others of the same database."""


def engine_of(url: URL, locked_s: float) -> Engine:
    """Return what connects to a database. locked_s: so long others' writing is waited for, and a connection."""
    limits = f"-c lock_timeout={locked_s:g}s -c statement_timeout={STATEMENT_S:g}s"
    engine = create_engine(
        url.set(drivername="postgresql+psycopg"),
        pool_pre_ping=True,
        connect_args={"connect_timeout": int(locked_s), "options": limits},
    )
    event.listen(engine, "do_connect", _connect)
    event.listen(engine, "begin", _begin)
    return engine


class _Connection(psycopg.Connection[Any]):
    """One that ends once the database is silent: neither TCP nor the database's own limits show one that stands still.

    Over TCP the machine goes on to acknowledge what its database doesn't read.
    """

    def wait(self, gen: PQGen[Any], *args: Any, **options: Any) -> Any:
        """Carry out what is asked of the database, as psycopg does."""
        try:
            return super().wait(_unless_silent(gen), *args, **options)
        except _Silent:
            self.close()
            raise


class _Silent(psycopg.OperationalError):
    """The database says nothing."""


def _unless_silent(gen: PQGen[Any]) -> PQGen[Any]:
    """Yield what a generator of psycopg waits for; raises _Silent once that hasn't come about for too long."""
    try:
        wanted = next(gen)
        silent_since = monotonic()
        while True:
            ready = yield wanted
            if ready:
                silent_since = monotonic()
            elif monotonic() - silent_since > SILENT_S:
                raise _Silent(f"the database has not answered for {SILENT_S:g} s")
            wanted = gen.send(ready)
    except StopIteration as end:
        return end.value


def _begin(connection: Connection) -> None:
    """Have one server write at a time, as SQLite has: what it has looked at is still so as it writes."""
    if connection.get_execution_options().get("writes", False):
        connection.exec_driver_sql(f"SELECT pg_advisory_xact_lock({WRITING})")


def _connect(_dialect: object, _record: object, args: list[Any], options: dict[str, Any]) -> _Connection:
    return _Connection.connect(*args, **options)
