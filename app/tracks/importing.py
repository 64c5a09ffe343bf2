"""Taking a result of the pipeline into the store.

Rows go in by the batch, in short transactions, under a labelling that nobody sees yet. The last transaction adds merges
and identities, lets people's earlier decisions hold, and makes the labelling the current one: readers see the old
result, then the new one, never a mixture. What was replaced is deleted afterwards, in short transactions as well.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.db.base import Base
from app.db.session import Session, Store
from app.drives import repository as drives_repository
from app.identities import repository as identities_repository
from app.identities.linking import identity_values
from app.merges import repository as merges_repository
from app.reviews.carrying import carry_over
from app.tracks import repository
from app.tracks.models import Box3DRow, LabellingRow, LabelRow, ObservationRow, TrackRow
from labeler.errors import HindsightError
from labeler.pipeline.types import LabelledDrive, LabelledView, Progress, SilentProgress, TrackSummary
from labeler.propagation.types import LabelSource
from labeler.tracking.types import NO_DETECTION

ROWS_PER_TRANSACTION = 10_000
TRACKS_PER_DELETION = 500
STAGE = "store"

Row = Mapping[str, Any]


@dataclass
class _Rows:
    """Rows that wait for the next transaction."""

    observations: list[Row] = field(default_factory=list[Row])
    labels: list[Row] = field(default_factory=list[Row])
    boxes_3d: list[Row] = field(default_factory=list[Row])

    def write(self, session: Session) -> None:
        tables: tuple[tuple[type[Base], list[Row]], ...] = (
            (ObservationRow, self.observations),
            (LabelRow, self.labels),
            (Box3DRow, self.boxes_3d),
        )
        for table, rows in tables:
            repository.insert_rows(session, table, rows)
            rows.clear()


def import_labelled_drive(
    store: Store,
    drive_id: int,
    labelled: LabelledDrive,
    *,
    model_name: str,
    progress: Progress | None = None,
) -> bool:
    """Make ``labelled`` the drive's current labelling; False when it is that already.

    Raises HindsightError when it does not belong to the drive, and Cancelled when ``progress`` says so; in both cases
    the labelling before stays current.
    """
    with store.read() as session:
        drive = drives_repository.find(session, drive_id)
        if drive is None:
            raise HindsightError(f"Drive {drive_id} was deleted while it was being labelled.")
        current = repository.current_labelling(session, drive_id)
        if current is not None and current.key == labelled.key:
            return False
        cameras = {name: camera_id for camera_id, name in repository.camera_names(session, drive_id).items()}
        frame_count = drive.frame_count
    _require_known_cameras(labelled, cameras)
    remove_replaced(store, drive_id)
    labelling_id = _begin(store, drive_id, labelled, cameras, model_name)
    propagated, observation_count = _write_frames(
        store, labelling_id, labelled, cameras, frame_count, progress or SilentProgress()
    )
    with store.write() as session:
        _write_merges_and_identities(session, labelling_id, labelled, propagated)
        carried = carry_over(session, drive_id, labelling_id)
        if carried.lost:
            labelling = repository.find_labelling(session, labelling_id)
            labelling.warnings = [*labelling.warnings, _lost_decisions(carried.lost)]
        repository.make_current(session, labelling_id, drive_id=drive_id, observation_count=observation_count)
        drives_repository.raise_revision(session, drive_id)
    remove_replaced(store, drive_id)
    return True


def remove_replaced(store: Store, drive_id: int) -> None:
    """Delete labellings of the drive that nobody sees, a few tracks at a time."""
    with store.read() as session:
        labelling_ids = repository.replaced_labellings(session, drive_id)
    for labelling_id in labelling_ids:
        more = True
        while more:
            with store.write() as session:
                more = repository.delete_some_tracks(session, labelling_id, at_most=TRACKS_PER_DELETION)
        with store.write() as session:
            repository.delete_labelling(session, labelling_id)


def _require_known_cameras(labelled: LabelledDrive, cameras: Mapping[str, int]) -> None:
    unknown = sorted({track.camera for track in labelled.tracks} - cameras.keys())
    if unknown:
        raise HindsightError(
            f"The labels name cameras that the drive had not when it was registered: {', '.join(unknown)}. Delete the "
            "drive here and register it again."
        )


def _begin(store: Store, drive_id: int, labelled: LabelledDrive, cameras: Mapping[str, int], model_name: str) -> int:
    """Add the labelling, unseen, with its tracks."""
    with store.write() as session:
        labelling_id = repository.insert_labelling(
            session,
            LabellingRow(
                drive_id=drive_id,
                key=labelled.key,
                model_name=model_name,
                class_names=list(labelled.class_names),
                summary=dict(labelled.summary),
                warnings=list(labelled.summary["warnings"]),
            ),
        )
        rows = [
            {
                "labelling_id": labelling_id,
                "camera_id": cameras[track.camera],
                "identity_id": labelled.identity_of.get(track.track_id, track.track_id),
                **_track_columns(track),
            }
            for track in labelled.tracks
        ]
        repository.insert_rows(session, TrackRow, rows)
    return labelling_id


def _write_frames(
    store: Store,
    labelling_id: int,
    labelled: LabelledDrive,
    cameras: Mapping[str, int],
    frame_count: int,
    progress: Progress,
) -> tuple[Counter[int], int]:
    """Stream observations, labels and 3D boxes in; propagated labels by identity, and the number of observations."""
    propagated: Counter[int] = Counter()
    observation_count = 0
    rows = _Rows()
    done = 0
    progress.stage(STAGE, frame_count)
    for frame in labelled.frames():
        for camera, view in frame.views.items():
            observation_count += len(view.observations)
            propagated.update(view.labels.identity_id[view.labels.propagated].tolist())
            rows.observations += _observation_rows(labelling_id, view)
            rows.labels += _label_rows(labelling_id, view)
            rows.boxes_3d += _box_rows(labelling_id, frame.frame_index, cameras[camera], view)
        if len(rows.observations) >= ROWS_PER_TRANSACTION:
            with store.write() as session:
                rows.write(session)
        progress.advance(frame.frame_index + 1 - done)
        done = frame.frame_index + 1
    with store.write() as session:
        rows.write(session)
    return propagated, observation_count


def _write_merges_and_identities(
    session: Session, labelling_id: int, labelled: LabelledDrive, propagated: Mapping[int, int]
) -> None:
    merges_repository.insert_merges(
        session,
        [
            {
                "labelling_id": labelling_id,
                "track_a": merge.track_a,
                "track_b": merge.track_b,
                "score": round(merge.score, 6),
                "machine_state": str(merge.state),
                "state": str(merge.state),
                "decided_by": "machine",
                "shared_frames": merge.shared_frames,
                "agreeing_frames": merge.agreeing_frames,
                "mean_distance_m": merge.mean_distance_m,
                "mean_bev_iou": merge.mean_bev_iou,
                "reason": merge.reason,
                "best_frames": [asdict(frame) for frame in merge.best_frames],
            }
            for merge in labelled.merges
        ],
    )
    members: dict[int, list[TrackRow]] = {}
    for track in repository.tracks_of(session, labelling_id):
        members.setdefault(track.identity_id, []).append(track)
    identities = [
        identity_values(labelling_id, identity_id, tracks, propagated_count=propagated.get(identity_id, 0))
        for identity_id, tracks in members.items()
    ]
    identities_repository.replace(session, labelling_id, (), identities)


def _track_columns(track: TrackSummary) -> Row:
    return {
        "track_id": track.track_id,
        "first_frame": track.first_frame,
        "last_frame": track.last_frame,
        "observation_count": track.observation_count,
        "best_score": round(track.best_score, 6),
        "best_frame": track.best_frame,
        "class_id": track.class_id,
    }


def _observation_rows(labelling_id: int, view: LabelledView) -> list[Row]:
    observations = view.observations
    columns = {
        "track_id": observations.track_id.tolist(),
        "frame_index": observations.frame_index.tolist(),
        "score": _scores(observations.score),
        "class_id": observations.class_id.tolist(),
        "filled": (observations.detection_index == NO_DETECTION).tolist(),
        **_decimals(observations.xyxy_px, ("x1_px", "y1_px", "x2_px", "y2_px"), digits=2),
    }
    return _to_rows(columns, labelling_id=labelling_id)


def _label_rows(labelling_id: int, view: LabelledView) -> list[Row]:
    labels = view.labels
    columns = {
        "track_id": labels.track_id.tolist(),
        "frame_index": labels.frame_index.tolist(),
        "class_id": labels.class_id.tolist(),
        "score": _scores(labels.score),
        "source": [LabelSource.PROPAGATED if given else LabelSource.AUTO for given in labels.propagated.tolist()],
        "donor_track_id": labels.donor_track_id.tolist(),
        "donor_frame_index": labels.donor_frame_index.tolist(),
    }
    return _to_rows(columns, labelling_id=labelling_id)


def _box_rows(labelling_id: int, frame_index: int, camera_id: int, view: LabelledView) -> list[Row]:
    boxes = view.boxes_3d
    tracks = view.track_of_boxes_3d().tolist()
    columns = {
        "row": list(range(len(boxes))),
        "track_id": [track if track >= 0 else None for track in tracks],
        "score": _scores(boxes.score),
        "class_id": boxes.class_id.tolist(),
        "point_count": boxes.num_points.tolist(),
        "yaw_rad": boxes.yaw_rad.astype(np.float64).tolist(),
        **_decimals(boxes.center_m, ("center_x_m", "center_y_m", "center_z_m"), digits=4),
        **_decimals(boxes.size_m, ("length_m", "width_m", "height_m"), digits=4),
    }
    return _to_rows(columns, labelling_id=labelling_id, frame_index=frame_index, camera_id=camera_id)


def _to_rows(columns: Mapping[str, Sequence[Any]], **same: int) -> list[Row]:
    names = (*same, *columns)
    fixed = tuple(same.values())
    return [dict(zip(names, (*fixed, *values), strict=True)) for values in zip(*columns.values(), strict=True)]


def _decimals(values: NDArray[np.float32], names: Sequence[str], *, digits: int) -> dict[str, list[float]]:
    """Columns of an (N, len(names)) array, rounded in double precision: 0.1 stays 0.1, and JSON short."""
    rounded = np.round(values.astype(np.float64), digits)
    return {name: rounded[:, column].tolist() for column, name in enumerate(names)}


def _scores(scores: NDArray[np.float32]) -> list[float | None]:
    """Scores as the store keeps them: to six digits, None where there is none."""
    rounded: list[float] = np.round(scores.astype(np.float64), 6).tolist()
    return [None if math.isnan(score) else score for score in rounded]


def _lost_decisions(count: int) -> str:
    what = "1 earlier decision" if count == 1 else f"{count} earlier decisions"
    return f"{what} about merges could not be placed in the new labels. They are kept for the next time."
