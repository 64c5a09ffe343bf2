"""Pairs of tracks and detections, by hand."""

import numpy as np
import pytest

from labeler.tracking.association import associate


def boxes(*rows: tuple[float, float, float, float]) -> np.ndarray:
    return np.array(rows, np.float64).reshape(-1, 4)


@pytest.mark.parametrize(
    ("tracks", "detections", "track_group", "detection_group", "min_iou", "expected"),
    [
        # both tracks overlap detection 0 (IoU 1 and 1/3); together 0-0 and 1-1 (IoU 1/3) overlap more than 1-0 alone
        (
            boxes((0, 0, 10, 10), (5, 0, 15, 10)),
            boxes((0, 0, 10, 10), (10, 0, 20, 10)),
            [0, 0],
            [0, 0],
            0.1,
            {0: 0, 1: 1},
        ),
        # greedy would pair 1-0 (IoU 9/11 = .82) and leave the rest; 0-0 and 1-1 (7/13 + 5/15 = .87) are more in total
        (
            boxes((0, 0, 10, 10), (4, 0, 14, 10)),
            boxes((3, 0, 13, 10), (9, 0, 19, 10)),
            [0, 0],
            [0, 0],
            0.1,
            {0: 0, 1: 1},
        ),
        # the same box, but another group
        (boxes((0, 0, 10, 10)), boxes((0, 0, 10, 10)), [0], [1], 0.1, {}),
        # IoU is exactly 1/3: 50 of 150
        (boxes((0, 0, 10, 10)), boxes((5, 0, 15, 10)), [0], [0], 0.34, {}),
        (boxes((0, 0, 10, 10)), boxes((5, 0, 15, 10)), [0], [0], 0.33, {0: 0}),
        # nothing on one side
        (boxes(), boxes((0, 0, 10, 10)), [], [0], 0.1, {}),
        (boxes((0, 0, 10, 10)), boxes(), [0], [], 0.1, {}),
    ],
)
def test_pairs(
    tracks: np.ndarray,
    detections: np.ndarray,
    track_group: list[int],
    detection_group: list[int],
    min_iou: float,
    expected: dict[int, int],
) -> None:
    rows, columns = associate(
        tracks,
        detections,
        track_group=np.array(track_group, np.int64),
        detection_group=np.array(detection_group, np.int64),
        min_iou=min_iou,
    )
    assert dict(zip(rows.tolist(), columns.tolist(), strict=True)) == expected
