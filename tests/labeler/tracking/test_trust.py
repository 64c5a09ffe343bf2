"""Features worked out by hand, and what the model makes of them."""

import numpy as np
import pytest

from labeler.geometry.boxes_2d import area, intersection_matrix
from labeler.tracking import pairing
from labeler.tracking.trust import FEATURES, JudgedBoxes, features_of, trust_of


def test_features_by_hand() -> None:
    """Track 0: two boxes of e to 1 and one filled in, 0.2 s later; track 1 covers half of its last box."""
    width = 10 * np.e
    boxes = JudgedBoxes(
        track=np.array([0, 0, 0, 1]),
        frame=np.array([0, 1, 2, 2]),
        time_s=np.array([0.0, 0.2, 0.4, 0.4]),
        score=np.array([0.8, 0.4, np.nan, 0.5]),
        on_path=np.array([1.0, 0.5, 0.0, 0.9]),
        xyxy_px=np.array([[0, 0, width, 10]] * 3 + [[width / 2, 0, width / 2 + 10, 20]]),
    )
    found = dict(zip(FEATURES, features_of(boxes).T.tolist(), strict=True))
    expected = {
        "relative_score": [1, 0.5, 0, 1],
        "filled": [0, 0, 1, 0],
        "on_path": [1, 0.5, 0, 0.9],
        "since_sure": [0, np.log(3), np.log(5), 0],  # 0.2 s and 0.4 s from the first
        "length": [np.log(1.4)] * 3 + [0],
        "covered": [0, 0, 10 / width, 0.5],  # 10 of its width; of the other, the upper half
        "narrow": [0, 0, 0, np.log(2)],  # 10 wide, 20 high
        "flat": [0, 0, 0, 0],
    }
    for name in FEATURES:
        np.testing.assert_allclose(found[name], expected[name], atol=1e-12, err_msg=name)


def test_the_share_that_others_cover(monkeypatch: pytest.MonkeyPatch) -> None:
    """Against every pair of boxes, in three images, a few pairs at a time; some boxes share sides or are equal."""
    monkeypatch.setattr(pairing, "_CELLS_AT_ONCE", 50)
    random = np.random.default_rng(0)
    upper_left = random.integers(0, 60, (90, 2)).astype(np.float64)
    xyxy_px = np.concatenate([upper_left, upper_left + random.integers(5, 30, (90, 2))], axis=1)
    xyxy_px[5] = xyxy_px[4]
    frame = np.repeat(np.arange(3), 30)
    boxes = JudgedBoxes(np.arange(90), frame, np.repeat([0.0, 0.1, 0.2], 30), np.full(90, 0.5), np.ones(90), xyxy_px)
    shared = intersection_matrix(xyxy_px, xyxy_px) * (frame[:, None] == frame)
    np.fill_diagonal(shared, 0)
    expected = shared.max(axis=1) / area(xyxy_px)
    assert expected[4] == 1
    np.testing.assert_allclose(features_of(boxes)[:, FEATURES.index("covered")], expected)


def test_nothing_to_judge() -> None:
    none = np.zeros(0)
    empty = JudgedBoxes(none.astype(np.int64), none.astype(np.int64), none, none, none, np.zeros((0, 4)))
    assert trust_of(features_of(empty)).shape == (0,)


def test_a_good_box_is_trusted_and_a_sliver_far_from_a_sure_look_is_not() -> None:
    good = np.array([[1.0, 0, 1.0, 0, np.log1p(5), 0, 0, 0]])
    sliver = np.array([[0.4, 0, 0.5, np.log1p(20), np.log1p(2), 0.9, np.log(2), 0]])
    assert trust_of(good)[0] > 0.95
    assert trust_of(sliver)[0] < 0.1
