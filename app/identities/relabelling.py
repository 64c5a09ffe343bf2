"""The labels of an identity after its tracks have changed: what the labeler's own propagation makes of them.

The store's observations are given to the same two passes that the pipeline runs, with the settings of the labelling, so
that an identity has the same labels whether a person or the machine put its tracks together.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.db.session import Session
from app.drives import repository as drives_repository
from app.edits import repository as edits_repository
from app.edits.types import Effect
from app.tracks import label_repository
from app.tracks import repository as tracks_repository
from app.tracks.label_repository import LABEL_COLUMNS, BoxAndLabel
from app.tracks.label_values import label_values
from app.tracks.models import LabellingRow
from labeler.propagation import Donor, PropagationConfig, collect_votes, donor_of, label_observations
from labeler.tracking.types import NO_DETECTION, Observations

PROBABILITY = LABEL_COLUMNS.index("probability")
"""Last of the columns. A label that is only a little more or less likely right counts as the same label."""
BEFORE_IT_WAS_KEPT = PropagationConfig(min_trust=0.0)
"""How labels were given by labellings that don't say."""


@dataclass(frozen=True)
class Relabelled:
    """The donor of an identity, None where no observation has a score, and how many labels changed.

    ``changed_tracks`` are the tracks of all labels that were written anew."""

    donor: Donor | None
    changed_count: int
    changed_tracks: frozenset[int]


def propagation_of(labelling: LabellingRow) -> PropagationConfig:
    """The settings by which the labels of a labelling were given."""
    kept = labelling.propagation
    return BEFORE_IT_WAS_KEPT if kept is None else PropagationConfig(**kept)


class Relabelling:
    """Labels the identities of one labelling anew."""

    def __init__(self, session: Session, labelling_id: int, *, also_rejected: Sequence[Effect] = ()) -> None:
        """``also_rejected`` are boxes that may give their label to no other, beside those that people rejected."""
        self._session = session
        self._also_rejected = also_rejected
        self._labelling_id = labelling_id
        self._labelling = tracks_repository.find_labelling(session, labelling_id)
        self._config = propagation_of(self._labelling)

    @cached_property
    def _rejected(self) -> dict[int, list[Effect]]:
        """What may not give its label, by track as tracked."""
        rejected: dict[int, list[Effect]] = {}
        for effect in [*edits_repository.no_donors(self._session, self._labelling_id), *self._also_rejected]:
            rejected.setdefault(effect.place.tracked_id, []).append(effect)
        return rejected

    @cached_property
    def _timestamp_ns(self) -> NDArray[np.int64]:
        return np.array(drives_repository.frame_times_ns(self._session, self._labelling.drive_id), np.int64)

    @cached_property
    def _camera_names(self) -> dict[int, str]:
        return tracks_repository.camera_names(self._session, self._labelling.drive_id)

    def donor(self, track_ids: Sequence[int]) -> Donor | None:
        """The donor that an identity of these tracks has; no label is changed."""
        boxes = label_repository.boxes_of_tracks(self._session, self._labelling_id, track_ids)
        return self._donor_and_values(track_ids, boxes)[0]

    def relabel(self, track_ids: Sequence[int]) -> Relabelled:
        """Give the boxes of an identity that no person drew the labels that its tracks make."""
        boxes = label_repository.boxes_of_tracks(self._session, self._labelling_id, track_ids)
        donor, values = self._donor_and_values(track_ids, boxes)
        changed = [
            (box.track_id, box.frame_index, label)
            for box, label in zip(boxes, values, strict=True)
            if box.label != label
        ]
        label_repository.change_labels(self._session, self._labelling_id, changed)
        given = {(box.track_id, box.frame_index): box.label[:PROBABILITY] for box in boxes}
        count = sum(given[track, frame] != label[:PROBABILITY] for track, frame, label in changed)
        return Relabelled(donor, count, frozenset(track for track, _, _ in changed))

    def _donor_and_values(
        self, track_ids: Sequence[int], boxes: Sequence[BoxAndLabel]
    ) -> tuple[Donor | None, list[tuple[Any, ...]]]:
        if not boxes:
            return None, []
        identity = min(track_ids)
        identity_of = dict.fromkeys(track_ids, identity)
        observations = _observations(boxes)
        camera_id = np.array([box.camera_id for box in boxes])
        voting = replace(observations, score=np.where(self._is_rejected(boxes), np.nan, observations.score))
        batches = [(self._camera_names[one], voting[camera_id == one]) for one in np.unique(camera_id).tolist()]
        votes = collect_votes(batches, identity_of, config=self._config, timestamp_ns=self._timestamp_ns)
        labels = label_observations(
            observations, identity_of, votes, config=self._config, timestamp_ns=self._timestamp_ns
        )
        values = label_values(labels)
        rows = list(zip(*(values[name] for name in LABEL_COLUMNS), strict=True))
        return donor_of(votes[identity], self._config), rows

    def _is_rejected(self, boxes: Sequence[BoxAndLabel]) -> NDArray[np.bool_]:
        """(N,) whether each box may give its label to no other."""
        if not self._rejected:
            return np.zeros(len(boxes), np.bool_)
        tracks = tracks_repository.tracks_with(self._session, self._labelling_id, {box.track_id for box in boxes})
        rejected = {track.track_id: self._rejected.get(track.tracked_id, ()) for track in tracks}
        return np.array([any(one.reaches(box.frame_index) for one in rejected[box.track_id]) for box in boxes])


def _observations(boxes: Sequence[BoxAndLabel]) -> Observations:
    return Observations(
        track_id=np.array([box.track_id for box in boxes], np.int32),
        frame_index=np.array([box.frame_index for box in boxes], np.int32),
        xyxy_px=np.array([(box.x1_px, box.y1_px, box.x2_px, box.y2_px) for box in boxes], np.float32),
        score=np.array([np.nan if box.score is None else box.score for box in boxes], np.float32),
        class_id=np.array([box.class_id for box in boxes], np.int16),
        detection_index=np.array([NO_DETECTION if box.filled else row for row, box in enumerate(boxes)], np.int32),
        trust=np.array([1.0 if box.trust is None else box.trust for box in boxes], np.float32),
    )
