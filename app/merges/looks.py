"""What there is to see of a merge: looks at both tracks, each at its best and both at the same moment, and their ways.

Two tracks that never share a frame are shown where the one ends and the other begins.
"""

from collections.abc import Mapping, Sequence
from typing import TypeVar

import numpy as np

from app.db.session import Session
from app.merges.models import MergeRow
from app.merges.schemas import Look, MergeLooks, MergeSide, Moment, Way
from app.merges.service import require_current, tracks_of_merge
from app.motion.paths import BoxPath, PathFrame, paths_of_tracks
from app.motion.repository import EgoAt, ego_between
from app.tracks import repository as tracks_repository
from app.tracks.models import TrackRow
from app.tracks.repository import Sighting

MOMENTS = 3
LOOKS_PER_CAMERA = 14
POINTS_PER_WAY = 400

T = TypeVar("T")
Sightings = Mapping[int, Mapping[int, Sighting]]
"""Observations by track and frame."""


def looks_of_merge(session: Session, merge_id: int) -> MergeLooks:
    """The looks at a merge of the current labelling; NotFound."""
    merge = require_current(session, merge_id)
    labelling_id = merge.labelling_id
    track_a, track_b = tracks_of_merge(merge)
    labelling = tracks_repository.find_labelling(session, labelling_id)
    tracks = tracks_repository.tracks_of_same_identities(session, labelling_id, (track_a, track_b))
    by_id = {track.track_id: track for track in tracks}
    cameras = tracks_repository.camera_names(session, labelling.drive_id)
    seen: dict[int, dict[int, Sighting]] = {track_id: {} for track_id in by_id}
    for row in tracks_repository.sightings_of_tracks(session, labelling_id, by_id):
        seen[row.track_id][row.frame_index] = row
    paths = paths_of_tracks(session, labelling.drive_id, labelling_id, (track_a, track_b))
    looks = _Looks(by_id, seen, cameras, labelling.class_names)
    ego = ego_between(session, labelling.drive_id, *_span(by_id[track_a], by_id[track_b]))
    return MergeLooks(
        merge_id=merge.id,
        frame=next((path.frame for path in paths.values()), PathFrame.EGO),
        sides=(
            looks.side(track_a, paths.get(track_a)),
            looks.side(track_b, paths.get(track_b)),
        ),
        moments=_moments(merge, looks, paths),
        strip=looks.strip(),
        ego=_ego_way(ego),
        plot=merge.evidence.get("plot"),
    )


class _Looks:
    """Cut-outs of the tracks of one or two identities."""

    def __init__(
        self,
        tracks: Mapping[int, TrackRow],
        seen: Sightings,
        cameras: Mapping[int, str],
        class_names: Sequence[str],
    ) -> None:
        self._tracks = tracks
        self._seen = seen
        self._cameras = cameras
        self._class_names = class_names

    def at(self, track_id: int, frame_index: int) -> Look:
        """The look at a track in a frame, in which it must have been seen."""
        track, row = self._tracks[track_id], self._seen[track_id][frame_index]
        return Look(
            track_id=track_id,
            identity_id=track.identity_id,
            camera=self._cameras[track.camera_id],
            frame_index=frame_index,
            box=(row.x1_px, row.y1_px, row.x2_px, row.y2_px),
            class_name=self._class_names[row.class_id],
            score=row.score,
        )

    def frames(self, track_id: int) -> list[int]:
        return sorted(self._seen[track_id])

    def has(self, track_id: int, frame_index: int) -> bool:
        return frame_index in self._seen[track_id]

    def side(self, track_id: int, path: BoxPath | None) -> MergeSide:
        track = self._tracks[track_id]
        return MergeSide(
            track_id=track_id,
            identity_id=track.identity_id,
            camera=self._cameras[track.camera_id],
            class_name=self._class_names[track.class_id],
            first_frame=track.first_frame,
            last_frame=track.last_frame,
            best=self.at(track_id, track.best_frame),
            way=_way(path),
        )

    def strip(self) -> list[Look]:
        """Looks of every track in order of time, spread evenly, a few for each camera."""
        by_camera: dict[int, list[tuple[int, int]]] = {}
        for track_id, frames in self._seen.items():
            by_camera.setdefault(self._tracks[track_id].camera_id, []).extend((frame, track_id) for frame in frames)
        chosen = [place for places in by_camera.values() for place in _spread(sorted(places), LOOKS_PER_CAMERA)]
        return [self.at(track_id, frame) for frame, track_id in sorted(chosen)]


