"""What perfect merging would give: the same tracks, and the labels that follow were all tracks of one object merged.

The truth takes the place of the identity step alone. What is lost in detection and tracking stays lost, so the
multi-camera row of such labels is the ceiling for merging.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from labeler.drive.types import TruthBoxes2D
from labeler.evaluation.owners import objects_of_tracks, true_identities
from labeler.evaluation.track_labels import TrackLabels, observations_of
from labeler.evaluation.types import EvaluatedLabels, LabelRows
from labeler.propagation.votes import identities_of
from labeler.tracking.types import Observations


def with_true_identities(source: EvaluatedLabels, truth: TruthBoxes2D) -> EvaluatedLabels:
    """The labels of a drive were its tracks merged by the truth. Reads all labels of ``source`` twice."""
    identity_of = true_identities(objects_of_tracks(truth, _by_camera(source)))
    labels = TrackLabels(source, identity_of)

    def open_labels() -> Iterator[LabelRows]:
        for part in source.open_labels():
            class_id, score = labels.of(part)
            identity_id = identities_of(part.track_id, identity_of)
            yield replace(part, identity_id=identity_id, label_class_id=class_id, label_score=score)

    return replace(source, open_labels=open_labels)


def _by_camera(source: EvaluatedLabels) -> dict[str, list[Observations]]:
    found: dict[str, list[Observations]] = {camera: [] for camera in source.cameras}
    for part in source.open_labels():
        observations = observations_of(part)
        for number, camera in enumerate(source.cameras):
            found[camera].append(observations[np.flatnonzero(part.own.camera == number)])
    return found
