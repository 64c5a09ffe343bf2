"""Do the merges across cameras agree with the truth?

Each track is taken for the true object that most of its boxes match. A vehicle that stands in two or more cameras is
found when tracks of it in two cameras share an identity. An identity that holds tracks of different true objects is a
wrong merge.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from labeler.drive.types import TruthBoxes2D
from labeler.geometry.boxes_2d import iou_matrix
from labeler.tracking.types import Observations

_NOT_VEHICLES = (
    "person",
    "pedestrian",
    "human",
    "cyclist",
    "rider",
    "bicycl",
    "animal",
    "dog",
    "stroller",
    "wheelchair",
)
MIN_VISIBLE_PIXELS = 30
"""Truth that shows fewer pixels than these, where that is recorded, is not seen: a box is of whatever hides it."""

_NOT_OBJECTS = ("dontcare", "cone", "barrier", "sign", "bollard", "debris", "pushable", "rack")


@dataclass(frozen=True)
class MergeScore:
    """How many vehicles that stand in two or more cameras were found.

    ``vehicles`` = ``found`` + ``missed``; ``not_tracked`` of those missed have no tracks in two cameras that could have
    been merged. ``wrong_merges`` counts identities with tracks of different true objects, of any class."""

    vehicles: int
    found: int
    missed: int
    not_tracked: int
    wrong_merges: int

    def sentence(self) -> str:
        """The score in words, for a terminal."""
        missed = f"{self.missed} missed"
        if self.not_tracked:
            missed += f" ({self.not_tracked} of them not tracked in two cameras)"
        return (
            f"Of {self.vehicles} vehicles that stand in two or more cameras {self.found} were found, {missed}; "
            f"{self.wrong_merges} wrongly merged."
        )


def is_vehicle(category: str) -> bool:
    """Whether a category, as a drive format names it, is a vehicle: neither a person (on a cycle or not), nor an animal
    or a fixed object.
    """
    name = category.lower().replace(" ", "").replace("_", "")
    return not any(word in name for word in (*_NOT_VEHICLES, *_NOT_OBJECTS))


def score_merges(
    truth: TruthBoxes2D,
    observations: Mapping[str, Iterable[Observations]],
    identity_of: Mapping[int, int],
    *,
    min_iou: float = 0.5,
) -> MergeScore:
    """Compare identities with the truth of a drive.

    ``observations`` are those of each camera, in parts that are read once and not kept; every part holds whole frames.
    ``identity_of`` gives the identity of every track; a track that it lacks is its own. A box matches the truth of
    whole objects at an IoU of at least ``min_iou``, one to one.
    """
    uuid_of_track, camera_of_track = _true_object_of_tracks(truth, observations, min_iou)
    tracks_of_identity: dict[int, list[int]] = {}
    cameras_of_uuid: dict[str, set[str]] = {}
    for track, uuid in uuid_of_track.items():
        tracks_of_identity.setdefault(identity_of.get(track, track), []).append(track)
        cameras_of_uuid.setdefault(uuid, set()).add(camera_of_track[track])
    found: set[str] = set()
    wrong_merges = 0
    for tracks in tracks_of_identity.values():
        cameras: dict[str, set[str]] = {}
        for track in tracks:
            cameras.setdefault(uuid_of_track[track], set()).add(camera_of_track[track])
        wrong_merges += len(cameras) > 1
        found.update(uuid for uuid, names in cameras.items() if len(names) > 1)
    vehicles = _vehicles_in_two_cameras(truth)
    missed = vehicles - found
    return MergeScore(
        vehicles=len(vehicles),
        found=len(vehicles & found),
        missed=len(missed),
        not_tracked=sum(len(cameras_of_uuid.get(uuid, ())) < 2 for uuid in missed),
        wrong_merges=wrong_merges,
    )


def _vehicles_in_two_cameras(truth: TruthBoxes2D) -> set[str]:
    cameras: dict[str, set[str]] = {}
    for row in _seen_rows(truth):
        if is_vehicle(truth.category[row]):
            cameras.setdefault(truth.track_uuid[row], set()).add(truth.camera[row])
    return {uuid for uuid, names in cameras.items() if len(names) > 1}


def _true_object_of_tracks(
    truth: TruthBoxes2D, observations: Mapping[str, Iterable[Observations]], min_iou: float
) -> tuple[dict[int, str], dict[int, str]]:
    """The true object and the camera of every track that matches one at all."""
    uuid_of_track: dict[int, str] = {}
    camera_of_track: dict[int, str] = {}
    for camera, parts in observations.items():
        for track, of_uuid in count_true_objects(truth, camera, parts, min_iou=min_iou).items():
            uuid_of_track[track] = min(of_uuid, key=lambda uuid: (-of_uuid[uuid], uuid))
            camera_of_track[track] = camera
    return uuid_of_track, camera_of_track


def count_true_objects(
    truth: TruthBoxes2D, camera: str, parts: Iterable[Observations], *, min_iou: float
) -> dict[int, Counter[str]]:
    """How many boxes of each track of a camera match which true object that is seen; tracks that match none are
    missing. Every part holds whole frames."""
    rows_of: dict[int, list[int]] = {}
    for row in _seen_rows(truth):
        if truth.camera[row] == camera:
            rows_of.setdefault(int(truth.frame_index[row]), []).append(row)
    counts: dict[int, Counter[str]] = {}
    for part in parts:
        for frame_index in np.unique(part.frame_index).tolist():
            here = part[part.frame_index == frame_index]
            rows = rows_of.get(frame_index, [])
            for observation, row in _match(here.xyxy_px, truth.xyxy_px[rows], min_iou):
                track = int(here.track_id[observation])
                counts.setdefault(track, Counter())[truth.track_uuid[rows[row]]] += 1
    return counts


def _seen_rows(truth: TruthBoxes2D) -> list[int]:
    """The rows of truth that enough pixels show, all where that is not recorded."""
    if truth.visible_pixels is None:
        return list(range(len(truth.camera)))
    return np.flatnonzero(truth.visible_pixels >= MIN_VISIBLE_PIXELS).tolist()


def _match(boxes_px: NDArray[np.float32], truth_px: NDArray[np.float32], min_iou: float) -> list[tuple[int, int]]:
    """(box, truth) pairs with an IoU of at least ``min_iou``, one to one, with the largest sum of IoU."""
    iou = iou_matrix(boxes_px, truth_px)
    iou = np.where(iou >= min_iou, iou, 0.0)
    boxes, truths = linear_sum_assignment(-iou)
    return [(int(box), int(row)) for box, row in zip(boxes, truths, strict=True) if iou[box, row] > 0]