def _moments(merge: MergeRow, looks: _Looks, paths: Mapping[int, BoxPath]) -> list[Moment]:
    """Both tracks at the same time: where that speaks most for the merge, else where they come closest in time."""
    a, b = merge.tracks
    best = [int(frame["frame_index"]) for frame in merge.best_frames]
    frames = [(frame, frame) for frame in best if looks.has(a, frame) and looks.has(b, frame)]
    if not frames:
        shared = sorted(set(looks.frames(a)) & set(looks.frames(b)))
        frames = [(frame, frame) for frame in _spread(shared, MOMENTS)] or [_closest(looks.frames(a), looks.frames(b))]
    return [
        Moment(
            looks=(looks.at(a, frame_a), looks.at(b, frame_b)),
            distance_m=_distance_m(paths.get(a), frame_a, paths.get(b), frame_b),
        )
        for frame_a, frame_b in frames[:MOMENTS]
    ]


def _closest(frames_a: Sequence[int], frames_b: Sequence[int]) -> tuple[int, int]:
    """The frame of each list that is nearest in time to one of the other; the lists are sorted and not empty."""
    a, b = np.array(frames_a), np.array(frames_b)
    right = np.clip(np.searchsorted(b, a), 0, len(b) - 1)
    left = np.maximum(right - 1, 0)
    nearest = np.where(np.abs(b[left] - a) <= np.abs(b[right] - a), left, right)
    row = int(np.argmin(np.abs(b[nearest] - a)))
    return int(a[row]), int(b[nearest[row]])


def _distance_m(path_a: BoxPath | None, frame_a: int, path_b: BoxPath | None, frame_b: int) -> float | None:
    """How far apart two tracks are at their frames; None where one has no 3D box there."""
    if path_a is None or path_b is None:
        return None
    row_a, row_b = np.flatnonzero(path_a.frame_index == frame_a), np.flatnonzero(path_b.frame_index == frame_b)
    if not len(row_a) or not len(row_b):
        return None
    return round(float(np.hypot(*(path_a.xy_m[row_a[0]] - path_b.xy_m[row_b[0]]))), 2)


def _spread(values: Sequence[T], count: int) -> list[T]:
    """At most so many of the values, evenly, the first and the last among them."""
    if len(values) <= count:
        return list(values)
    return [values[round(row)] for row in np.linspace(0, len(values) - 1, count)]


def _span(a: TrackRow, b: TrackRow) -> tuple[int, int]:
    return min(a.first_frame, b.first_frame), max(a.last_frame, b.last_frame)


def _way(path: BoxPath | None) -> Way:
    if path is None:
        return Way()
    path = path[np.unique(np.linspace(0, len(path) - 1, min(len(path), POINTS_PER_WAY)).round().astype(np.intp))]
    return Way(
        frame_index=path.frame_index.tolist(),
        x_m=path.xy_m[:, 0].round(2).tolist(),
        y_m=path.xy_m[:, 1].round(2).tolist(),
        yaw_rad=path.yaw_rad.round(3).tolist(),
        length_m=path.size_m[:, 0].round(2).tolist(),
        width_m=path.size_m[:, 1].round(2).tolist(),
    )


def _ego_way(places: Sequence[EgoAt]) -> Way:
    chosen = _spread(places, POINTS_PER_WAY)
    return Way(
        frame_index=[place.frame_index for place in chosen],
        x_m=[round(place.x_m, 2) for place in chosen],
        y_m=[round(place.y_m, 2) for place in chosen],
        yaw_rad=[round(place.yaw_rad, 3) for place in chosen],
    )
