"""Tracks and observations for the page."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from pydantic_core import to_json

from app.db.session import Session
from app.drives import repository as drives_repository
from app.errors import InvalidRequest, NotFound
from app.tracks import label_repository, repository
from app.tracks.label_repository import LabelledFrames, LabelledObservation
from app.tracks.models import LabellingRow, TrackRow
from app.tracks.repository import TrackFacts
from app.tracks.runs import score_runs

MAX_FRAMES = 200
TRUST_DIGITS = 3


def observations_json(session: Session, drive_id: int, start: int, stop: int) -> bytes:
    """An :class:`app.tracks.schemas.ObservationPage` as JSON.

    It is written from plain values: a page holds tens of thousands of observations, and models of each take most of
    the time. A test reads the answer back through the model.
    """
    if not start <= stop <= start + MAX_FRAMES:
        raise InvalidRequest(
            f"Frames {start} to {stop} can't be read at once: stop must not be below start, and at most {MAX_FRAMES} "
            "frames above it."
        )
    drive = drives_repository.find(session, drive_id)
    if drive is None:
        raise NotFound(f"There is no drive {drive_id}. It may have been deleted.")
    labelling = repository.current_labelling(session, drive_id)
    frames: dict[int, list[dict[str, object]]] = {index: [] for index in range(start, min(stop, drive.frame_count))}
    if labelling is not None:
        found = label_repository.labelled_frames(session, labelling.id, start, stop)
        frames |= _by_frame(session, labelling, found)
    return to_json({"revision": drive.revision, "frames": _listed(frames)})


def observations_of_tracks(session: Session, labelling: LabellingRow, track_ids: Iterable[int]) -> list[dict[str, Any]]:
    """The values of :class:`app.tracks.schemas.FrameObservations` of all frames in which some tracks are, of these
    tracks only."""
    ids = sorted(track_ids)
    frames: dict[int, list[dict[str, object]]] = {}
    for first in range(0, len(ids), repository.IDS_PER_QUERY):
        some = label_repository.labelled_tracks(session, labelling.id, ids[first : first + repository.IDS_PER_QUERY])
        for frame_index, observations in _by_frame(session, labelling, some).items():
            frames.setdefault(frame_index, []).extend(observations)
    return _listed(frames)


def _by_frame(session: Session, labelling: LabellingRow, found: LabelledFrames) -> dict[int, list[dict[str, object]]]:
    cameras = repository.camera_names(session, labelling.drive_id)
    frames: dict[int, list[dict[str, object]]] = {}
    for row in found.observations:
        frames.setdefault(row.frame_index, []).append(_observation(row, found, cameras, labelling.class_names))
    return frames


def _listed(frames: dict[int, list[dict[str, object]]]) -> list[dict[str, Any]]:
    return [{"frame_index": index, "observations": found} for index, found in frames.items()]


def tracks_json(session: Session, drive_id: int) -> bytes:
    """:class:`app.tracks.schemas.Track` of every track in order of id, as JSON; none before the drive is labelled."""
    if drives_repository.find(session, drive_id) is None:
        raise NotFound(f"There is no drive {drive_id}. It may have been deleted.")
    labelling = repository.current_labelling(session, drive_id)
    if labelling is None:
        return to_json([])
    return to_json(track_values(session, labelling, repository.track_facts(session, labelling.id)))


def track_values(
    session: Session, labelling: LabellingRow, tracks: Iterable[TrackRow | TrackFacts]
) -> list[dict[str, Any]]:
    """The values of :class:`app.tracks.schemas.Track` of some tracks, in their order."""
    cameras = repository.camera_names(session, labelling.drive_id)
    names = labelling.class_names
    return [
        {
            "id": row.track_id,
            "camera": cameras[row.camera_id],
            "first_frame": row.first_frame,
            "last_frame": row.last_frame,
            "observation_count": row.observation_count,
            "identity_id": row.identity_id,
            "best_score": row.best_score,
            "best_frame": row.best_frame,
            "class_name": names[row.class_id],
        }
        for row in tracks
    ]


def score_runs_json(session: Session, drive_id: int) -> bytes:
    """:class:`app.tracks.schemas.ScoreRuns` of all tracks as JSON; none before the drive is labelled."""
    drive = drives_repository.find(session, drive_id)
    if drive is None:
        raise NotFound(f"There is no drive {drive_id}. It may have been deleted.")
    labelling = repository.current_labelling(session, drive_id)
    rows = [] if labelling is None else repository.scores_by_track(session, labelling.id)
    columns = np.array(rows, np.float64).reshape(-1, 3)
    score = np.where(columns[:, 2] < 0, np.nan, columns[:, 2])
    runs = score_runs(columns[:, 0].astype(np.int64), columns[:, 1].astype(np.int64), score)
    return to_json({"revision": drive.revision, "runs": runs})


def _observation(
    row: LabelledObservation, found: LabelledFrames, cameras: dict[int, str], names: list[str]
) -> dict[str, object]:
    track = found.tracks[row.track_id]
    source = found.donors[row.donor_track_id, row.donor_frame_index]
    donor = None
    if source.id != row.id:
        donor = {
            "observation_id": source.id,
            "camera": cameras[source.camera_id],
            "frame_index": row.donor_frame_index,
            "score": source.score,
        }
    return {
        "id": row.id,
        "track_id": row.track_id,
        "identity_id": track.identity_id,
        "camera": cameras[track.camera_id],
        "box": (row.x1_px, row.y1_px, row.x2_px, row.y2_px),
        "class_name": names[row.class_id],
        "score": row.score,
        "filled": bool(row.filled),
        "trust": None if row.trust is None else round(row.trust, TRUST_DIGITS),
        "label": {
            "class_name": names[row.label_class_id],
            "score": row.label_score,
            "source": row.label_source,
            "donor": donor,
            "withheld": row.withheld,
            "probability": row.probability,
        },
    }
