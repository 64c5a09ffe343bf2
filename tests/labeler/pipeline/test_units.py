"""What the units say of tracks."""

import math
from pathlib import Path

import numpy as np
import pytest

from labeler.pipeline.tables import columns_of, write_table
from labeler.pipeline.units import summarise_tracks
from labeler.tracking import Observations
from labeler.tracking.types import NO_DETECTION


@pytest.mark.parametrize(
    ("scores", "best_score", "best_frame"),
    [
        ([0.5, 0.9, 0.7], 0.9, 1),
        ([0.9, math.nan, 0.5], 0.9, 0),  # a box that was filled in says nothing about the best one
        ([math.nan, 0.5, 0.4], 0.5, 1),
        ([0.9, 0.9], 0.9, 0),  # of equals the first
        ([math.nan, math.nan], math.nan, 0),
    ],
)
def test_a_track_is_as_good_as_its_best_box(
    tmp_path: Path, scores: list[float], best_score: float, best_frame: int
) -> None:
    count = len(scores)
    observations = Observations(
        track_id=np.full(count, 7, np.int32),
        frame_index=np.arange(count, dtype=np.int32),
        xyxy_px=np.tile(np.array([[0, 0, 10, 10]], np.float32), (count, 1)),
        score=np.array(scores, np.float32),
        class_id=np.arange(count, dtype=np.int16),
        detection_index=np.full(count, NO_DETECTION, np.int32),
    )
    write_table(tmp_path / "tracks", [columns_of(observations)])

    (summary,) = summarise_tracks("front", tmp_path / "tracks")

    assert summary.best_score == pytest.approx(best_score, nan_ok=True)
    assert (summary.best_frame, summary.class_id) == (best_frame, best_frame)
    assert (summary.first_frame, summary.last_frame, summary.observation_count) == (0, count - 1, count)
