"""What is trusted too little keeps its own label, with the reason."""

import numpy as np

from labeler.propagation import PropagationConfig, Withheld, collect_votes, label_observations
from labeler.tracking import NO_DETECTION, Observations

ROWS = Observations(
    track_id=np.array([1, 1, 1, 2], np.int32),
    frame_index=np.array([0, 1, 2, 2], np.int32),
    xyxy_px=np.tile(np.array([0, 0, 10, 10], np.float32), (4, 1)),
    score=np.array([0.9, 0.4, np.nan, 0.5], np.float32),
    class_id=np.array([2, 7, 2, 2], np.int16),
    detection_index=np.array([0, 0, NO_DETECTION, 0], np.int32),
    trust=np.array([1.0, 0.1, 0.1, 0.1], np.float32),
)


def test_doubtful_boxes_keep_their_own_label() -> None:
    labels = label_observations(ROWS, {}, collect_votes([("front", ROWS)], {}), config=PropagationConfig(min_trust=0.2))
    assert labels.withheld.tolist() == [Withheld.NO, *[Withheld.DOUBTFUL_BOX] * 3]
    np.testing.assert_array_equal(labels.score, ROWS.score)
    assert labels.class_id.tolist() == [2, 7, 2, 2]
    assert labels.donor_frame_index.tolist() == [0, 1, 2, 2]
    assert not labels.propagated.any()


def test_the_papers_rule_keeps_none_back() -> None:
    labels = label_observations(ROWS, {}, collect_votes([("front", ROWS)], {}), config=PropagationConfig(min_trust=0.0))
    assert labels.withheld.tolist() == [Withheld.NO] * 4
    np.testing.assert_array_equal(labels.score, np.array([0.9, 0.9, 0.9, 0.5], np.float32))
    assert labels.propagated.tolist() == [False, True, True, False]


def test_left_out_trust_is_full() -> None:
    rows = Observations(ROWS.track_id, ROWS.frame_index, ROWS.xyxy_px, ROWS.score, ROWS.class_id, ROWS.detection_index)
    assert rows.trust.tolist() == [1.0] * 4
