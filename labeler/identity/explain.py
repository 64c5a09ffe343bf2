"""A merge for a person: what speaks for it as a sentence, as numbers, and as a plot from above."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.se3 import invert_se3, yaw_of
from labeler.identity.features import Candidate
from labeler.identity.rig import Rig
from labeler.identity.together import BestFrame, mean_bev_iou
from labeler.identity.tracks import TrackBook, TrackRecord
from labeler.identity.types import (
    Feature,
    MergeEvidence,
    MergePlot,
    MergeProposal,
    MergeState,
    SharedFrame,
)

_PLOT_NODES = 24
_PLOT_AROUND_S = 3.0
_CENTIMETRES, _MILLIRADIANS = 2, 3


class Explainer:
    """Makes proposals of candidates."""

    def __init__(self, tracks: TrackBook, camera_names: Sequence[str], rig: Rig) -> None:
        self._tracks = tracks
        self._camera_names = camera_names
        self._rig = rig

    def proposal(
        self,
        candidate: Candidate,
        *,
        score: float,
        state: MergeState,
        features: tuple[Feature, ...],
        bias: float,
        blocked_by: tuple[int, int] | None,
    ) -> MergeProposal:
        """The claim with its evidence. ``blocked_by`` are two tracks that forbid it."""
        a, b = self._tracks.records[candidate.track_a], self._tracks.records[candidate.track_b]
        together = candidate.together
        best = [] if together is None else together.best
        shared = tuple(frame.shared() for frame in best)
        agreeing = 0 if together is None else together.agreeing_frames
        mean_distance_m = None
        if together is not None and agreeing:
            mean_distance_m = together.agreeing_distance_sum_m / agreeing
        return MergeProposal(
            track_a=a.track_id,
            camera_a=self._camera_names[a.camera],
            track_b=b.track_id,
            camera_b=self._camera_names[b.camera],
            score=score,
            state=state,
            shared_frames=0 if together is None else together.near_frames + candidate.apart_frames,
            agreeing_frames=agreeing,
            mean_distance_m=mean_distance_m,
            mean_bev_iou=mean_bev_iou(shared) if agreeing else None,
            best_frames=shared,
            reason=self._reason(candidate, a, b, state, blocked_by),
            evidence=MergeEvidence(
                kind=candidate.kind,
                calibrated=True,
                gap_s=round(candidate.gap_s, 3),
                gap_frames=candidate.gap_frames,
                features=features,
                bias_log_odds=round(bias, 4),
                plot=self._plot(candidate, a, b, best, shared),
            ),
        )

    def _reason(
        self,
        candidate: Candidate,
        a: TrackRecord,
        b: TrackRecord,
        state: MergeState,
        blocked_by: tuple[int, int] | None,
    ) -> str:
        if candidate.together is not None:
            together = candidate.together
            seen = together.near_frames + candidate.apart_frames
            text = f"at the same place in {together.agreeing_frames} of {seen} shared frames"
        else:
            first = a if candidate.gap_frames and candidate.gap_frames[0] == _end_frame(a) else b
            where = self._camera_names[first.camera]
            again = self._camera_names[(b if first is a else a).camera]
            seen_again = f"seen again in {again}" if again != where else "seen again there"
            text = f"lost in {where} and {seen_again} {candidate.gap_s:.1f} s later, where it could be by then"
        if state is MergeState.PROPOSED:
            return f"{text}; too unsure to merge without a person"
        if state is MergeState.REJECTED and blocked_by is not None:
            one, other = (self._tracks.records[track] for track in blocked_by)
            if one.camera == other.camera:
                clash = f"share a frame of {self._camera_names[one.camera]}"
            else:
                clash = "were seen at different places at the same time, or a person told them apart"
            return f"{text}, but tracks {one.track_id} and {other.track_id} would be one with them, and these {clash}"
        return text

    def _plot(
        self,
        candidate: Candidate,
        a: TrackRecord,
        b: TrackRecord,
        best: Sequence[BestFrame],
        shared: Sequence[SharedFrame],
    ) -> MergePlot | None:
        poses = self._rig.city_SE3_ego
        if best:
            reference = shared[0].frame_index
        elif candidate.gap_frames is not None:
            reference = candidate.gap_frames[0]
        else:
            return None
        if poses is None:
            poses = np.tile(np.eye(4), (len(self._rig.timestamp_ns), 1, 1))
        reference_SE3_city = invert_se3(poses[reference])
        around = [frame.frame_index for frame in best] or list(candidate.gap_frames or ())
        first_s = self._rig.seconds(min(around)) - _PLOT_AROUND_S
        last_s = self._rig.seconds(max(around)) + _PLOT_AROUND_S
        times_s = (self._rig.timestamp_ns - self._rig.timestamp_ns[0]) / 1e9
        driven = _thinned(np.flatnonzero((times_s >= first_s) & (times_s <= last_s)))
        moved = reference_SE3_city @ poses[driven]
        ego_m = moved[:, :2, 3].round(_CENTIMETRES).tolist()
        ego_rad = np.arctan2(moved[:, 1, 0], moved[:, 0, 0]).round(_MILLIRADIANS).tolist()
        ego = [(frame, *xy_m, yaw) for frame, xy_m, yaw in zip(driven.tolist(), ego_m, ego_rad, strict=True)]
        return MergePlot(
            reference_frame=reference,
            ego=tuple(ego),
            track_a=_path(a, reference_SE3_city, first_s, last_s),
            track_b=_path(b, reference_SE3_city, first_s, last_s),
            boxes_a=_boxes([(frame.frame_index, frame.box_a) for frame in best], reference_SE3_city, poses),
            boxes_b=_boxes([(frame.frame_index, frame.box_b) for frame in best], reference_SE3_city, poses),
        )


def _boxes(
    boxes: Sequence[tuple[int, NDArray[np.float64]]],
    reference_SE3_city: NDArray[np.float64],
    poses: NDArray[np.float64],
) -> tuple[tuple[float, ...], ...]:
    """Boxes of some frames, each in the ego frame of its own, moved into the reference frame."""
    moved: list[tuple[float, ...]] = []
    for frame, box in sorted(boxes, key=lambda one: one[0]):
        if np.isfinite(box).all():
            pose = reference_SE3_city @ poses[frame]
            xy_m = (pose[:3, :3] @ box[:3] + pose[:3, 3])[:2]
            yaw_rad = float(box[6]) + yaw_of(pose)
            moved.append((frame, *_rounded([*xy_m, *box[3:5]], _CENTIMETRES), round(yaw_rad, _MILLIRADIANS)))
    return tuple(moved)


def _path(
    record: TrackRecord, reference_SE3_city: NDArray[np.float64], first_s: float, last_s: float
) -> tuple[tuple[float, ...], ...]:
    """The nodes of a trajectory within a time, or its nearest ones where there are none, in the reference frame."""
    nodes = record.nodes
    inside = np.flatnonzero((nodes[:, 1] >= first_s) & (nodes[:, 1] <= last_s))
    if not len(inside) and len(nodes):
        inside = np.array([int(np.abs(nodes[:, 1] - (first_s + last_s) / 2).argmin())])
    rows = _thinned(inside)
    # The height hardly matters seen from above; that of the recording car keeps a tilted one from shifting places.
    height_m = -float(reference_SE3_city[:3, 2] @ reference_SE3_city[:3, 3])
    city_m = np.column_stack([nodes[rows, 2:4], np.full(len(rows), height_m)])
    xy_m = (city_m @ reference_SE3_city[:3, :3].T + reference_SE3_city[:3, 3])[:, :2]
    rounded = np.column_stack([xy_m, nodes[rows, 6]]).round(_CENTIMETRES).tolist()
    return tuple((frame, *row) for frame, row in zip(nodes[rows, 0].astype(int).tolist(), rounded, strict=True))


def _thinned(rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Evenly spread, at most _PLOT_NODES."""
    if len(rows) <= _PLOT_NODES:
        return rows
    return rows[np.linspace(0, len(rows) - 1, _PLOT_NODES).round().astype(int)]


def _rounded(values: Iterable[float], digits: int) -> list[float]:
    return [round(float(value), digits) for value in values]


def _end_frame(record: TrackRecord) -> int | None:
    return None if record.end is None else record.end.frame_index
