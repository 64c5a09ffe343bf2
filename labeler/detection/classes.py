"""Names of classes, and which of them may mean one and the same object.

COCO's order is that of the official YOLOX weights (https://cocodataset.org, 80 classes)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

COCO_CLASSES = (
    "person", "bicycle", "car", "motorcycle", "airplane", "bus", "train", "truck", "boat", "traffic light",
    "fire hydrant", "stop sign", "parking meter", "bench", "bird", "cat", "dog", "horse", "sheep", "cow",
    "elephant", "bear", "zebra", "giraffe", "backpack", "umbrella", "handbag", "tie", "suitcase", "frisbee",
    "skis", "snowboard", "sports ball", "kite", "baseball bat", "baseball glove", "skateboard", "surfboard",
    "tennis racket", "bottle", "wine glass", "cup", "fork", "knife", "spoon", "bowl", "banana", "apple",
    "sandwich", "orange", "broccoli", "carrot", "hot dog", "pizza", "donut", "cake", "chair", "couch",
    "potted plant", "bed", "dining table", "toilet", "tv", "laptop", "mouse", "remote", "keyboard", "cell phone",
    "microwave", "oven", "toaster", "sink", "refrigerator", "book", "clock", "vase", "scissors", "teddy bear",
    "hair drier", "toothbrush",
)  # fmt: skip

ROAD_USER_CLASSES = ("person", "bicycle", "car", "motorcycle", "bus", "train", "truck")
VEHICLE_CLASSES = ("car", "bus", "train", "truck")
TWO_WHEELER_CLASSES = ("bicycle", "motorcycle")

SUPPRESSION_GROUPS = (VEHICLE_CLASSES, TWO_WHEELER_CLASSES)
"""Classes that fire together on one object: a box of one suppresses a box of another of the same group."""


def suppression_group_of(class_names: Sequence[str]) -> NDArray[np.int32]:
    """(C,) group number of each class. Classes of one of SUPPRESSION_GROUPS share a number, all others have their own.

    Names are compared without regard to case."""
    numbers = {name: number for number, group in enumerate(SUPPRESSION_GROUPS) for name in group}
    first_own = len(SUPPRESSION_GROUPS)
    return np.array(
        [numbers.get(name.lower(), first_own + index) for index, name in enumerate(class_names)], dtype=np.int32
    )
