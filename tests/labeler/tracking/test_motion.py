"""The filter of one box: values worked out by hand, and what holds for every frame rate."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labeler.tracking import TrackingConfig
from labeler.tracking.motion import BoxMotion, TimeStep

BOX = np.array([0.0, 0.0, 40.0, 10.0])  # its size is 20: the root of 40 times 10


def test_a_new_box_stays_where_it_is() -> None:
    motion = BoxMotion(BOX, TrackingConfig())
    motion.predict(TimeStep.of(0.5))
    np.testing.assert_allclose(motion.xyxy_px, BOX)


def test_update_by_hand() -> None:
    """Size 20. Variances before: position (0.05 * 20)^2 = 1, speed (2 * 20)^2 = 1600, noise on the speed 0.

    After 0.1 s: position 1 + 0.01 * 1600 = 17, with speed 0.1 * 1600 = 160. A box of the same size, 9 px to the right:
    measurement variance 1, so the gain is 17 / 18 in position and 160 / 18 in speed.
    """
    motion = BoxMotion(BOX, TrackingConfig(speed_change_std_sizes=0.0, growth_ratio=0.0))
    motion.predict(TimeStep.of(0.1))
    motion.update(BOX + np.array([9.0, 0, 9.0, 0]))
    np.testing.assert_allclose(motion.xyxy_px, BOX + np.array([8.5, 0, 8.5, 0]))
    np.testing.assert_allclose(motion.velocity_px_s, [80, 0, 0, 0], atol=1e-9)


def test_learns_speed_and_coasts_on_it() -> None:
    motion = BoxMotion(BOX, TrackingConfig())
    for step in range(1, 31):
        motion.predict(TimeStep.of(0.1))
        motion.update(BOX + np.array([3.0, 0, 3.0, 0]) * step)
    motion.predict(TimeStep.of(1.0))
    np.testing.assert_allclose(motion.xyxy_px, BOX + np.array([120.0, 0, 120.0, 0]), atol=0.1)


def test_a_shrinking_box_keeps_a_pixel() -> None:
    motion = BoxMotion(BOX, TrackingConfig(growth_ratio=1.0))
    motion.predict(TimeStep.of(0.1))
    motion.update(np.array([15.0, 4.0, 25.0, 6.0]))
    motion.predict(TimeStep.of(10.0))
    x1, y1, x2, y2 = motion.xyxy_px
    assert (x2 - x1, y2 - y1) == pytest.approx((1, 1))


@settings(deadline=None)
@given(st.lists(st.floats(0.001, 0.5), min_size=1, max_size=8), st.floats(-50, 50))
def test_many_short_steps_are_one_long_step(steps: list[float], move_px: float) -> None:
    """The noise depends on time alone, so what happens later is the same however the time between was cut.

    Growth is off: the noise follows the box's size, which then stays the same."""
    config = TrackingConfig(growth_ratio=0.0)
    cut, whole = BoxMotion(BOX, config), BoxMotion(BOX, config)
    for step in steps:
        cut.predict(TimeStep.of(step))
    whole.predict(TimeStep.of(sum(steps)))
    for motion in (cut, whole):
        motion.update(BOX + move_px)
        motion.predict(TimeStep.of(0.2))
    np.testing.assert_allclose(cut.xyxy_px, whole.xyxy_px, atol=1e-6)
    np.testing.assert_allclose(cut.velocity_px_s, whole.velocity_px_s, atol=1e-6)
