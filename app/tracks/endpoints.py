"""Tracks, and observations by frame."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response

from app.db.session import ReadSession
from app.tracks import service
from app.tracks.answers import answer_for_labels
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


@router.get("/tracks", response_model=list[Track])
def list_tracks(drive_id: int, request: Request, session: ReadSession) -> Response:
    """All tracks of the drive, in order of id."""
    return answer_for_labels(request, session, drive_id, lambda: service.tracks_json(session, drive_id))


@router.get("/tracks/runs", response_model=ScoreRuns)
def list_score_runs(drive_id: int, request: Request, session: ReadSession) -> Response:
    """When each track of the drive is seen, and how sure the detector was."""
    return answer_for_labels(request, session, drive_id, lambda: service.score_runs_json(session, drive_id))
