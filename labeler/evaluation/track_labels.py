"""The labels that tracks have where cameras are not merged: by the settings of the run, from their own observations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from labeler.evaluation.types import EvaluatedLabels, LabelRows
from labeler.propagation import collect_votes, label_observations
from labeler.tracking.types import NO_DETECTION, Observations

_TRUSTED = 0.5
"""Whom to trust was decided when labels were given: here a box is trusted wholly or not at all."""


class TrackLabels:
    """Labels as propagation gives them under other identities than the run's: by default every track is its own."""

    def __init__(self, source: EvaluatedLabels, identity_of: Mapping[int, int] = MappingProxyType({})) -> None:
        """Reads all labels of ``source`` once. A track that ``identity_of`` lacks is its own identity."""
        self._identity_of = identity_of
        self._config = replace(source.propagation, min_trust=_TRUSTED)
        self._timestamp_ns = source.timestamp_ns if self._config.window_s else None  # else no time is asked for
        self._votes = collect_votes(_parts(source), identity_of, config=self._config, timestamp_ns=self._timestamp_ns)

    def of(self, part: LabelRows) -> tuple[NDArray[np.int16], NDArray[np.float32]]:
        """(N,) class id and (N,) score of each row's label; of the row itself where its label is withheld."""
        labels = label_observations(
            observations_of(part), self._identity_of, self._votes, config=self._config, timestamp_ns=self._timestamp_ns
        )
        return labels.class_id, labels.score


def _parts(source: EvaluatedLabels) -> Iterator[tuple[str, Observations]]:
    for part in source.open_labels():
        yield "", observations_of(part)


def observations_of(part: LabelRows) -> Observations:
    """The observations of a part as far as labels follow from them; of withheld ones it is known that nobody trusts
    them."""
    own = part.own
    return Observations(
        track_id=part.track_id,
        frame_index=own.frame_index,
        xyxy_px=own.xyxy_px,
        score=own.score,
        class_id=own.class_id,
        detection_index=np.full(len(own), NO_DETECTION, np.int32),
        trust=np.where(part.withheld, 0.0, 1.0).astype(np.float32),
    )
