"""Facts that follow from 3D boxes: distances, and physics checks that fail."""

from typing import Annotated

from fastapi import APIRouter, Depends, Request

from app.db.session import ReadSession
from app.motion import service
from app.motion.facts import FactsCache
from app.motion.schemas import IdentityFacts

router = APIRouter(prefix="/api/drives/{drive_id}", tags=["motion"])


def _facts_cache(request: Request) -> FactsCache:
    return request.app.state.facts


@router.get("/facts")
def list_facts(
    drive_id: int, session: ReadSession, cache: Annotated[FactsCache, Depends(_facts_cache)]
) -> list[IdentityFacts]:
    """Distance, and failed physics checks, of every identity of the drive."""
    return service.list_facts(session, cache, drive_id)
