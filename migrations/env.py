"""Runs migrations on the connection that ``app.db.engine.migrate`` hands over.

Foreign keys are off while a migration runs: SQLite changes a table by writing it anew and dropping the old one, and
dropping it would delete the rows that point to it.
"""

from typing import Any, Literal

from alembic import context
from alembic.autogenerate.api import AutogenContext
from sqlalchemy import Connection

from app.db.base import UtcDateTime
from app.db.tables import metadata


def _render(kind: str, item: Any, _autogen: AutogenContext) -> str | Literal[False]:
    """Write our own types as what they are in the database: a migration must not change with the app."""
    return "sa.DateTime(timezone=True)" if kind == "type" and isinstance(item, UtcDateTime) else False


def _run(connection: Connection) -> None:
    sqlite = connection.dialect.name == "sqlite"
    raw = connection.connection.dbapi_connection
    if sqlite and raw is not None:
        raw.cursor().execute("PRAGMA foreign_keys = OFF")
    try:
        context.configure(connection=connection, target_metadata=metadata, render_as_batch=True, render_item=_render)
        with connection.begin(), context.begin_transaction():
            context.run_migrations()
    finally:
        if sqlite and raw is not None:
            raw.cursor().execute("PRAGMA foreign_keys = ON")


_run(context.config.attributes["connection"])
