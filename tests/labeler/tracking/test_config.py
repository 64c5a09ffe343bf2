"""The settings refuse what makes no sense."""

from typing import Any

import pytest

from labeler.tracking import TrackingConfig, TrackingError


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"min_score": 0.5, "birth_score": 0.3}, "min_score"),  # could begin a track, but not continue it
        ({"min_iou": 0.0}, "min_iou"),  # boxes that don't touch would match
        ({"min_iou": 1.5}, "min_iou"),  # nothing overlaps that much
        ({"max_coast_s": -1.0}, "max_coast_s"),
        ({"speed_change_std_sizes": float("nan")}, "speed_change_std_sizes"),
        ({"ego_motion": "half"}, "half"),
        ({"measurement_std_sizes": 0.0}, "measurement_std_sizes"),  # the filter could not be inverted
    ],
)
def test_refuses(settings: dict[str, Any], said: str) -> None:
    with pytest.raises(TrackingError, match=said):
        TrackingConfig(**settings)
