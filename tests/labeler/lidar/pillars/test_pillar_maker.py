"""The maker, with a network that finds a car 15 m ahead and 3 m to the left of every camera that has any points."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from labeler.detection.types import Detections
from labeler.drive.types import Calibration, Camera, Sweep
from labeler.geometry.se3 import se3
from labeler.inference import ModelError
from labeler.lidar import Boxes3D, BoxSource, CameraInput, LidarConfig, Scene, View, open_box_maker, prepare_scene
from labeler.lidar.pillars.association import projected
from labeler.lidar.pillars.network import PillarModel
from labeler.segmentation import SegmentationScores
from tests.labeler.lidar.pillars.made_network import write_network

CLASS_NAMES = ("person", "truck", "car")
AHEAD = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
LEFT = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]) @ AHEAD
INTRINSICS = np.array([[300.0, 0, 300], [0, 300, 150], [0, 0, 1]])
SIZE_M = (4.6, 1.9, 1.6)
ROAD_Z_M = -1.7
FOUND, MISSED = (15.0, 3.0, 20.0), (25.0, -6.0, 0.0)


def view(rotation: np.ndarray = AHEAD) -> View:
    return View.of(Camera("camera", 600, 300, Calibration(INTRINSICS, se3(rotation, [0, 0, 0]))))


def car(x_m: float, y_m: float, yaw_deg: float, *, turned: bool = False) -> np.ndarray:
    """Points on all sides of a car; ``turned``: as far to the left of the ego car as otherwise ahead of it."""
    length_m, width_m, _ = SIZE_M
    u = np.linspace(-0.5, 0.5, 24)
    ring = np.concatenate([[(a, b), (b, a)] for a in u for b in (-0.5, 0.5)]) * [length_m, width_m]
    cos, sin = np.cos(np.radians(yaw_deg)), np.sin(np.radians(yaw_deg))
    xy_m = ring @ np.array([[cos, sin], [-sin, cos]]) + [x_m, y_m]
    xy_m = xy_m @ np.array([[0, 1], [-1, 0]]) if turned else xy_m
    return np.concatenate([np.column_stack([xy_m, np.full(len(xy_m), ROAD_Z_M + z)]) for z in (0.5, 0.8, 1.1, 1.4)])


def scene(*cars: np.ndarray) -> Scene:
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(-40, 60, 0.7), np.arange(-40, 40, 0.7)))
    road = np.stack([x, y, np.full(len(x), ROAD_Z_M)], axis=1)
    xyz_m = np.concatenate([road, *cars]).astype(np.float32)
    offsets_ns = np.full(len(xyz_m), 20_000_000, np.int32)
    return prepare_scene(Sweep(0, xyz_m, np.ones(len(xyz_m), np.float32), offsets_ns), LidarConfig())


def scores() -> SegmentationScores:
    return SegmentationScores(("vehicle",), np.full((1, 75, 150), 255, np.uint8), stride_px=4, size_px=(600, 300))


def detection_of(*places: tuple[float, float, float], class_id: int = 2) -> Detections:
    """The boxes of cars in the image of a camera that looks ahead, as it sees them."""
    center_m = np.array([(x, y, ROAD_Z_M + SIZE_M[2] / 2) for x, y, _ in places]).reshape(-1, 3)
    yaw_rad = np.radians([yaw for _, _, yaw in places])
    size_m = np.tile(SIZE_M, (len(places), 1))
    boxes_px = projected(center_m, size_m, yaw_rad, view())
    return Detections(boxes_px, np.full(len(places), 0.8, np.float32), np.full(len(places), class_id, np.int16))


@pytest.fixture
def config(tmp_path: Path) -> LidarConfig:
    """The network's boxes alone."""
    return LidarConfig(method="pillars", network=str(write_network(tmp_path / "p.onnx", FOUND)), fill=False)


def make(config: LidarConfig, made: Scene, **cameras: CameraInput) -> dict[str, Boxes3D]:
    return open_box_maker(config, class_names=CLASS_NAMES).boxes(made, cameras)


def test_the_network_s_box_is_given_to_its_detection(config: LidarConfig) -> None:
    boxes = make(config, scene(car(*FOUND)), front=CameraInput(view(), detection_of(MISSED, FOUND), scores()))["front"]
    assert boxes.detection_index.tolist() == [1]
    assert boxes.source.tolist() == [BoxSource.PILLARS]
    np.testing.assert_allclose(boxes.center_m, [[15, 3, ROAD_Z_M + 0.8]], atol=0.06)
    np.testing.assert_allclose(boxes.size_m, [SIZE_M], rtol=1e-5)
    assert np.degrees(boxes.yaw_rad[0]) == pytest.approx(20, abs=1e-3)
    assert boxes.class_id.tolist() == [2]  # the network's car is the detector's third class
    np.testing.assert_allclose(boxes.center_std_m, [[0.3, 0.1]], rtol=1e-5)
    np.testing.assert_allclose(boxes.seen_m, [[-2.3, -0.95, 2.3, 0.95]], atol=1e-4)
    assert boxes.num_points[0] == 4 * 96
    assert boxes.offset_s[0] == pytest.approx(0.02)


