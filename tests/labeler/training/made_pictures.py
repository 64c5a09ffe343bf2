"""Pictures that say what they show without a simulator: grey ground, boxes of one colour a class."""

import numpy as np
from numpy.typing import NDArray

from labeler.simulation.materials import Semantic
from labeler.training.pictures import Picture

COLORS = ((200, 60, 40), (40, 180, 60), (50, 60, 210), (30, 200, 200))


def picture(*objects: tuple[int, int, int, int, int], size_px: tuple[int, int] = (128, 96)) -> Picture:
    """An image with an object for each ``(class, x1, y1, x2, y2)``, painted in its class's colour on a road."""
    width_px, height_px = size_px
    image: NDArray[np.uint8] = np.full((height_px, width_px, 3), 110, np.uint8)
    semantic: NDArray[np.uint8] = np.full((height_px, width_px), Semantic.ROAD, np.uint8)
    for class_id, x1, y1, x2, y2 in objects:
        image[y1:y2, x1:x2] = COLORS[class_id]
        semantic[y1:y2, x1:x2] = Semantic.VEHICLE
    boxes_px = np.array([box[1:] for box in objects], np.float32).reshape(-1, 4)
    classes = np.array([box[0] for box in objects], np.int64)
    return Picture(image, boxes_px, classes, np.zeros((0, 4), np.float32), semantic)
