import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pyarrow.feather as feather
import pytest
from numpy.typing import NDArray

from labeler.detection import DetectionConfig, DetectionError, Detections, YoloxDetector, open_detector
from labeler.geometry.boxes_2d import iou_matrix

ModelMaker = Callable[..., Path]
_NAMES = {"names": '["car", "person"]'}
_CAR, _PERSON, _OBJECT = (255, 255, 0), (255, 0, 255), (255, 255, 255)  # blue: objectness, green: car, red: person


def _grey(height: int, width: int) -> NDArray[np.uint8]:
    return np.full((height, width, 3), 114, np.uint8)


def _painted(height: int, width: int, *cells: tuple[int, int, tuple[int, int, int]]) -> NDArray[np.uint8]:
    """A grey image with the corner pixel of some cells of stride 8 (column, row, colour) painted for pixel_model."""
    image = _grey(height, width)
    for column, row, colour in cells:
        image[8 * row, 8 * column] = colour
    return image


def _table(found: Detections) -> list[tuple[list[float], float, int]]:
    return [
        ([round(side, 2) for side in box], round(score, 3), class_id)
        for box, score, class_id in zip(
            found.xyxy_px.tolist(), found.score.tolist(), found.class_id.tolist(), strict=True
        )
    ]


def _open(path: Path, *, classes: tuple[str, ...] = ("car", "person"), **settings: Any) -> YoloxDetector:
    return open_detector(path, DetectionConfig(classes=classes, **settings))


def _same(a: Sequence[Detections], b: Sequence[Detections]) -> bool:
    return [_table(each) for each in a] == [_table(each) for each in b]


# Cell 5, 3 of stride 8: centre (44, 28), sides 32.
_BOX_5_3 = [28.0, 12.0, 60.0, 44.0]


@pytest.mark.parametrize(
    "interface",
    [
        {},  # free shape, raw
        {"batch": 1, "hw": (64, 96)},  # fixed shape, raw
        {"batch": 1, "hw": (64, 96), "decoded": True},
        {"batch": "batch", "hw": (64, 96), "decoded": True},
        {"batch": 3, "hw": (64, 96)},  # fixed batch, larger than the number of images
    ],
)
def test_any_export_gives_the_same_boxes(pixel_model: ModelMaker, interface: dict[str, object]) -> None:
    detector = _open(pixel_model(metadata=_NAMES, **interface))
    image = _painted(64, 96, (5, 3, _CAR), (9, 5, (191, 0, 255)))
    (found,) = detector.detect([image])
    # Cell 9, 5: centre (76, 44), 60..92 x 28..60; objectness (191 - 128) / 127 = 0.496.
    assert _table(found) == [(_BOX_5_3, 1.0, 0), ([60.0, 28.0, 92.0, 60.0], 0.496, 1)]
    assert detector.class_names == ("car", "person")
    assert (found.xyxy_px.dtype, found.score.dtype, found.class_id.dtype) == (np.float32, np.float32, np.int16)


def test_images_of_any_size_in_one_call_keep_their_order(pixel_model: ModelMaker) -> None:
    detector = _open(pixel_model(metadata=_NAMES))
    images = [_painted(64, 96, (5, 3, _CAR)), _grey(40, 50), _painted(70, 96, (5, 3, _PERSON))]
    tables = [_table(found) for found in detector.detect(images)]
    assert tables == [[(_BOX_5_3, 1.0, 0)], [], [(_BOX_5_3, 1.0, 1)]]
    assert detector.detect([]) == []


def test_a_batch_says_the_same_as_one_by_one(pixel_model: ModelMaker) -> None:
    path = pixel_model(metadata=_NAMES)
    images = [_painted(64, 96, (column, 3, _CAR)) for column in (1, 3, 5, 7, 9)] + [_painted(32, 96, (5, 1, _CAR))]
    one_by_one, batched = _open(path), _open(path, batch_size=4)
    assert (one_by_one.batch_size, batched.batch_size) == (1, 4)
    assert _same(batched.detect(images), [one_by_one.detect([image])[0] for image in images])
    assert _open(pixel_model(batch=1, name="one.onnx"), classes=("class_0",), batch_size=4).batch_size == 1


def test_class_id_counts_in_the_order_asked_for(pixel_model: ModelMaker) -> None:
    detector = _open(pixel_model(metadata=_NAMES), classes=("bus", "person", "car", "person"))
    assert detector.class_names == ("person", "car")
    (found,) = detector.detect([_painted(64, 96, (5, 3, _CAR))])
    assert found.class_id.tolist() == [1]


