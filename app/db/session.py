"""Sessions: one transaction a request, committed by the dependency and by nobody else.

The dependencies end with the endpoint function, before the answer is sent, so that a commit that fails is an error that
the page sees.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

from fastapi import Depends, Request
from sqlalchemy import Engine
from sqlalchemy.orm import Session

from app.db.engine import WRITE

__all__ = ["ReadSession", "Session", "Store", "WriteSession"]


class Store:
    """Opens sessions on one engine."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self._write_engine = engine.execution_options(**{WRITE: True})

    @contextmanager
    def read(self) -> Iterator[Session]:
        """A session that sees one state of the store from its first query to its end."""
        with Session(self.engine, autoflush=False, expire_on_commit=False) as session:
            yield session

    @contextmanager
    def write(self) -> Iterator[Session]:
        """A session that may write; it commits at the end, or nothing happens when an error leaves the block."""
        with Session(self._write_engine, expire_on_commit=False) as session, session.begin():
            yield session


def _read_session(request: Request) -> Iterator[Session]:
    store: Store = request.app.state.store
    with store.read() as session:
        yield session


def _write_session(request: Request) -> Iterator[Session]:
    store: Store = request.app.state.store
    with store.write() as session:
        yield session


ReadSession = Annotated[Session, Depends(_read_session, scope="function")]
WriteSession = Annotated[Session, Depends(_write_session, scope="function")]
