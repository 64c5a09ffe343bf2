"""Fitted curves are those that made what came true, held to their directions."""

import numpy as np
from scipy.special import expit

from labeler.evaluation.curve_fitting import FALLS, RISES, fit_curves

NAMES = ("near", "flag", "always")


def made_up(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows whose chance rises with ``near`` up to 1 and then stays, and falls with ``flag``; and that chance."""
    random = np.random.default_rng(seed)
    features = np.stack([random.uniform(0, 2, count), random.integers(0, 2, count), np.full(count, 3.0)], axis=1)
    return features, expit(-1 + 3 * np.minimum(features[:, 0], 1) - features[:, 1])


def test_the_fitted_chance_is_the_one_that_made_the_rows() -> None:
    features, chance = made_up(8000, 0)
    is_right = (np.random.default_rng(1).random(8000) < chance).astype(np.float64)
    model = fit_curves(features, is_right, np.ones(8000), names=NAMES, flags=("flag",))
    fresh, expected = made_up(2000, 2)
    assert np.abs(model.probability(fresh, NAMES) - expected).mean() < 0.03
    beyond = np.array([[2.0, 0, 3.0], [50.0, 0, 3.0]])
    near_end, far_out = model.probability(beyond, NAMES)
    assert far_out == near_end


def test_a_direction_holds_against_what_was_seen() -> None:
    features, chance = made_up(4000, 0)
    directions = {"near": FALLS, "flag": RISES}
    model = fit_curves(features, chance, np.ones(4000), names=NAMES, flags=("flag",), directions=directions)
    assert (np.diff(model.curves["near"][1]) <= 1e-9).all()
    assert (np.diff(model.curves["flag"][1]) >= -1e-9).all()


def test_weights_say_whose_chance_counts() -> None:
    """Equal rows, half of them right: those that are right weigh three times as much."""
    is_right = np.tile([0.0, 1.0], 500)
    weight = np.where(is_right == 1, 3.0, 1.0)
    model = fit_curves(np.zeros((1000, 1)), is_right, weight, names=("same",))
    assert abs(model.probability(np.zeros((1, 1)), ("same",))[0] - 0.75) < 0.01
