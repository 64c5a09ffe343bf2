"""Observations from short rows."""

from collections.abc import Sequence

import numpy as np

from labeler.tracking import Observations

Row = tuple[int, int, float, int]  # track, frame, score, class
CAR, TRUCK = 2, 7


def observations(rows: Sequence[Row]) -> Observations:
    table = np.array(rows, np.float64).reshape(-1, 4)
    return Observations(
        track_id=table[:, 0].astype(np.int32),
        frame_index=table[:, 1].astype(np.int32),
        xyxy_px=np.zeros((len(table), 4), np.float32),
        score=table[:, 2].astype(np.float32),
        class_id=table[:, 3].astype(np.int16),
        detection_index=np.arange(len(table), dtype=np.int32),
    )
