"""Tracks, and observations by frame."""

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from app.db.session import ReadSession
from app.tracks import service
from app.tracks.schemas import ObservationPage, ScoreRuns, Track

router = APIRouter(prefix="/api/drives/{drive_id}", tags=["tracks"])


@router.get("/observations", response_model=ObservationPage)
def list_observations(
    drive_id: int,
    session: ReadSession,
    start: Annotated[int, Query(ge=0, description="First frame.")],
    stop: Annotated[int, Query(ge=0, description="Frame after the last; at most 200 frames after start.")],
) -> Response:
    """All observations in the frames ``start <= frame_index < stop``, with their labels."""
    return Response(service.observations_json(session, drive_id, start, stop), media_type="application/json")


@router.get("/tracks")
def list_tracks(drive_id: int, session: ReadSession) -> list[Track]:
    """All tracks of the drive, in order of id."""
    return service.list_tracks(session, drive_id)


@router.get("/tracks/runs", response_model=ScoreRuns)
def list_score_runs(drive_id: int, session: ReadSession) -> Response:
    """When each track of the drive is seen, and how sure the detector was."""
    return Response(service.score_runs_json(session, drive_id), media_type="application/json")
