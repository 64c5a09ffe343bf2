"""All filters at once do what filterpy's does for one box."""

import numpy as np
import pytest

from labeler.tracking import TrackingConfig
from labeler.tracking.box_filters import SPEED, BoxFilters
from labeler.tracking.motion import BoxMotion, TimeStep


@pytest.mark.parametrize(
    "config",
    [
        TrackingConfig(),
        TrackingConfig(growth_ratio=0.0, speed_change_std_sizes=0.0),  # nothing but the first speed is unknown
        TrackingConfig(growth_ratio=1.0, initial_speed_std_sizes=5.0),
    ],
)
def test_equals_the_filter_of_each_box(config: TrackingConfig) -> None:
    """Five boxes drift and jitter over steps of any length, one of none; each is seen in two of three images."""
    random = np.random.default_rng(3)
    upper_left = random.uniform(0, 500, (5, 2))
    boxes = np.concatenate([upper_left, upper_left + random.uniform(5, 90, (5, 2))], axis=1)
    each = [BoxMotion(box, config) for box in boxes]
    all_at_once = BoxFilters(config)
    all_at_once.add(all_at_once.measure(boxes[:2]))
    all_at_once.add(all_at_once.measure(boxes[2:]))
    for dt_s in (0.1, 0.03, 0.0, 1.5, 0.1, 0.2):
        boxes = boxes + random.normal(0, 4, boxes.shape)
        seen = np.flatnonzero(random.random(5) < 2 / 3)
        for motion in each:
            motion.predict(TimeStep.of(dt_s))
        all_at_once.predict(dt_s)
        np.testing.assert_allclose(all_at_once.xyxy_px, [motion.xyxy_px for motion in each])
        for row in seen:
            each[row].update(boxes[row])
        all_at_once.update(seen, all_at_once.measure(boxes[seen]))
    np.testing.assert_allclose(all_at_once.xyxy_px, [motion.xyxy_px for motion in each])
    np.testing.assert_allclose(all_at_once.state[SPEED].T, [motion.velocity_px_s for motion in each], atol=1e-9)


def test_keeps_the_chosen_ones() -> None:
    filters = BoxFilters(TrackingConfig())
    filters.add(filters.measure(np.array([[0.0, 0, 10, 10], [20, 0, 30, 10], [40, 0, 50, 10]])))
    filters.keep(np.array([False, True, True]))
    assert len(filters) == 2
    assert filters.xyxy_px.tolist() == [[20, 0, 30, 10], [40, 0, 50, 10]]
