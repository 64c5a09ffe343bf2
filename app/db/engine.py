"""The engine of the store, and its migrations.

SQLite runs in WAL mode: readers never wait for a writer. Transactions are begun by SQLAlchemy, not by the driver: a
writer begins with BEGIN IMMEDIATE, so that it waits for its turn at the start and never fails in the middle.
"""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.resources import as_file, files
from pathlib import Path
from sqlite3 import Connection as SqliteConnection

from alembic import command
from alembic.config import Config
from alembic.util import CommandError
from sqlalchemy import Connection, Engine, create_engine, event
from sqlalchemy.engine.interfaces import DBAPIConnection
from sqlalchemy.exc import DBAPIError
from sqlalchemy.pool import ConnectionPoolEntry

from labeler.errors import HindsightError

BUSY_TIMEOUT_MS = 30_000
WRITE = "hindsight_write"
"""Execution option of connections whose transactions write."""


class StoreError(HindsightError):
    """The store can't be used: the message says why."""


def open_engine(url: str) -> Engine:
    """An engine on the store; the folder of an SQLite file is made where missing. StoreError where it can't be."""
    engine = create_engine(url, pool_size=20, max_overflow=40)
    if engine.dialect.name == "sqlite":
        if engine.url.database:
            _make_folder(Path(engine.url.database).parent)
        event.listen(engine, "connect", _prepare_sqlite)
        event.listen(engine, "begin", _begin_sqlite)
    return engine


def _prepare_sqlite(connection: DBAPIConnection, _record: ConnectionPoolEntry) -> None:
    assert isinstance(connection, SqliteConnection)
    connection.isolation_level = None
    connection.execute(f"PRAGMA busy_timeout = {BUSY_TIMEOUT_MS}")
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = NORMAL")
    connection.execute("PRAGMA foreign_keys = ON")
    connection.execute("PRAGMA cache_size = -65536")


def _begin_sqlite(connection: Connection) -> None:
    writes = connection.get_execution_options().get(WRITE, False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(
            f"The workspace {folder} can't be made: {error.strerror or error}. Name another one with --workspace."
        ) from error


def migrate(engine: Engine) -> None:
    """Bring the store to the newest form; safe when several processes start at once. StoreError where it can't be.

    Foreign keys are off meanwhile: rewriting a table would otherwise delete the rows that point to it.
    """
    url = engine.url.render_as_string(hide_password=True)
    try:
        with as_file(files("migrations")) as scripts, _alone(engine), engine.connect() as connection:
            config = Config()
            config.set_main_option("script_location", str(scripts).replace("%", "%%"))
            config.attributes["connection"] = connection
            command.upgrade(config, "head")
    except (DBAPIError, OSError) as error:
        reason = error.orig if isinstance(error, DBAPIError) else error
        raise StoreError(f"The store {url} can't be opened: {reason}. Name another workspace.") from error
    except CommandError as error:
        raise StoreError(f"The store {url} is not of this version of Hindsight: {error}. Update it.") from error


@contextmanager
def _alone(engine: Engine) -> Iterator[None]:
    """Hold off other processes that want to migrate the same store."""
    if engine.dialect.name != "sqlite" or not engine.url.database:
        yield
        return
    path = Path(engine.url.database)
    with path.with_name(path.name + ".migrating").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