def test_box_whose_best_class_was_not_asked_for_is_dropped(pixel_model: ModelMaker) -> None:
    detector = _open(pixel_model(metadata=_NAMES), classes=("car",))
    (found,) = detector.detect([_painted(64, 96, (5, 3, (255, 200, 255)))])
    assert len(found) == 0


def test_model_without_any_class_asked_for_is_an_error(pixel_model: ModelMaker) -> None:
    with pytest.raises(DetectionError, match=r"none of the classes asked for \(tram\)\. It knows: car, person"):
        _open(pixel_model(metadata=_NAMES), classes=("tram",))


@pytest.mark.parametrize(
    ("names", "kept"),
    [
        ('["car", "truck"]', 1),  # one object seen as two kinds of four-wheeler
        ('["bicycle", "motorcycle"]', 1),
        ('["person", "bicycle"]', 2),  # a rider and what she rides
    ],
)
def test_classes_that_fire_on_one_object_suppress_each_other(pixel_model: ModelMaker, names: str, kept: int) -> None:
    config = DetectionConfig(nms_iou=0.5)
    detector = open_detector(pixel_model(metadata={"names": names}), config)
    # Next cells: 32 px boxes 8 px apart, IoU 24 / 40 = 0.6.
    (found,) = detector.detect([_painted(64, 96, (5, 3, _CAR), (6, 3, (230, 0, 255)))])
    assert len(found) == kept
    assert found.score.tolist() == sorted(found.score.tolist(), reverse=True)


def test_boxes_end_at_the_image_and_empty_ones_are_dropped(constant_model: ModelMaker) -> None:
    rows = np.zeros((84, 6), np.float32)
    rows[0] = [0.5, 0.5, np.log(4), np.log(4), 0.9, 1]  # -12..20: the part inside is 0..20
    rows[63] = [0.5, 0.5, np.log(0.5), np.log(0.5), 0.8, 1]  # 58..62, but the image ends at 56
    rows[27] = [0.5, 0.5, -200, 0, 0.7, 1]  # no width
    detector = open_detector(constant_model(rows), DetectionConfig(classes=("class_0",)))
    image = np.zeros((56, 56, 3), np.uint8)
    # 56 -> 64: the image is enlarged by 64 / 56, so boxes shrink by 0.875; the last one ends within the image.
    (found,) = detector.detect([image])
    assert _table(found) == [([0, 0, 17.5, 17.5], 0.9, 0), ([50.75, 50.75, 54.25, 54.25], 0.8, 0)]
    (found,) = detector.detect([np.zeros((40, 64, 3), np.uint8)])  # the second lies below this image
    assert _table(found) == [([0, 0, 20, 20], 0.9, 0)]


def test_nan_and_infinity_are_dropped_and_counted(constant_model: ModelMaker) -> None:
    rows = np.zeros((84, 6), np.float32)
    rows[:, 2:4] = 1
    rows[:5, 4:] = 0.9
    rows[0, 0] = np.nan
    rows[1, 5] = np.nan
    rows[2, 2] = np.inf
    detector = open_detector(constant_model(rows), DetectionConfig(classes=("class_0",)))
    assert detector.non_finite_count == 0
    (found,) = detector.detect([_grey(64, 64)])
    assert len(found) == 2
    assert np.isfinite(found.xyxy_px).all()
    assert detector.non_finite_count == 3


def test_wide_image_on_a_fixed_shape_is_tiled_and_a_seam_gives_one_box(pixel_model: ModelMaker) -> None:
    detector = _open(pixel_model(batch=1, hw=(64, 64), metadata=_NAMES), nms_iou=0.3)
    # Tiles 0..99, 78..177 and 157..256, 64 high, drawn 64 wide and 41 high: 1.547 and 1.561 image pixels to one.
    assert detector.input_shapes((64, 256)) == ((64, 64),) * 3
    image = _grey(64, 256)
    image[12:28, 80:97] = _CAR  # in the strip that the first two tiles see
    image[36:52, 208:224] = _PERSON  # in the last tile alone
    (found,) = detector.detect([image])
    boxes = {class_id: box for box, _, class_id in _table(found)}
    assert (len(found), sorted(boxes)) == (2, [0, 1])
    # Cell 7, 1 of the first tile is 44..76 x -4..28 of its input, cell 1, 1 of the second -4..28 x -4..28. Each is cut
    # by its tile; together they reach from 44 * 1.547 = 68.1 to 78 + 28 * 1.547 = 121.3, and down to 28 * 1.561 = 43.7.
    np.testing.assert_allclose(boxes[0], [68.1, 0, 121.3, 43.7], atol=0.1)
    # Cell 5, 3 of the last tile: 157 + (28, 60) * 1.547 and (12, 44) * 1.561, which ends with the image.
    np.testing.assert_allclose(boxes[1], [200.3, 18.7, 249.8, 64], atol=0.1)


