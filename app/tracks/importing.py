"""Taking a result of the pipeline into the store.

Rows go in by the batch, in short transactions, under a labelling that nobody sees yet. The last transaction adds merges
and identities, lets people's earlier decisions hold, and makes the labelling the current one: readers see the old
result, then the new one, never a mixture. What was replaced is deleted afterwards, in short transactions as well.
"""

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
from app.tracks.label_values import label_values, scores_of
from app.tracks.models import Box3DRow, LabellingRow, LabelRow, ObservationRow, TrackRow
from labeler.errors import HindsightError
from labeler.identity.types import MergeProposal
from labeler.pipeline.types import LabelledDrive, LabelledView, Progress, SilentProgress
from labeler.propagation.probability import PIXEL_DIGITS
from labeler.propagation.votes import SCORE_DIGITS
from labeler.tracking.types import NO_DETECTION

ROWS_PER_TRANSACTION = 10_000
TRACKS_PER_DELETION = 500
METRE_DIGITS = 4
STAGE = "store"

Columns = Mapping[str, Sequence[Any]]


@dataclass
class _Waiting:
    """Rows that wait for the next transaction, column by column."""

    tables: dict[type[Base], dict[str, list[Any]]] = field(default_factory=dict[type[Base], dict[str, list[Any]]])
    observations: int = 0

    def add(self, table: type[Base], columns: Columns) -> None:
        waiting = self.tables.setdefault(table, {name: [] for name in columns})
        for name, values in columns.items():
            waiting[name] += values

    def write(self, session: Session) -> None:
        for table, columns in self.tables.items():
            repository.insert_columns(session, table, columns)
        self.tables.clear()
        self.observations = 0


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
        repository.make_current(
            session,
            labelling_id,
            drive_id=drive_id,
            observation_count=observation_count,
            since_revision=drives_repository.raise_revision(session, drive_id),
        )
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
                propagation=asdict(labelled.propagation),
            ),
        )
        if labelled.tracks:
            repository.insert_columns(session, TrackRow, _track_columns(labelling_id, labelled, cameras))
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
    waiting = _Waiting()
    done = 0
    progress.stage(STAGE, frame_count)
    for frame in labelled.frames():
        if frame.frame_index >= frame_count:
            raise HindsightError(
                f"The labels go beyond frame {frame_count - 1}, the last when the drive was registered. Its folder has "
                "changed since: delete the drive here and register it again."
            )
        for camera, view in frame.views.items():
            count = len(view.observations)
            observation_count += count
            waiting.observations += count
            propagated.update(view.labels.identity_id[view.labels.propagated].tolist())
            waiting.add(ObservationRow, _observation_columns(labelling_id, view))
            waiting.add(LabelRow, _label_columns(labelling_id, view))
            if len(view.boxes_3d):
                waiting.add(Box3DRow, _box_columns(labelling_id, frame.frame_index, cameras[camera], view))
        if waiting.observations >= ROWS_PER_TRANSACTION:
            with store.write() as session:
                waiting.write(session)
        progress.advance(frame.frame_index + 1 - done)
        done = frame.frame_index + 1
    with store.write() as session:
        waiting.write(session)
    return propagated, observation_count


def _write_merges_and_identities(
    session: Session, labelling_id: int, labelled: LabelledDrive, propagated: Mapping[int, int]
) -> None:
    best_frames = {track.track_id: track.best_frame for track in labelled.tracks}
    merges_repository.insert_merges(
        session,
        [
            {
                "labelling_id": labelling_id,
                "track_a": merge.track_a,
                "track_b": merge.track_b,
                "tracked_a": merge.track_a,
                "tracked_b": merge.track_b,
                "frame_a": _frame_of(merge, best_frames[merge.track_a]),
                "frame_b": _frame_of(merge, best_frames[merge.track_b]),
                "score": round(merge.score, SCORE_DIGITS),
                "machine_state": str(merge.state),
                "state": str(merge.state),
                "decided_by": "machine",
                "shared_frames": merge.shared_frames,
                "agreeing_frames": merge.agreeing_frames,
                "mean_distance_m": merge.mean_distance_m,
                "mean_bev_iou": merge.mean_bev_iou,
                "reason": merge.reason,
                "best_frames": [asdict(frame) for frame in merge.best_frames],
                "evidence": asdict(merge.evidence),
            }
            for merge in labelled.merges
        ],
    )
    members: dict[int, list[TrackRow]] = {}
    for track in repository.tracks_of(session, labelling_id):
        members.setdefault(track.identity_id, []).append(track)
    identities = [
        identity_values(
            labelling_id,
            identity_id,
            tracks,
            donor=labelled.donors.get(identity_id),
            propagated_count=propagated.get(identity_id, 0),
        )
        for identity_id, tracks in members.items()
    ]
    identities_repository.replace(session, labelling_id, (), identities)


