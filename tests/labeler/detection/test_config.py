import json
from dataclasses import asdict
from typing import Any

import pytest

from labeler.detection import DetectionConfig


def test_settings_are_plain_values_that_json_can_hold() -> None:
    stored = json.loads(json.dumps(asdict(DetectionConfig())))
    stored["classes"] = tuple(stored["classes"])
    assert DetectionConfig(**stored) == DetectionConfig()


@pytest.mark.parametrize(
    "wrong",
    [
        {"min_score": 0.0},  # every cell of the grid would be a box
        {"min_score": 1.0},
        {"nms_iou": 0.0},
        {"nms_iou": 1.1},
        {"classes": ()},
        {"input_long_side_px": 900},  # no multiple of 32
        {"input_long_side_px": 0},
        {"batch_size": 0},
        {"tile_aspect": 1.0},
        {"tile_overlap": 1.0},
        {"tile_overlap": -0.1},
        {"max_candidates": 0},
        {"min_score": float("nan")},
    ],
)
def test_a_setting_out_of_range_is_named(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        DetectionConfig(**wrong)
