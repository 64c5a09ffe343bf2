"""Facts that follow from 3D boxes: distances, and physics checks that fail."""

from typing import Annotated

from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import Response
from pydantic_core import to_json

from app.db.session import ReadSession
from app.motion import service
from app.motion.facts import FactsCache
from app.motion.schemas import IdentityFacts, ObservationDistance
from app.tracks.answers import answer_for_labels

router = APIRouter(prefix="/api/drives/{drive_id}", tags=["motion"])


def _facts_cache(request: Request) -> FactsCache:
    return request.app.state.facts


@router.get("/distances")
def list_distances(
    drive_id: int,
    session: ReadSession,
    observation_id: Annotated[list[int], Query(max_length=100, description="Observations, by the store's id.")],
) -> list[ObservationDistance]:
    """How far the objects in some boxes were from the car."""
    return service.list_distances(session, drive_id, observation_id)


@router.get("/facts", response_model=list[IdentityFacts])
def list_facts(
    drive_id: int, request: Request, session: ReadSession, cache: Annotated[FactsCache, Depends(_facts_cache)]
) -> Response:
    """Distance, and failed physics checks, of every identity of the drive."""
    return answer_for_labels(request, session, drive_id, lambda: to_json(service.list_facts(session, cache, drive_id)))
