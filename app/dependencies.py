"""What endpoints get beside a session: the settings and the store of the running app."""

from typing import Annotated

from fastapi import Depends, Request

from app.db.session import Store
from app.settings import Settings


def _settings(request: Request) -> Settings:
    settings: Settings = request.app.state.settings
    return settings


def _store(request: Request) -> Store:
    store: Store = request.app.state.store
    return store


AppSettings = Annotated[Settings, Depends(_settings)]
AppStore = Annotated[Store, Depends(_store)]
