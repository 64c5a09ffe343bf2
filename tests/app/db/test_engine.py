"""The store: its migrations, and how it is written."""

import subprocess
import sys
from pathlib import Path

import pytest
from alembic import command
from alembic.config import Config
from sqlalchemy import Engine, inspect, text
from sqlalchemy.exc import OperationalError

from app.db import tables
from app.db.engine import StoreError, migrate, open_engine
from app.db.session import Store


@pytest.fixture
def url(tmp_path: Path) -> str:
    return f"sqlite:///{tmp_path / 'folder' / 'store.db'}"


def _alembic(engine: Engine, what: str, *arguments: str) -> None:
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parents[3] / "migrations"))
    with engine.connect() as connection:
        config.attributes["connection"] = connection
        getattr(command, what)(config, *arguments)


def test_migrations_make_every_table_from_nothing(url: str) -> None:
    engine = open_engine(url)
    migrate(engine)
    found = set(inspect(engine).get_table_names())
    assert found == {table.__tablename__ for table in tables.TABLES} | {"alembic_version"}
    engine.dispose()


def test_migrations_agree_with_the_models(url: str) -> None:
    engine = open_engine(url)
    migrate(engine)
    _alembic(engine, "check")  # raises where a model has changed without a migration
    engine.dispose()


def test_migrations_can_be_taken_back(url: str) -> None:
    engine = open_engine(url)
    migrate(engine)
    _alembic(engine, "downgrade", "base")
    assert inspect(engine).get_table_names() == ["alembic_version"]
    engine.dispose()


def test_foreign_keys_hold_again_after_a_migration(url: str) -> None:
    engine = open_engine(url)
    migrate(engine)
    with engine.connect() as connection:
        assert connection.scalar(text("PRAGMA foreign_keys")) == 1
        assert connection.scalar(text("PRAGMA journal_mode")) == "wal"
    engine.dispose()


def test_several_processes_may_start_at_once(url: str) -> None:
    code = "import sys; from app.db.engine import *; migrate(open_engine(sys.argv[1]))"
    started = [subprocess.Popen([sys.executable, "-c", code, url], stderr=subprocess.PIPE) for _ in range(3)]
    errors = [process.communicate()[1].decode() for process in started]
    assert [process.returncode for process in started] == [0, 0, 0], errors


def test_a_write_that_fails_leaves_nothing(store: Store, drive_id: int) -> None:
    def delete_and_fail() -> None:
        with store.write() as session:
            session.execute(text("DELETE FROM drive"))
            raise RuntimeError("after the write")

    with pytest.raises(RuntimeError, match="after the write"):
        delete_and_fail()
    with store.read() as session:
        assert session.scalar(text("SELECT count(*) FROM drive")) == 1


def test_writers_wait_for_each_other_from_their_first_statement_on(store: Store) -> None:
    """BEGIN IMMEDIATE: a writer that has only read so far keeps others from writing in between."""
    with store.write() as first:
        first.scalar(text("SELECT count(*) FROM drive"))
        with store.engine.connect() as second:
            second.exec_driver_sql("PRAGMA busy_timeout = 0")
            with pytest.raises(OperationalError, match="locked"):
                second.execute(text("DELETE FROM drive"))


def test_a_reader_sees_one_state_while_another_writes(store: Store, drive_id: int) -> None:
    count = text("SELECT count(*) FROM drive")
    with store.read() as reader:
        assert reader.scalar(count) == 1
        with store.write() as writer:
            writer.execute(text("DELETE FROM drive"))
        assert reader.scalar(count) == 1
    with store.read() as reader:
        assert reader.scalar(count) == 0


def test_a_store_that_is_no_database_is_told(tmp_path: Path) -> None:
    (tmp_path / "store.db").write_text("these are not the bytes of a database, but enough of them" * 100)
    with pytest.raises(StoreError, match="can't be opened: file is not a database"):
        migrate(open_engine(f"sqlite:///{tmp_path / 'store.db'}"))


def test_a_store_of_a_newer_version_is_told(url: str) -> None:
    engine = open_engine(url)
    migrate(engine)
    with engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(StoreError, match="not of this version"):
        migrate(engine)
    engine.dispose()