def test_one_network_serves_every_direction(config: LidarConfig) -> None:
    cameras = {
        "front": CameraInput(view(), detection_of(FOUND), scores()),
        "left": CameraInput(view(LEFT), detection_of(FOUND), scores()),
    }
    found = make(config, scene(car(*FOUND), car(*FOUND, turned=True)), **cameras)
    np.testing.assert_allclose(found["front"].center_m[0, :2], [15, 3], atol=1e-3)
    np.testing.assert_allclose(found["left"].center_m[0, :2], [-3, 15], atol=1e-3)
    assert np.degrees(found["left"].yaw_rad[0]) == pytest.approx(110, abs=1e-3)


def test_boxes_made_without_weights_fill_what_the_network_does_not_find(config: LidarConfig) -> None:
    front = CameraInput(view(), detection_of(MISSED, FOUND), scores())
    made = scene(car(*FOUND), car(*MISSED))
    found = make(replace(config, fill=True), made, front=front)["front"]
    assert found.detection_index.tolist() == [0, 1]
    assert found.source.tolist() == [BoxSource.CLUSTER, BoxSource.PILLARS]
    np.testing.assert_allclose(found.center_m[:, :2], [MISSED[:2], FOUND[:2]], atol=0.06)
    network_alone = make(config, made, front=front)["front"]
    assert found.score[1] == network_alone.score[0]


def test_a_class_that_the_detector_does_not_know_is_the_detection_s(tmp_path: Path) -> None:
    network = write_network(tmp_path / "p.onnx", FOUND, class_index=2)  # a bus
    config = LidarConfig(method="pillars", network=str(network))
    front = CameraInput(view(), detection_of(FOUND, class_id=1), scores())
    assert make(config, scene(car(*FOUND)), front=front)["front"].class_id.tolist() == [1]


@pytest.mark.parametrize(
    ("cars", "detections", "painted", "sources"),
    [
        ([FOUND], [FOUND], False, [BoxSource.CLUSTER]),  # nothing paints the points of this camera
        ([FOUND], [], True, []),  # a box that no detection asks for is none
        ([], [FOUND], True, []),  # the network says so, but there are no points
    ],
)
def test_where_the_network_has_nothing_to_say(
    config: LidarConfig, cars: list[tuple[float, float, float]], detections: list[tuple[float, float, float]],
    painted: bool, sources: list[BoxSource],
) -> None:  # fmt: skip
    front = CameraInput(view(), detection_of(*detections), scores() if painted else None)
    found = make(replace(config, fill=True), scene(*(car(*place) for place in cars)), front=front)["front"]
    assert found.source.tolist() == sources


@pytest.mark.parametrize("points", [np.zeros((0, 3)), np.full((5, 3), np.nan), car(-30.0, 0.0, 0.0)])
def test_sweeps_with_nothing_in_a_direction_give_no_boxes(config: LidarConfig, points: np.ndarray) -> None:
    made = prepare_scene(Sweep(0, points.astype(np.float32), np.full(len(points), np.nan, np.float32)), config)
    found = make(replace(config, fill=True), made, front=CameraInput(view(), detection_of(FOUND), scores()))
    assert len(found["front"]) == 0


def test_an_unpainted_network_needs_no_segmentation(tmp_path: Path) -> None:
    network = write_network(tmp_path / "p.onnx", FOUND, takes_paint=False)
    config = LidarConfig(method="pillars", network=str(network), fill=False)
    maker = open_box_maker(config, class_names=CLASS_NAMES)
    found = maker.boxes(scene(car(*FOUND)), {"front": CameraInput(view(), detection_of(FOUND))})["front"]
    assert not maker.takes_paint
    assert found.source.tolist() == [BoxSource.PILLARS]


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"task": "detection"}, "does not say that it is a pillar network"),
        ({"classes": "car"}, "says too little about itself, or what can't be"),
        ({"grid": '{"x_min_m": 0}'}, "says too little about itself, or what can't be"),
        ({"painted": '["fog"]'}, "takes points painted with fog"),
        ({"painted": "[]"}, "a pillar network of this version takes"),  # fewer features than it has
    ],
)
def test_a_file_that_is_no_such_network_is_refused(tmp_path: Path, said: dict[str, str], message: str) -> None:
    with pytest.raises(ModelError, match=message):
        PillarModel(write_network(tmp_path / "p.onnx", said=said))
