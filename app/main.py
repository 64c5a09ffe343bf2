"""The web app: its parts, put together by :func:`create_app`."""

import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path

from fastapi import APIRouter, FastAPI
from fastapi.routing import APIRoute
from pydantic import BaseModel
from starlette.middleware.gzip import GZipMiddleware

from app import __version__
from app.audit.endpoints import router as audit_router
from app.db.engine import migrate, open_engine
from app.db.session import Store
from app.drives.endpoints import router as drives_router
from app.drives.upload import remove_leftovers
from app.edits.endpoints import router as edits_router
from app.errors import ErrorBody, install_error_handlers
from app.evaluation.endpoints import router as evaluation_router
from app.exports.endpoints import router as exports_router
from app.identities.endpoints import router as identities_router
from app.jobs.endpoints import router as jobs_router
from app.media.endpoints import router as media_router
from app.merges.endpoints import router as merges_router
from app.motion.endpoints import router as motion_router
from app.motion.facts import FactsCache
from app.page import STATIC_FOLDER, install_page
from app.scene.endpoints import router as scene_router
from app.scene.manager import SceneManager
from app.scene.service import open_stored_source
from app.security import install_security
from app.settings import Settings
from app.summary.endpoints import router as summary_router
from app.tracks.endpoints import router as tracks_router

COMPRESSED_FROM_BYTES = 4_096
"""Smaller answers are sent as they are. Level 1 is what a machine that talks to itself hardly notices."""


class Health(BaseModel):
    version: str
    status: str


health_router = APIRouter(prefix="/api", tags=["health"])


@health_router.get("/health")
def get_health() -> Health:
    """Whether the server is up, and which version it is."""
    return Health(version=__version__, status="ok")


def create_app(settings: Settings, *, static_folder: Path = STATIC_FOLDER) -> FastAPI:
    """The app on one workspace. The store is opened and migrated when the app starts.

    ``app.state.stopping`` is to be set when the server is told to stop, so that endless answers end.
    """

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        remove_leftovers(settings)
        engine = open_engine(settings.store_url)
        migrate(engine)
        app.state.store = Store(engine)
        app.state.scenes = SceneManager(partial(open_stored_source, app.state.store, settings.workspace))
        yield
        app.state.stopping.set()
        app.state.scenes.close()
        engine.dispose()

    app = FastAPI(
        title="Hindsight",
        version=__version__,
        lifespan=lifespan,
        generate_unique_id_function=_operation_id,
        responses={"4XX": {"model": ErrorBody, "description": "What was wrong, where, and what to do."}},
        docs_url=None,
        redoc_url=None,
        openapi_url="/api/openapi.json",
        telemetry={  # nothing leaves the machine, whatever the environment says
            "tracing": False,
            "metrics": False,
            "logs": False,
            "operation_spans": False,
            "auto_configure": False,
        },
    )
    app.state.settings = settings
    app.state.stopping = threading.Event()
    app.state.facts = FactsCache()
    install_error_handlers(app)
    for router in (
        health_router,
        drives_router,
        tracks_router,
        identities_router,
        merges_router,
        edits_router,
        jobs_router,
        evaluation_router,
        exports_router,
        media_router,
        scene_router,
        motion_router,
        summary_router,
        audit_router,
    ):
        app.include_router(router)
    install_page(app, static_folder)
    app.add_middleware(GZipMiddleware, minimum_size=COMPRESSED_FROM_BYTES, compresslevel=1)
    install_security(app, allowed_hosts=_allowed_hosts(settings))
    return app


def _allowed_hosts(settings: Settings) -> tuple[str, ...]:
    """The hosts that were set, and the address that the server listens on."""
    host = f"[{settings.host}]" if ":" in settings.host else settings.host
    return (*settings.allowed_hosts, host)


def _operation_id(route: APIRoute) -> str:
    return route.name
