"""A tracker by the name in the configuration."""

import pytest

from labeler.tracking import TrackingConfig, TrackingError, open_tracker
from labeler.tracking.config import METHODS
from labeler.tracking.kalman_iou import KalmanIouTracker
from labeler.tracking.two_stage import TwoStageTracker


def test_opens_the_named_tracker() -> None:
    assert isinstance(open_tracker(TrackingConfig(method="baseline"), class_groups=(0,)), KalmanIouTracker)


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(TrackingError, match=r"no tracking method 'magic'.*two_stage, baseline"):
        TrackingConfig(method="magic")


def test_opens_the_two_stage_tracker() -> None:
    assert isinstance(open_tracker(TrackingConfig(method="two_stage"), class_groups=(0,)), TwoStageTracker)


@pytest.mark.parametrize("method", METHODS)
def test_every_method_opens(method: str) -> None:
    tracker = open_tracker(TrackingConfig(method=method), class_groups=(0,))
    assert list(tracker.track([], first_track_id=0)) == []