@pytest.mark.parametrize(
    "image",
    [
        np.zeros((10, 10), np.uint8),  # grey
        np.zeros((10, 10, 4), np.uint8),  # with transparency
        np.zeros((10, 10, 3), np.float32),
        np.zeros((0, 10, 3), np.uint8),
    ],
)
def test_what_is_no_colour_image_is_named(pixel_model: ModelMaker, image: NDArray[np.uint8]) -> None:
    detector = _open(pixel_model(metadata=_NAMES))
    with pytest.raises(ValueError, match=r"images\[1\] must be \(H, W, 3\) uint8"):
        detector.detect([_grey(32, 32), image])


def test_several_threads_may_detect_at_once(pixel_model: ModelMaker) -> None:
    detector = _open(pixel_model(metadata=_NAMES))
    images = [_painted(64, 96, (1 + 2 * (index % 5), 3, _CAR)) for index in range(40)]
    alone = [detector.detect([image])[0] for image in images]
    start = threading.Barrier(4)

    def detect_all(_: int) -> list[Detections]:
        start.wait(timeout=30)
        return [detector.detect([image])[0] for image in images]

    with ThreadPoolExecutor(4) as pool:
        for together in pool.map(detect_all, range(4)):
            assert _same(together, alone)


def test_cpu_is_named_as_the_provider_in_use(pixel_model: ModelMaker) -> None:
    detector = open_detector(
        pixel_model(metadata=_NAMES), DetectionConfig(), providers=("CPUExecutionProvider",), intra_op_threads=2
    )
    assert detector.providers == ("CPUExecutionProvider",)


# Seen by eye in the first image: the silver car at the left, the grey one ahead, the lorry at the right.
_KITTI_BOXES = {"car": [[64, 180, 417, 372], [555, 189, 699, 331]], "truck": [[781, 28, 1242, 368]]}


@pytest.mark.real_drive
@pytest.mark.parametrize("weights", ["yolox_nano_dynamic", "yolox_nano_416"])
def test_finds_the_near_vehicles_of_kitti(weights: str, kitti_0052: Path, request: pytest.FixtureRequest) -> None:
    detector = open_detector(request.getfixturevalue(weights))
    image = _read(kitti_0052 / "training/image_02/0000/000000.png")
    (found,) = detector.detect([image])
    for name, boxes in _KITTI_BOXES.items():
        named = found[(found.class_id == detector.class_names.index(name)) & (found.score > 0.7)]
        assert (iou_matrix(np.array(boxes, np.float32), named.xyxy_px).max(axis=1) > 0.65).all(), name


@pytest.mark.real_drive
def test_finds_cars_where_the_truth_has_them(tri_scene_01: Path, yolox_nano_dynamic: Path) -> None:
    """The large cars of the left camera: the truth knows hidden ones too, so not all can be found."""
    detector = open_detector(yolox_nano_dynamic)
    truth = feather.read_table(tri_scene_01 / "annotations_2d.feather").to_pylist()
    for path in sorted((tri_scene_01 / "sensors/cameras/ring_front_left").glob("*.jpg")):
        boxes = [
            [row["x1_px"], row["y1_px"], row["x2_px"], row["y2_px"]]
            for row in truth
            if row["camera"] == "ring_front_left"
            and row["timestamp_ns"] == int(path.stem)
            and row["category"] == "CAR"
            and row["y2_px"] - row["y1_px"] >= 64
        ]
        (found,) = detector.detect([_read(path)])
        strong = found[found.score >= 0.3]
        hits = iou_matrix(np.array(boxes, np.float32), strong.xyxy_px).max(axis=1) >= 0.5
        assert hits.sum() >= 4, path.name
        assert (found.score >= 0.05).all()


@pytest.mark.real_drive
def test_real_weights_say_the_same_in_a_batch(kitti_0052: Path, yolox_nano_dynamic: Path) -> None:
    images = [_read(path) for path in sorted((kitti_0052 / "training/image_02/0000").glob("*.png"))[:2]]
    small = DetectionConfig(input_long_side_px=320, min_score=0.3)
    batched = open_detector(yolox_nano_dynamic, replace(small, batch_size=2)).detect(images)
    single = open_detector(yolox_nano_dynamic, small)
    for together, image in zip(batched, images, strict=True):
        (alone,) = single.detect([image])
        np.testing.assert_allclose(together.xyxy_px, alone.xyxy_px, atol=0.1)
        np.testing.assert_allclose(together.score, alone.score, atol=1e-3)


def _read(path: Path) -> NDArray[np.uint8]:
    image = cv2.imread(str(path))
    assert image is not None
    return np.asarray(image, np.uint8)
