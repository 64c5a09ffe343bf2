"""Which class a truth category or a label counts as.

Every drive format names its categories in its own way; labels carry the detector's names. Both are brought to the
vehicle classes of COCO. A van is a car and a pickup is a truck, as COCO's annotators draw the line most often.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from labeler.evaluation.merges import is_vehicle

CLASSES = ("car", "truck", "bus", "motorcycle", "train")
"""What is counted; a class in this room is an index into it."""

NOT_COUNTED = -1
"""A person, an animal, a bicycle, a fixed object: as if it were not there."""

DONT_CARE = -2
"""A region that nobody labelled, or a vehicle that is none of the classes (a trailer): neither hit nor miss."""

_WORDS = (
    (None, ("dontcare", "trailer", "misc", "construction")),
    ("motorcycle", ("motorcycle", "motorbike")),
    ("bus", ("bus",)),
    ("train", ("train", "tram", "railed", "rails")),
    ("truck", ("truck", "pickup", "large")),
    ("car", ("car", "van", "regular", "suv", "police", "ambulance")),
)
"""Words of a category's name; the first row that has one of them decides."""


def class_of_category(category: str) -> int:
    """The class of a truth category as a format names it: an index into CLASSES, DONT_CARE or NOT_COUNTED.

    A vehicle of an unknown name is DONT_CARE: whether a label on it is right can't be told.
    """
    words = set(re.split(r"[^a-z0-9]+", category.lower()))
    if "dontcare" not in words and not is_vehicle(category):
        return NOT_COUNTED
    name = next((name for name, known in _WORDS if not words.isdisjoint(known)), None)
    return DONT_CARE if name is None else CLASSES.index(name)


def class_of_labels(class_names: Sequence[str]) -> NDArray[np.int16]:
    """(C,) int16 class of each of the detector's classes, by class id; NOT_COUNTED for those that are none of ours."""
    return np.array([max(class_of_category(name), NOT_COUNTED) for name in class_names], np.int16)
