"""Pictures of the traffic: a road, the objects as simple shapes in colours of their own, and the frame's number.

The number is written twice: for people, and as a row of black and white squares along the lower edge, which a test
reads back from the screen to know which frame it sees.
"""

from __future__ import annotations

import colorsys
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from tests.big_drive.traffic import HEIGHT_PX, WIDTH_PX

JPEG_QUALITY = 85
BITS = 12
SQUARE_PX = 16

Image = NDArray[np.uint8]


def background() -> Image:
    """A grey road under a pale sky, with some grain so that the JPEG is not smaller than a photograph's."""
    rows = np.linspace(0, 1, HEIGHT_PX)[:, None]
    horizon = 0.48
    sky = np.array([232.0, 214, 190]) - rows[..., None] * np.array([40.0, 30, 10])
    road = np.array([72.0, 70, 68]) + (rows[..., None] - horizon) * np.array([60.0, 60, 60])
    image = np.where((rows < horizon)[..., None], sky, road) * np.ones((HEIGHT_PX, WIDTH_PX, 3))
    grain = np.random.default_rng(7).normal(0, 5, (HEIGHT_PX, WIDTH_PX, 1))
    return np.clip(image + grain, 0, 255).astype(np.uint8)


def draw(
    base: Image, frame: int, camera: str, boxes_px: NDArray[np.int64], objects: Sequence[int], classes: Sequence[int]
) -> bytes:
    """One JPEG; the boxes come far ones first."""
    image = base.copy()
    for box, number, class_id in zip(boxes_px.tolist(), objects, classes, strict=True):
        (_draw_person if class_id == 3 else _draw_vehicle)(image, box, colour_of(number))
    cv2.putText(image, f"{camera} {frame}", (12, 30), cv2.FONT_HERSHEY_SIMPLEX, 0.7, (40, 40, 40), 2, cv2.LINE_AA)
    write_number(image, frame)
    return cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1].tobytes()


def write_number(image: Image, number: int) -> None:
    """The number in squares along the lower left edge, its highest bit first."""
    top = HEIGHT_PX - SQUARE_PX
    for bit in range(BITS):
        shade = 255 if number >> (BITS - 1 - bit) & 1 else 0
        image[top:, bit * SQUARE_PX : (bit + 1) * SQUARE_PX] = shade


def read_number(image: Image) -> int:
    """The number that :func:`write_number` wrote."""
    middle = image[HEIGHT_PX - SQUARE_PX // 2, SQUARE_PX // 2 : BITS * SQUARE_PX : SQUARE_PX].mean(axis=-1)
    return int("".join("1" if shade > 127 else "0" for shade in middle), 2)


def colour_of(number: int) -> tuple[int, int, int]:
    """A colour (BGR) of an object's own: the golden ratio spreads the hues."""
    red, green, blue = colorsys.hsv_to_rgb(number * 0.618 % 1, 0.55 + 0.2 * (number % 3), 0.75)
    return round(blue * 255), round(green * 255), round(red * 255)


def _draw_vehicle(image: Image, box: Sequence[int], colour: tuple[int, int, int]) -> None:
    x1, y1, x2, y2 = box
    width, height = x2 - x1, y2 - y1
    roof, sill = y1 + round(0.45 * height), y2 - round(0.12 * height)
    cabin = (x1 + round(0.18 * width), y1), (x2 - round(0.18 * width), roof)
    cv2.rectangle(image, *cabin, colour, -1)
    cv2.rectangle(
        image, (x1 + round(0.24 * width), y1 + round(0.1 * height)), (cabin[1][0] - 2, roof), (60, 50, 45), -1
    )
    cv2.rectangle(image, (x1, roof), (x2, sill), colour, -1)
    wheel = max(1, round(0.13 * height))
    for at in (0.22, 0.78):
        cv2.circle(image, (x1 + round(at * width), y2 - wheel), wheel, (25, 25, 25), -1)


def _draw_person(image: Image, box: Sequence[int], colour: tuple[int, int, int]) -> None:
    x1, y1, x2, y2 = box
    width, height = x2 - x1, y2 - y1
    middle, head = (x1 + x2) // 2, max(1, round(0.09 * height))
    cv2.circle(image, (middle, y1 + head), head, (150, 170, 205), -1)
    cv2.rectangle(image, (x1 + width // 5, y1 + 2 * head), (x2 - width // 5, y1 + round(0.58 * height)), colour, -1)
    cv2.rectangle(image, (x1 + width // 4, y1 + round(0.58 * height)), (x2 - width // 4, y2), (60, 45, 40), -1)