def _frame_of(merge: MergeProposal, best_frame: int) -> int:
    """The frame that says which piece of a track a merge is about: that of its best evidence, where it names one."""
    return merge.best_frames[0].frame_index if merge.best_frames else best_frame


def _track_columns(labelling_id: int, labelled: LabelledDrive, cameras: Mapping[str, int]) -> Columns:
    tracks = labelled.tracks
    return {
        "labelling_id": [labelling_id] * len(tracks),
        "track_id": [track.track_id for track in tracks],
        "tracked_id": [track.track_id for track in tracks],
        "camera_id": [cameras[track.camera] for track in tracks],
        "first_frame": [track.first_frame for track in tracks],
        "last_frame": [track.last_frame for track in tracks],
        "observation_count": [track.observation_count for track in tracks],
        "best_score": [round(track.best_score, SCORE_DIGITS) for track in tracks],
        "best_frame": [track.best_frame for track in tracks],
        "class_id": [track.class_id for track in tracks],
        "identity_id": [labelled.identity_of.get(track.track_id, track.track_id) for track in tracks],
    }


def _observation_columns(labelling_id: int, view: LabelledView) -> Columns:
    observations = view.observations
    return {
        "labelling_id": [labelling_id] * len(observations),
        "track_id": observations.track_id.tolist(),
        "tracked_id": observations.track_id.tolist(),
        "drawn": [False] * len(observations),
        "frame_index": observations.frame_index.tolist(),
        "score": scores_of(observations.score),
        "class_id": observations.class_id.tolist(),
        "filled": (observations.detection_index == NO_DETECTION).tolist(),
        "trust": observations.trust.astype(np.float64).tolist(),
        **_decimals(observations.xyxy_px, ("x1_px", "y1_px", "x2_px", "y2_px"), digits=PIXEL_DIGITS),
    }


def _label_columns(labelling_id: int, view: LabelledView) -> Columns:
    labels = view.labels
    return {
        "labelling_id": [labelling_id] * len(labels),
        "track_id": labels.track_id.tolist(),
        "frame_index": labels.frame_index.tolist(),
        **label_values(labels),
    }


def _box_columns(labelling_id: int, frame_index: int, camera_id: int, view: LabelledView) -> Columns:
    boxes = view.boxes_3d
    count = len(boxes)
    track_id = [track if track >= 0 else None for track in view.track_of_boxes_3d().tolist()]
    return {
        "labelling_id": [labelling_id] * count,
        "frame_index": [frame_index] * count,
        "camera_id": [camera_id] * count,
        "row": list(range(count)),
        "track_id": track_id,
        "tracked_id": track_id,
        "score": scores_of(boxes.score),
        "class_id": boxes.class_id.tolist(),
        "point_count": boxes.num_points.tolist(),
        "yaw_rad": boxes.yaw_rad.astype(np.float64).tolist(),
        **_decimals(boxes.center_m, ("center_x_m", "center_y_m", "center_z_m"), digits=METRE_DIGITS),
        **_decimals(boxes.size_m, ("length_m", "width_m", "height_m"), digits=METRE_DIGITS),
    }


def _decimals(values: NDArray[np.float32], names: Sequence[str], *, digits: int) -> dict[str, list[float]]:
    """Columns of an (N, len(names)) array, rounded in double precision: 0.1 stays 0.1, and JSON short."""
    rounded = np.round(values.astype(np.float64), digits)
    return {name: rounded[:, column].tolist() for column, name in enumerate(names)}


def _lost_decisions(count: int) -> str:
    what = "1 earlier decision" if count == 1 else f"{count} earlier decisions"
    return f"{what} about merges could not be placed in the new labels. They are kept for the next time."
