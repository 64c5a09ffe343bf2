"""How likely labels are right: the features by hand, the curves, and what the model that ships knows."""

import numpy as np
import pytest
from scipy.special import logit

from labeler.propagation import collect_votes
from labeler.propagation.labelling import label_features, label_observations
from labeler.propagation.probability import FEATURES, probability_of, shipped
from labeler.tracking import NO_DETECTION, Observations
from labeler.tracking.curves import CurveModel
from tests.labeler.propagation.rows import CAR, TRUCK

TEN_HZ_NS = 100_000_000 * np.arange(30, dtype=np.int64)


def seen() -> Observations:
    """A track that is .75 car in frame 0, .25 truck in frame 10, and filled in in frame 20."""
    return Observations(
        track_id=np.array([1, 1, 1], np.int32),
        frame_index=np.array([0, 10, 20], np.int32),
        xyxy_px=np.array([[0, 0, 9, 20], [0, 10, 9, 20], [0, 10, 9, 10.25]], np.float32),
        score=np.array([0.75, 0.25, np.nan], np.float32),
        class_id=np.array([CAR, TRUCK, CAR], np.int16),
        detection_index=np.array([0, 0, NO_DETECTION], np.int32),
        trust=np.array([0.9, 0.75, 0.5], np.float32),
    )


def test_features() -> None:
    votes = collect_votes([("front", seen())], {}, timestamp_ns=TEN_HZ_NS)
    labels = label_observations(seen(), {}, votes, timestamp_ns=TEN_HZ_NS)
    features = label_features(seen(), labels, votes, TEN_HZ_NS)
    expected = {
        "donor_score": [0.75, 0.75, 0.75],
        "own_score": [0.75, 0.25, 0],
        "filled": [0, 0, 1],
        "other_class": [0, 1, 0],
        "trust": [0.9, 0.75, 0.5],
        "donor_s": np.log([1, 2, 3]),  # 0, 1 and 2 seconds
        "height": np.log([20, 10, 1]),  # a quarter of a pixel counts as one
        "observations": np.log([3, 3, 3]),
        "class_share": [0.75, 0.75, 0.75],
        "cameras": [1, 1, 1],
    }
    for column, name in enumerate(FEATURES):
        np.testing.assert_allclose(features[:, column], expected[name], atol=1e-6, err_msg=name)


def test_curves_bend_at_their_knots_and_go_on_level() -> None:
    level = (np.array([0.0, 1.0]), np.array([0.0, 0.0]))
    bent = (np.array([0.0, 0.5, 1.0]), np.array([0.0, 1.0, 0.0]))
    model = CurveModel(-1.0, {name: bent if name == "trust" else level for name in FEATURES})
    rows = np.zeros((4, len(FEATURES)))
    rows[:, FEATURES.index("trust")] = [-3, 0.25, 0.5, 7]
    np.testing.assert_allclose(logit(probability_of(rows, model)), [-1, -0.5, 0, -1], atol=1e-12)
    assert probability_of(rows, model)[2] == 0.5
    again = CurveModel.from_json(model.to_json())
    np.testing.assert_allclose(probability_of(rows, again), probability_of(rows, model))


@pytest.mark.parametrize("name", ["trust", "own_score", "class_share"])
def test_the_model_that_ships_does_not_believe_less_where_more_speaks_for_a_label(name: str) -> None:
    """Of a sure near label, from hardly anything to all."""
    sure = {"donor_score": 0.9, "own_score": 0.8, "trust": 0.9, "height": np.log(50), "observations": 3, "cameras": 1}
    rows = np.array([[sure.get(one, 1.0 if one == "class_share" else 0.0) for one in FEATURES]] * 2)
    rows[0, FEATURES.index(name)] = 0.1
    low, high = probability_of(rows, shipped())
    assert low <= high


def test_what_has_no_score_has_no_probability() -> None:
    alone = seen()[np.array([2])]
    votes = collect_votes([("front", alone)], {}, timestamp_ns=TEN_HZ_NS)
    labels = label_observations(alone, {}, votes, timestamp_ns=TEN_HZ_NS)
    assert np.isnan(labels.probability).all()
