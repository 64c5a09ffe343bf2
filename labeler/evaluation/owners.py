"""Whose tracks are they? Which true object each track of a detector's boxes shows, where that is clear."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from labeler.drive.types import TruthBoxes2D
from labeler.evaluation.merges import count_true_objects
from labeler.tracking.types import Observations

_MIN_IOU = 0.3
_CLEAR_SHARE = 0.7
_OWN_SHARE = 0.5
_STRAY_SHARE = 0.2


def objects_of_tracks(truth: TruthBoxes2D, observations: Mapping[str, Sequence[Observations]]) -> dict[int, str | None]:
    """The true object of each track, None where it shows none; tracks of which that is not clear are missing.

    A box shows the true object that it overlaps by an IoU of at least 0.3. A track shows the one that at least half of
    its boxes show, and 70 % of those that show any; it shows none where less than a fifth of its boxes do.
    ``observations`` are those of each camera, in parts of whole frames."""
    object_of: dict[int, str | None] = {}
    for camera, parts in observations.items():
        boxes: Counter[int] = Counter()
        for part in parts:
            boxes.update(part.track_id.tolist())
        counts = count_true_objects(truth, camera, parts, min_iou=_MIN_IOU)
        for track, of_track in boxes.items():
            of_object = counts.get(track, Counter[str]())
            owner, count = next(iter(of_object.most_common(1)), (None, 0))
            if of_object.total() < _STRAY_SHARE * of_track:
                object_of[track] = None
            elif count >= max(_OWN_SHARE * of_track, _CLEAR_SHARE * of_object.total()):
                object_of[track] = owner
    return object_of


def true_identities(object_of: Mapping[int, str | None]) -> dict[int, int]:
    """The identity of each track that shows a true object, were all tracks of one object merged and no others."""
    first: dict[str, int] = {}
    shown = {track: name for track, name in sorted(object_of.items()) if name is not None}
    return {track: first.setdefault(name, track) for track, name in shown.items()}
