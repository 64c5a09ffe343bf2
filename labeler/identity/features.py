"""What is measured about a pair of tracks: the numbers that its probability is made of.

There are three kinds of pairs, each with its own features: two cameras at the same time, two cameras one after the
other, and one camera one after the other. A feature that can't be measured is NaN, and says nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.se3 import invert_se3, transform_points
from labeler.identity.colours import likeness
from labeler.identity.config import IdentityConfig
from labeler.identity.rig import Rig
from labeler.identity.rivals import densities, over_rivals
from labeler.identity.smoothing import predict
from labeler.identity.together import PairBook, Together, pairs_worth_a_look
from labeler.identity.tracks import TrackBook, TrackRecord
from labeler.identity.types import MergeKind

OVERLAP_FEATURES: tuple[tuple[str, str], ...] = (
    ("distance_sigmas", "sigma"),
    ("distance_m", "m"),
    ("agreeing_share", "share"),
    ("rival_share", "share"),
    ("outside_box", "half box"),
    ("uncertainty_m", "m"),
    ("shared_looks", "looks"),
    ("apart_share", "share"),
    ("velocity_difference_mps", "m/s"),
    ("size_difference", "ratio"),
    ("class_agreement", "share"),
    ("colour_likeness", "share"),
    ("shorter_track_s", "s"),
    ("weaker_score", "score"),
)
GAP_FEATURES: tuple[tuple[str, str], ...] = (
    ("gap_distance_sigmas", "sigma"),
    ("gap_distance_m", "m"),
    ("velocity_sigmas", "sigma"),
    ("gap_s", "s"),
    ("uncertainty_m", "m"),
    ("still_distance_m", "m"),
    ("place_density", "nat"),
    ("rival_density", "nat"),
    ("expected_in_image", "share"),
    ("leaves_image", "share"),
    ("size_difference", "ratio"),
    ("class_agreement", "share"),
    ("colour_likeness", "share"),
    ("shorter_track_s", "s"),
    ("weaker_score", "score"),
)
FEATURES = {
    MergeKind.OVERLAP: OVERLAP_FEATURES,
    MergeKind.HANDOVER: GAP_FEATURES,
    MergeKind.FRAGMENT: GAP_FEATURES,
}
"""Name and unit of each feature, by the kind of the pair."""

_LOOK_S = 0.4
_CAPPED_SIGMAS = 7.0
_GATE_SIGMAS = 6.0
_STILL_MPS = 1.0
_STILL_REACH_M = 5.0
_LEAST_DENSITY = -12.0
_GATE_M, _GATE_MPS = 4.0, 5.0
_OVERLAPPING_ENDS_S = 0.3
_MIDDLE_M = 0.8
_NEAREST_M = 1.0


@dataclass(frozen=True, eq=False)
class Candidate:
    """A pair of tracks worth a decision, ``track_a`` < ``track_b``. ``values`` (K,) float64 are its features in the
    order of FEATURES; ``together`` is there for a pair seen at the same time, ``apart_frames`` in how many frames it
    was far apart; ``gap_s`` and ``gap_frames`` for one seen one after the other."""

    track_a: int
    track_b: int
    kind: MergeKind
    values: NDArray[np.float64]
    together: Together | None = None
    apart_frames: int = 0
    gap_s: float = 0.0
    gap_frames: tuple[int, int] | None = None


def overlap_candidates(pairs: PairBook, tracks: TrackBook, rig: Rig) -> list[Candidate]:
    """The pairs that were near each other in at least one frame."""
    found: list[Candidate] = []
    for (track_a, track_b), together, apart in pairs_worth_a_look(pairs):
        a, b = tracks.records[track_a], tracks.records[track_b]
        n = together.near_frames
        span_s = rig.seconds(together.last_frame) - rig.seconds(together.first_frame)
        values = (
            math.sqrt(together.sigmas2_sum / n / 2),
            together.distance_sum_m / n,
            together.agreeing_frames / n,
            1 - together.nearest_frames / n,
            together.outside_sum / n,
            math.exp(together.log_uncertainty_sum / n),
            min(float(n), 1 + span_s / _LOOK_S),
            apart / (apart + n),
            _velocity_difference(a, b, (rig.seconds(together.first_frame) + rig.seconds(together.last_frame)) / 2),
            *_of_both(a, b, rig),
        )
        found.append(Candidate(track_a, track_b, MergeKind.OVERLAP, np.array(values), together, apart))
    return found


def gap_candidates(
    tracks: TrackBook,
    rig: Rig,
    config: IdentityConfig,
    *,
    camera_names: Sequence[str],
    impossible: Callable[[int, int], bool],
    exclude: Callable[[int, int], bool],
) -> list[Candidate]:
    """The pairs of which one ends and the other begins at a place where the first could be by then.

    ``impossible`` says of two tracks that they were seen at the same time, ``exclude`` that they are two objects."""
    records = [record for record in tracks.records.values() if record.begin is not None and record.end is not None]
    if len(records) < 2:
        return []
    ends = _Ends.of(records, last=True)
    begins = _Ends.of(records, last=False)
    first, second = _near_enough(ends, begins, records, config)
    possible = [
        not impossible(records[int(i)].track_id, records[int(j)].track_id)
        for i, j in zip(first.tolist(), second.tolist(), strict=True)
    ]
    keep = np.flatnonzero(np.array(possible, np.bool_))
    first, second = first[keep], second[keep]
    if not len(first):
        return []
    gap_s = begins.time_s[second] - ends.time_s[first]
    half_s = gap_s / 2
    ahead, ahead_cov = predict(ends.mean[first], ends.cov[first], half_s, config.motion)
    back, back_cov = predict(begins.mean[second], begins.cov[second], -half_s, config.motion)
    off, cov = ahead - back, ahead_cov + back_cov
    sigmas = _sigmas(off[:, :2], cov[:, :2, :2])
    speed_sigmas = _sigmas(off[:, 2:], cov[:, 2:, 2:])
    still_m = _still_distances(ends, begins, first, second)
    in_gate = (sigmas < _GATE_SIGMAS) | (still_m < _STILL_REACH_M)
    determinant_m4 = np.maximum(np.linalg.det(cov[:, :2, :2]), 1e-12)
    uncertainty_m = np.power(determinant_m4, 0.25)
    density = densities(sigmas, determinant_m4, still_m)
    rival = over_rivals(density, first, second, [record.track_id for record in records], exclude)
    camera = np.array([record.camera for record in records])
    sees_begin = _sees(rig, camera_names, camera[first], begins.frame_index[second], begins.mean[second, :2])
    sees_end = _sees(rig, camera_names, camera[second], ends.frame_index[first], ends.mean[first, :2])
    expected = (sees_begin + sees_end) / 2
    found: dict[tuple[int, int], Candidate] = {}
    # Of two short tracks each may seem to come first: the longer gap is the last, and holds.
    for row in sorted(np.flatnonzero(in_gate).tolist(), key=lambda row: float(gap_s[row])):
        a, b = records[int(first[row])], records[int(second[row])]
        assert a.end is not None
        assert b.begin is not None
        values = (
            min(sigmas[row], _CAPPED_SIGMAS),
            float(np.hypot(off[row, 0], off[row, 1])),
            min(speed_sigmas[row], _CAPPED_SIGMAS),
            max(gap_s[row], 0.0),
            uncertainty_m[row],
            still_m[row],
            max(density[row], _LEAST_DENSITY),
            rival[row],
            expected[row],
            (a.end.edge + b.begin.edge) / 2,
            *_of_both(a, b, rig),
        )
        kind = MergeKind.FRAGMENT if a.camera == b.camera else MergeKind.HANDOVER
        small, large = sorted((a.track_id, b.track_id))
        gap_frames = (a.end.frame_index, b.begin.frame_index)
        found[small, large] = Candidate(
            small, large, kind, np.array(values), gap_s=float(max(gap_s[row], 0)), gap_frames=gap_frames
        )
    return list(found.values())


@dataclass(frozen=True, eq=False)
class _Ends:
    """One end of each record: ``frame_index`` (N,), ``time_s`` (N,), ``mean`` (N, 4), ``cov`` (N, 4, 4)."""

    frame_index: NDArray[np.intp]
    time_s: NDArray[np.float64]
    mean: NDArray[np.float64]
    cov: NDArray[np.float64]

    @staticmethod
    def of(records: Sequence[TrackRecord], *, last: bool) -> _Ends:
        ends = [record.end if last else record.begin for record in records]
        known = [end for end in ends if end is not None]
        return _Ends(
            np.array([end.frame_index for end in known], np.intp),
            np.array([end.time_s for end in known]),
            np.stack([end.mean for end in known]),
            np.stack([end.cov for end in known]),
        )

    @property
    def speed_mps(self) -> NDArray[np.float64]:
        return np.hypot(self.mean[:, 2], self.mean[:, 3])


def _near_enough(
    ends: _Ends, begins: _Ends, records: Sequence[TrackRecord], config: IdentityConfig
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """(P,) rows of records that end and (P,) rows of those that could go on from there: a cheap first choice."""
    group = np.array([record.group for record in records])
    order = np.argsort(begins.time_s, kind="stable")
    starts = begins.time_s[order]
    low = np.searchsorted(starts, ends.time_s - _OVERLAPPING_ENDS_S)
    high = np.searchsorted(starts, ends.time_s + config.max_still_gap_s, side="right")
    still_end, still_begin = ends.speed_mps < _STILL_MPS, begins.speed_mps < _STILL_MPS
    firsts: list[NDArray[np.intp]] = []
    seconds: list[NDArray[np.intp]] = []
    for row in range(len(records)):
        later = order[low[row] : high[row]]
        later = later[(group[later] == group[row]) & (later != row)]
        gap_s = begins.time_s[later] - ends.time_s[row]
        way = begins.mean[later, :2] - ends.mean[row, :2]
        mean_speed = (ends.mean[row, 2:] + begins.mean[later, 2:]) / 2
        # The speed of a short track is hardly known: then its own uncertainty opens the gate.
        slack = np.sqrt((ends.cov[row, 2, 2] + begins.cov[later, 2, 2]) / 2) * np.abs(gap_s)
        off_m = np.linalg.norm(way - mean_speed * gap_s[:, None], axis=1)
        moving = (gap_s <= config.max_gap_s) & (off_m < _GATE_M + _GATE_MPS * np.abs(gap_s) + slack)
        still = still_end[row] & still_begin[later] & (np.linalg.norm(way, axis=1) < _STILL_REACH_M)
        chosen = later[moving | still]
        firsts.append(np.full(len(chosen), row))
        seconds.append(chosen)
    return np.concatenate(firsts), np.concatenate(seconds)


def _sigmas(off: NDArray[np.float64], cov: NDArray[np.float64]) -> NDArray[np.float64]:
    """(P,) distance over its uncertainty, in standard deviations of one dimension."""
    if not len(off):
        return np.zeros(0)
    solved = np.linalg.solve(cov, off[..., None])[..., 0]
    return np.sqrt(np.maximum((off * solved).sum(axis=1), 0) / 2)


def _still_distances(
    ends: _Ends, begins: _Ends, first: NDArray[np.intp], second: NDArray[np.intp]
) -> NDArray[np.float64]:
    """(P,) how far apart the ends are of two that stand; NaN where one moves."""
    distance_m = np.linalg.norm(ends.mean[first, :2] - begins.mean[second, :2], axis=1)
    still = (ends.speed_mps[first] < _STILL_MPS) & (begins.speed_mps[second] < _STILL_MPS)
    return np.where(still, distance_m, np.nan)


def _velocity_difference(a: TrackRecord, b: TrackRecord, time_s: float) -> float:
    """Metres a second between two smoothed velocities at one time, NaN where one is not known."""
    if len(a.nodes) < 2 or len(b.nodes) < 2:
        return math.nan
    speeds = [[float(np.interp(time_s, one.nodes[:, 1], one.nodes[:, axis])) for axis in (4, 5)] for one in (a, b)]
    return math.dist(speeds[0], speeds[1])


def _of_both(a: TrackRecord, b: TrackRecord, rig: Rig) -> tuple[float, float, float, float, float]:
    """Size difference, class agreement, likeness of colours, seconds of the shorter track, score of the weaker one."""
    size_a, size_b = a.size_m, b.size_m
    difference = math.nan
    if size_a is not None and size_b is not None:
        difference = float(np.abs(np.log(size_a / size_b)).mean())
    shorter_s = min(rig.seconds(one.last_frame) - rig.seconds(one.first_frame) for one in (a, b))
    alike = likeness(a.colours, b.colours)
    return difference, a.class_agreement(b), alike, shorter_s, min(a.mean_score, b.mean_score)


def _sees(
    rig: Rig,
    camera_names: Sequence[str],
    camera: NDArray[np.intp],
    frame_index: NDArray[np.intp],
    xy_m: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(P,) 1 where a camera would see a place ``xy_m`` (P, 2) of the city frame at the time of a frame, as far as its
    image reaches, else 0. ``camera`` (P,) are numbers of names."""
    sees = np.zeros(len(camera))
    if rig.city_SE3_ego is None:
        return sees
    city_SE3_ego = rig.city_SE3_ego[frame_index]
    middle_m = np.column_stack([xy_m, city_SE3_ego[:, 2, 3] + _MIDDLE_M]) - city_SE3_ego[:, :3, 3]
    ego_m = np.einsum("nji,nj->ni", city_SE3_ego[:, :3, :3], middle_m)
    numbers: list[int] = np.unique(camera).tolist()
    for number in numbers:
        seen_by = rig.cameras.get(camera_names[number])
        if seen_by is None or seen_by.calibration is None:
            continue
        rows = np.flatnonzero(camera == number)
        x_m, _, depth_m = transform_points(invert_se3(seen_by.calibration.ego_SE3_camera), ego_m[rows]).T
        focal_px, middle_px = seen_by.calibration.intrinsics[0, [0, 2]]
        x_px = focal_px * x_m / np.maximum(depth_m, _NEAREST_M) + middle_px
        sees[rows] = (depth_m >= _NEAREST_M) & (x_px >= 0) & (x_px <= seen_by.width_px)
    return sees
