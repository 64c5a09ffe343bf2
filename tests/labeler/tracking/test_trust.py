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
        "narrower": [0, 0, 0, 0],
        "flatter": [0, 0, 0, 0],
        "near_scores": [0.5, 0.5, 0.5, 1],  # 1, .5 and 0 within half a second
        "from_end": [0, np.log(3), 0, 0],  # 0.2 s from both ends
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


def test_a_box_of_another_shape_than_the_sure_ones() -> None:
    """The sure box is 20 by 10, a box that is a tenth as sure hardly counts: half as wide, then half as high."""
    boxes = JudgedBoxes(
        track=np.zeros(3, np.int64),
        frame=np.arange(3),
        time_s=np.array([0.0, 0.1, 0.2]),
        score=np.array([0.9, 0.09, 0.09]),
        on_path=np.ones(3),
        xyxy_px=np.array([[0.0, 0, 20, 10], [0, 0, 10, 10], [0, 0, 20, 5]]),
    )
    features = features_of(boxes)
    np.testing.assert_allclose(features[:, FEATURES.index("narrower")], [0, np.log(2), 0], atol=1e-3)
    np.testing.assert_allclose(features[:, FEATURES.index("flatter")], [0, 0, np.log(2)], atol=1e-3)


def test_what_is_near_counts_in_the_same_track_only() -> None:
    """Two tracks of four boxes 0.3 s apart: each box sees its neighbours, not those 0.6 s away."""
    score = np.array([1.0, 0.5, 0.25, 0.75, 0.2, 0.2, 0.2, 0.2])
    boxes = JudgedBoxes(
        track=np.repeat([3, 8], 4),
        frame=np.tile(np.arange(4), 2),
        time_s=np.tile([0.0, 0.3, 0.6, 0.9], 2),
        score=score,
        on_path=np.ones(8),
        xyxy_px=np.tile([0.0, 0, 10, 10], (8, 1)),
    )
    expected = [0.75, 1.75 / 3, 0.5, 0.5, 1, 1, 1, 1]
    np.testing.assert_allclose(features_of(boxes)[:, FEATURES.index("near_scores")], expected)


GOOD = dict.fromkeys(FEATURES, 0.0) | {
    "relative_score": 1.0,
    "on_path": 1.0,
    "length": np.log1p(5),
    "near_scores": 0.98,
    "from_end": np.log1p(20),
}
LATE = GOOD | {"relative_score": 0.4, "near_scores": 0.5, "since_sure": np.log1p(25), "from_end": 0.0, "on_path": 0.7}
SLIVER = LATE | {"covered": 0.9, "narrower": 0.7}


@pytest.mark.parametrize(
    ("box", "least", "most"),
    [
        (GOOD, 0.95, 1.0),
        (LATE, 0.3, 0.9),  # the last that is seen of it, long after a sure look
        (SLIVER, 0.0, 0.2),  # and half covered, narrower than the object is
    ],
)
def test_what_is_trusted(box: dict[str, float], least: float, most: float) -> None:
    (trust,) = trust_of(np.array([[box[name] for name in FEATURES]]))
    assert least <= trust <= most
