"""A tracker by the name in the configuration."""

import pytest

from labeler.tracking import TrackingConfig, TrackingError, open_tracker
from labeler.tracking.kalman_iou import KalmanIouTracker


def test_opens_the_named_tracker() -> None:
    assert isinstance(open_tracker(TrackingConfig(), class_groups=(0,)), KalmanIouTracker)


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(TrackingError, match=r"no tracking method 'magic'.*kalman_iou"):
        open_tracker(TrackingConfig(method="magic"), class_groups=(0,))
