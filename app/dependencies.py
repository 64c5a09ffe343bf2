"""What endpoints get beside a session: the settings, the store of the running app, and who asks."""

from typing import Annotated
from urllib.parse import unquote

from fastapi import Depends, Header, Request

from app.db.session import Store
from app.settings import Settings


def _settings(request: Request) -> Settings:
    settings: Settings = request.app.state.settings
    return settings


def _store(request: Request) -> Store:
    store: Store = request.app.state.store
    return store


def _reviewer(
    settings: Annotated[Settings, Depends(_settings)],
    name: Annotated[
        str | None,
        Header(
            alias="Hindsight-Reviewer",
            max_length=300,
            description="Who decides, percent-encoded; without it, the reviewer of the server's settings.",
        ),
    ] = None,
) -> str:
    given = unquote(name or "").strip()
    return given or settings.reviewer


AppSettings = Annotated[Settings, Depends(_settings)]
AppStore = Annotated[Store, Depends(_store)]
Reviewer = Annotated[str, Depends(_reviewer)]
"""The name of the person who decides."""
