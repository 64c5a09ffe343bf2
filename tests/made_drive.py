"""A small drive made by code, and a real YOLOX-shaped model that finds the objects in it.

Two red cars, 12 m away: one parked ahead, one that crosses where the views of the front and the left camera overlap.
The model is a network of one pooling layer: how red the window around a cell is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import onnx
import pyarrow as pa
import pyarrow.feather as feather
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper
from scipy.spatial.transform import Rotation

from labeler.geometry.boxes_3d import corners_of
from labeler.geometry.projection import project_points

WIDTH_PX, HEIGHT_PX, FOCAL_PX = 320, 192, 160.0
PERIOD_NS = 100_000_000
START_NS = 1_700_000_000_000_000_000
CAMERA_YAW_DEG = {"front": 0.0, "left": 60.0}
CAR_SIZE_M = (4.5, 1.8, 1.5)
DISTANCE_M = 12.0
PARKED_DEG = -20.0
WINDOW_HW = (24, 64)
BOX_HW = (30, 84)
RED_BGR = (30, 30, 220)


@dataclass(frozen=True)
class Car:
    """A car seen from the side: its bearing from the ego car in degrees to the left, and its name."""

    name: str
    bearing_deg: float

    @property
    def center_m(self) -> NDArray[np.float64]:
        bearing = np.radians(self.bearing_deg)
        return np.array([DISTANCE_M * np.cos(bearing), DISTANCE_M * np.sin(bearing), CAR_SIZE_M[2] / 2])

    @property
    def yaw_rad(self) -> float:
        return float(np.radians(self.bearing_deg + 90))


def cars_at(frame: int, frames: int) -> list[Car]:
    """Where the cars are: one stands, one goes from 20 to 40 degrees to the left over the drive."""
    return [Car("parked", PARKED_DEG), Car("crossing", 20 + 20 * frame / max(1, frames - 1))]


def write_drive(folder: Path, *, frames: int = 12) -> Path:
    """Write the drive in the Argoverse 2 sensor-log layout."""
    (folder / "calibration").mkdir(parents=True)
    _write_calibration(folder / "calibration")
    times_ns = [START_NS + frame * PERIOD_NS for frame in range(frames)]
    _write_table(
        folder / "city_SE3_egovehicle.feather",
        {"timestamp_ns": times_ns}
        | {"qw": [1.0] * frames, "qx": [0.0] * frames, "qy": [0.0] * frames, "qz": [0.0] * frames}
        | {"tx_m": [0.0] * frames, "ty_m": [0.0] * frames, "tz_m": [0.0] * frames},
    )
    for frame, time_ns in enumerate(times_ns):
        cars = cars_at(frame, frames)
        _write_sweep(folder / "sensors" / "lidar" / f"{time_ns}.feather", cars)
        for name in CAMERA_YAW_DEG:
            path = folder / "sensors" / "cameras" / name / f"{time_ns}.jpg"
            path.parent.mkdir(parents=True, exist_ok=True)
            assert cv2.imwrite(str(path), render(name, cars), [cv2.IMWRITE_JPEG_QUALITY, 95])
    return folder


def ego_SE3_camera(name: str) -> NDArray[np.float64]:
    """(4, 4): a camera on the roof at 1.5 m, turned to its side."""
    looking_ahead = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_euler("z", CAMERA_YAW_DEG[name], degrees=True).as_matrix() @ looking_ahead
    matrix[2, 3] = 1.5
    return matrix


def intrinsics() -> NDArray[np.float64]:
    """(3, 3): 90 degrees from side to side."""
    return np.array([[FOCAL_PX, 0, WIDTH_PX / 2], [0, FOCAL_PX, HEIGHT_PX / 2], [0, 0, 1]])


def render(camera: str, cars: list[Car]) -> NDArray[np.uint8]:
    """(H, W, 3) BGR: grey ground under a blue sky, and the cars in red."""
    image = np.full((HEIGHT_PX, WIDTH_PX, 3), (110, 110, 110), np.uint8)
    image[: HEIGHT_PX // 2] = (210, 170, 140)
    for car in cars:
        corners_m = corners_of(car.center_m[None], np.array([CAR_SIZE_M]), np.array([car.yaw_rad]))[0]
        pixels, depth_m = project_points(corners_m, ego_SE3_camera(camera), intrinsics())
        if (depth_m > 1).all():
            outline = cv2.convexHull(np.rint(pixels).astype(np.int32))
            cv2.fillConvexPoly(image, outline, RED_BGR)
    return image


def write_model(path: Path) -> Path:
    """Write an ONNX file in the form of an official YOLOX export (COCO, any size, raw grid) that finds red windows.

    At stride 8 a cell's objectness is the mean of red less green over a window around it where no window nearby is more
    red (of equals, the one with more red beside it), the class is car, and the box is a little larger than the window,
    to hold the whole car. The cells of strides 16 and 32 find nothing.
    """
    height, width = WINDOW_HW
    nodes = [
        helper.make_node("Mul", ["images", "red_less_green"], ["weighted"]),
        helper.make_node("ReduceSum", ["weighted", "channel_axis"], ["redness"], keepdims=1),
        helper.make_node("Clip", ["redness", "zero", "one"], ["red"]),
        _mean_at_stride_8("red", "window_red_alone", height, width),
        _mean_at_stride_8("red", "wide_red", height, 2 * width),
        helper.make_node("Mul", ["wide_red", "tie_breaker"], ["little_wide_red"]),
        helper.make_node("Mul", ["window_red_alone", "nearly_one"], ["most_window_red"]),
        helper.make_node("Add", ["most_window_red", "little_wide_red"], ["window_red"]),
        helper.make_node("MaxPool", ["window_red"], ["peak"], kernel_shape=[5, 9], pads=[2, 4, 2, 4]),
        helper.make_node("GreaterOrEqual", ["window_red", "peak"], ["is_peak"]),
        helper.make_node("Cast", ["is_peak"], ["peak_mask"], to=TensorProto.FLOAT),
        helper.make_node("Mul", ["window_red", "peak_mask"], ["fine"]),
        helper.make_node("MaxPool", ["red"], ["medium_red"], kernel_shape=[16, 16], strides=[16, 16]),
        helper.make_node("MaxPool", ["red"], ["coarse_red"], kernel_shape=[32, 32], strides=[32, 32]),
        helper.make_node("Mul", ["medium_red", "zero"], ["medium"]),
        helper.make_node("Mul", ["coarse_red", "zero"], ["coarse"]),
    ]
    nodes += [
        *(
            helper.make_node("Reshape", [scale, "column"], [f"{scale}_column"])
            for scale in ("fine", "medium", "coarse")
        ),
        helper.make_node("Concat", ["fine_column", "medium_column", "coarse_column"], ["objectness"], axis=1),
        helper.make_node("Mul", ["objectness", "zero"], ["nothing"]),
        helper.make_node("Add", ["nothing", "box_row"], ["boxes"]),
        helper.make_node("Add", ["nothing", "class_row"], ["classes"]),
        helper.make_node("Concat", ["boxes", "objectness", "classes"], ["output"], axis=2),
    ]
    classes = np.zeros((1, 1, 80), np.float32)
    classes[..., 2] = 1.0
    box = np.array([[[0.5, 0.5, np.log(BOX_HW[1] / 8), np.log(BOX_HW[0] / 8)]]], np.float32)
    constants = {
        "red_less_green": np.array([0.0, -1 / 160, 1 / 160], np.float32).reshape(1, 3, 1, 1),
        "channel_axis": np.array([1], np.int64),
        "zero": np.array(0.0, np.float32),
        "one": np.array(1.0, np.float32),
        "nearly_one": np.array(0.99, np.float32),
        "tie_breaker": np.array(0.01, np.float32),
        "column": np.array([0, -1, 1], np.int64),
        "box_row": box,
        "class_row": classes,
    }
    graph = helper.make_graph(
        nodes,
        "red windows",
        [helper.make_tensor_value_info("images", TensorProto.FLOAT, ["batch", 3, "height", "width"])],
        [helper.make_tensor_value_info("output", TensorProto.FLOAT, ["batch", "anchors", 85])],
        [numpy_helper.from_array(value, name) for name, value in constants.items()],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)], ir_version=8)
    onnx.checker.check_model(model)
    onnx.save(model, str(path))
    return path


def _mean_at_stride_8(name: str, result: str, height: int, width: int) -> onnx.NodeProto:
    """The mean over a window around every cell of stride 8; what lies outside of the image counts as 0."""
    return helper.make_node(
        "AveragePool",
        [name],
        [result],
        kernel_shape=[height, width],
        strides=[8, 8],
        pads=[height // 2 - 4, width // 2 - 4] * 2,
        count_include_pad=1,
    )


def _write_calibration(folder: Path) -> None:
    names = list(CAMERA_YAW_DEG)
    quaternions = [Rotation.from_matrix(ego_SE3_camera(name)[:3, :3]).as_quat() for name in names]
    _write_table(
        folder / "egovehicle_SE3_sensor.feather",
        {"sensor_name": names}
        | {key: [float(q[index]) for q in quaternions] for key, index in (("qw", 3), ("qx", 0), ("qy", 1), ("qz", 2))}
        | {"tx_m": [0.0] * 2, "ty_m": [0.0] * 2, "tz_m": [1.5] * 2},
    )
    _write_table(
        folder / "intrinsics.feather",
        {"sensor_name": names}
        | {"fx_px": [FOCAL_PX] * 2, "fy_px": [FOCAL_PX] * 2, "cx_px": [WIDTH_PX / 2] * 2, "cy_px": [HEIGHT_PX / 2] * 2}
        | {"k1": [0.0] * 2, "k2": [0.0] * 2, "k3": [0.0] * 2}
        | {"height_px": [HEIGHT_PX] * 2, "width_px": [WIDTH_PX] * 2},
    )


def _write_sweep(path: Path, cars: list[Car]) -> None:
    """Points on the side of each car that faces the ego car, and on the ground around."""
    path.parent.mkdir(parents=True, exist_ok=True)
    along, up = np.meshgrid(np.linspace(-0.5, 0.5, 45), np.linspace(-0.45, 0.5, 10))
    length_m, width_m, height_m = CAR_SIZE_M
    points = [_ground()]
    for car in cars:
        local = np.stack([along.ravel() * length_m, np.full(along.size, width_m / 2), up.ravel() * height_m], axis=1)
        turn = Rotation.from_euler("z", car.yaw_rad).as_matrix()
        points.append(local @ turn.T + car.center_m)
    xyz_m = np.concatenate(points).astype(np.float32)
    _write_table(
        path,
        {"x": xyz_m[:, 0], "y": xyz_m[:, 1], "z": xyz_m[:, 2], "intensity": np.zeros(len(xyz_m), np.uint8)},
    )


def _ground() -> NDArray[np.float64]:
    range_m, bearing = np.meshgrid(np.arange(4.0, 40.0, 0.5), np.radians(np.arange(-90, 150, 1.0)))
    return np.stack(
        [range_m.ravel() * np.cos(bearing.ravel()), range_m.ravel() * np.sin(bearing.ravel()), np.zeros(range_m.size)],
        axis=1,
    )


def _write_table(path: Path, columns: Mapping[str, object]) -> None:
    feather.write_feather(pa.table(columns), str(path))
