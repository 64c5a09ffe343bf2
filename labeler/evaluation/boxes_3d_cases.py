"""Runs the LiDAR step over a drive with 3D truth, and puts each true object beside its box.

Detections are the true 2D boxes of whole objects, cut by the image's edge, or a detector's. With a detector's, a true
object's detection is the one that overlaps it by an IoU of at least .5, one to one.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from labeler.detection.types import Detections, Detector
from labeler.drive import Drive, Frame, read_image
from labeler.drive.types import Camera, Sweep, Truth, TruthBoxes2D, TruthBoxes3D
from labeler.evaluation.boxes_3d import (
    AP_MAX_DISTANCE_M,
    AP_MIN_POINTS,
    GOOD_IOU,
    BoxCases,
    BoxReport,
    RankedBoxes,
    report_boxes,
)
from labeler.evaluation.categories import CLASSES, class_of_category
from labeler.evaluation.types import EvaluationError
from labeler.geometry.boxes_2d import iou_matrix
from labeler.geometry.boxes_3d import iou_3d
from labeler.lidar import Boxes3D, CameraInput, LidarConfig, PixelScores, View, open_box_maker, prepare_scene
from labeler.pipeline.lidar_units import lidar_frame
from labeler.segmentation import Segmenter

_MIN_PIXELS = 30
_MIN_IOU = 0.5
_TRUE_SCORE = 0.9
_BORDER_PX = 2.0
_NEAR_BOX_M = 0.1

FindBoxes = Callable[[Frame, Sweep, Mapping[str, Detections], Mapping[str, PixelScores]], Mapping[str, Boxes3D]]
"""The LiDAR step of one frame: boxes of each camera from the frame's sweep, its detections and segmentations."""


@dataclass(frozen=True, eq=False)
class TrueObjects:
    """The true vehicles of one image: ``object_id`` and ``category_class`` (T,), ``xyxy_px`` (T, 4) whole boxes, and
    their 3D boxes ``center_m`` (T, 3), ``size_m`` (T, 3), ``yaw_rad`` (T,). ``shown`` (T,) bool: enough pixels show it.
    """

    object_id: NDArray[np.int32]
    category_class: NDArray[np.int16]
    xyxy_px: NDArray[np.float32]
    center_m: NDArray[np.float64]
    size_m: NDArray[np.float64]
    yaw_rad: NDArray[np.float64]
    shown: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.object_id)


@dataclass(frozen=True)
class Seen:
    """What the images say. ``detections`` gives those of one image of a frame, None stands for the true ones (whose
    classes are :data:`labeler.evaluation.categories.CLASSES`); ``scores`` its segmentation, None where there is none.
    """

    detections: Callable[[Frame, str], Detections] | None = None
    scores: Callable[[Frame, str], PixelScores] | None = None

    @staticmethod
    def by(drive: Drive, detector: Detector | None, segmenter: Segmenter | None) -> Seen:
        """What a detector and a segmentation say of a drive's images."""

        def detect(frame: Frame, camera: str) -> Detections:
            assert detector is not None
            return detector.detect([read_image(frame.images[camera], drive.camera(camera))])[0]

        def segment(frame: Frame, camera: str) -> PixelScores:
            assert segmenter is not None
            return segmenter.segment(read_image(frame.images[camera], drive.camera(camera)))

        return Seen(None if detector is None else detect, None if segmenter is None else segment)


def find_boxes(drive: Drive, config: LidarConfig, detector: Detector | None) -> FindBoxes:
    """The pipeline's LiDAR step by the maker that ``config`` names, on detections of ``detector``, or true ones."""
    maker = open_box_maker(config, class_names=CLASSES if detector is None else detector.class_names)

    def boxes(
        frame: Frame, sweep: Sweep, found: Mapping[str, Detections], scores: Mapping[str, PixelScores]
    ) -> Mapping[str, Boxes3D]:
        motion = lidar_frame(frame, frame.sweep, drive.poses).image_ego_SE3_frame_ego
        cameras = {
            name: CameraInput(View.of(drive.camera(name), motion[name]), detections, scores.get(name))
            for name, detections in found.items()
        }
        return maker.boxes(prepare_scene(sweep, config), cameras)

    return boxes


def judge_makers(
    drive: Drive, makers: Mapping[str, FindBoxes], seen: Seen, *, progress: Callable[[], None] = lambda: None
) -> dict[str, BoxReport]:
    """Run the LiDAR step by every maker over every frame with a sweep, and judge its boxes. All see the same.
    ``progress`` is called after each frame.

    EvaluationError where the drive has no 3D truth, no true boxes in images, or no sweeps with calibrated cameras.
    """
    images = _images_of(_require_truth(drive))
    cameras = [camera for camera in drive.cameras if camera.calibration is not None]
    judges = {name: _Judge(cameras, exact=seen.detections is None) for name in makers}
    for frame in drive.frames:
        if frame.sweep is None:
            continue
        names = [camera.name for camera in cameras if camera.name in frame.images]
        objects = {name: images.get((frame.index, name), _no_objects()) for name in names}
        if seen.detections is None:
            found = {name: _true_detections(true) for name, true in objects.items()}
        else:
            found = {name: seen.detections(frame, name) for name in objects}
        scores = {} if seen.scores is None else {name: seen.scores(frame, name) for name in names}
        sweep = drive.read_sweep(frame.sweep)
        points = {name: _points_in(true, sweep.xyz_m) for name, true in objects.items()}
        for name, boxes_of in makers.items():
            begin = time.thread_time()  # the networks' own threads spin on for a while after they have answered
            boxes = boxes_of(frame, sweep, found, scores)
            judges[name].add(frame.index, boxes, objects, points, found, seconds=time.thread_time() - begin)
        progress()
    if not all(judge.parts for judge in judges.values()):
        raise EvaluationError(
            f"{drive.root} has no LiDAR sweep beside an image of a calibrated camera: nothing to box."
        )
    return {name: judge.report() for name, judge in judges.items()}


class _Judge:
    """Gathers, frame by frame, what the boxes of one maker are worth."""

    def __init__(self, cameras: Sequence[Camera], *, exact: bool) -> None:
        """``exact``: detections are the true ones, in the order of the objects that are shown."""
        self._sizes_px = {camera.name: (camera.width_px, camera.height_px) for camera in cameras}
        self._exact = exact
        self.parts: list[BoxCases] = []
        self._scores: list[NDArray[np.float32]] = []
        self._hits: list[NDArray[np.bool_]] = []
        self._truth_count, self._frames, self._seconds = 0, 0, 0.0

    def add(
        self, frame_index: int, boxes: Mapping[str, Boxes3D], objects: Mapping[str, TrueObjects],
        points: Mapping[str, NDArray[np.int32]], found: Mapping[str, Detections], *, seconds: float,
    ) -> None:  # fmt: skip
        """The boxes of a frame, beside the true objects in its images and the LiDAR ``points`` on each."""
        self._frames += 1
        self._seconds += seconds
        numbers = {name: number for number, name in enumerate(self._sizes_px)}
        for name, true in objects.items():
            own = boxes.get(name, Boxes3D.empty())
            detection = _detection_of(true, found[name], exact=self._exact)
            self.parts.append(
                _cases(frame_index, numbers[name], true, points[name], detection, own, self._sizes_px[name])
            )
            near = np.hypot(*true.center_m[:, :2].T) <= AP_MAX_DISTANCE_M
            counted = true.shown & (points[name] >= AP_MIN_POINTS) & near
            score, is_hit = _ranked(own, true, counted)
            self._scores.append(score)
            self._hits.append(is_hit)
            self._truth_count += int(counted.sum())

    def report(self) -> BoxReport:
        ranked = RankedBoxes(np.concatenate(self._scores), np.concatenate(self._hits), self._truth_count)
        cpu_ms = 1000 * self._seconds / self._frames
        return report_boxes(_joined(self.parts), ranked, frames=self._frames, cpu_ms_per_frame=cpu_ms)


def _require_truth(drive: Drive) -> Truth:
    truth = drive.read_truth(drive.frames)
    if truth is None or truth.boxes_3d is None or truth.boxes_2d is None:
        raise EvaluationError(
            f"{drive.root} has no true 3D boxes together with true boxes in images, so 3D boxes can't be judged. "
            "Simulated drives have both: hindsight simulate."
        )
    return truth


def _images_of(truth: Truth) -> dict[tuple[int, str], TrueObjects]:
    """The vehicles that have a box in an image and in 3D, by frame and camera."""
    flat, solid = truth.boxes_2d, truth.boxes_3d
    assert flat is not None
    assert solid is not None
    number_of = {uuid: number for number, uuid in enumerate(dict.fromkeys(solid.track_uuid))}
    solid_row = {key: row for row, key in enumerate(zip(solid.frame_index.tolist(), solid.track_uuid, strict=True))}
    rows_of: dict[tuple[int, str], list[tuple[int, int]]] = {}
    for row, (frame, camera, uuid) in enumerate(
        zip(flat.frame_index.tolist(), flat.camera, flat.track_uuid, strict=True)
    ):
        other = solid_row.get((frame, uuid))
        if other is not None and class_of_category(flat.category[row]) >= 0:
            rows_of.setdefault((frame, camera), []).append((row, other))
    return {key: _objects(flat, solid, rows, number_of) for key, rows in rows_of.items()}


def _objects(
    flat: TruthBoxes2D, solid: TruthBoxes3D, rows: Sequence[tuple[int, int]], number_of: Mapping[str, int]
) -> TrueObjects:
    in_image, in_space = np.array(rows, np.intp).T
    pixels = flat.visible_pixels
    classes = [class_of_category(flat.category[row]) for row, _ in rows]
    return TrueObjects(
        object_id=np.array([number_of[flat.track_uuid[row]] for row, _ in rows], np.int32),
        category_class=np.array(classes, np.int16),
        xyxy_px=flat.xyxy_px[in_image],
        center_m=solid.center_m[in_space],
        size_m=solid.size_m[in_space],
        yaw_rad=solid.yaw_rad[in_space],
        shown=np.ones(len(rows), np.bool_) if pixels is None else pixels[in_image] >= _MIN_PIXELS,
    )


def _no_objects() -> TrueObjects:
    return TrueObjects(
        np.zeros(0, np.int32), np.zeros(0, np.int16), np.zeros((0, 4), np.float32),
        np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros(0, np.bool_),
    )  # fmt: skip


def _true_detections(true: TrueObjects) -> Detections:
    """A detection for each object that is shown, in their order."""
    shown = np.flatnonzero(true.shown)
    return Detections(true.xyxy_px[shown], np.full(len(shown), _TRUE_SCORE, np.float32), true.category_class[shown])


def _detection_of(true: TrueObjects, found: Detections, *, exact: bool) -> NDArray[np.intp]:
    """(T,) the row of each object's detection, -1 where it has none."""
    row = np.full(len(true), -1, np.intp)
    if exact:
        row[true.shown] = np.arange(int(true.shown.sum()))
        return row
    iou = iou_matrix(true.xyxy_px, found.xyxy_px)
    iou = np.where(iou >= _MIN_IOU, iou, 0.0)
    objects, detections = linear_sum_assignment(-iou)
    good = iou[objects, detections] > 0
    row[objects[good]] = detections[good]
    return row


def _points_in(true: TrueObjects, xyz_m: NDArray[np.float32]) -> NDArray[np.int32]:
    """(T,) how many LiDAR points lie in each true box, or within a hand's breadth of it."""
    count = np.zeros(len(true), np.int32)
    for row in range(len(true)):
        off_m = xyz_m - true.center_m[row].astype(np.float32)
        half_m = true.size_m[row] / 2 + _NEAR_BOX_M
        near = (np.abs(off_m[:, :2]) <= np.hypot(half_m[0], half_m[1])).all(axis=1)
        off_m = off_m[near]
        cos, sin = np.cos(true.yaw_rad[row]), np.sin(true.yaw_rad[row])
        inside = np.abs(cos * off_m[:, 0] + sin * off_m[:, 1]) <= half_m[0]
        inside &= np.abs(cos * off_m[:, 1] - sin * off_m[:, 0]) <= half_m[1]
        count[row] = np.count_nonzero(inside & (np.abs(off_m[:, 2]) <= half_m[2]))
    return count


def _cases(
    frame_index: int, camera: int, true: TrueObjects, points: NDArray[np.int32], detection: NDArray[np.intp],
    boxes: Boxes3D, size_px: tuple[int, int],
) -> BoxCases:  # fmt: skip
    """Those objects that the image shows."""
    row_of = {detection: row for row, detection in enumerate(boxes.detection_index.tolist())}
    count = len(true)
    error_m, iou, yaw_off, xy_m = (
        np.full(count, np.nan),
        np.zeros(count),
        np.full(count, np.nan),
        np.full((count, 2), np.nan),
    )
    boxed = np.zeros(count, np.bool_)
    for case in range(count):
        row = row_of.get(int(detection[case]), -1)
        if row < 0:
            continue
        boxed[case] = True
        xy_m[case] = boxes.center_m[row, :2]
        error_m[case] = np.hypot(*(xy_m[case] - true.center_m[case, :2]))
        iou[case] = _bev_iou(boxes, row, true, case)
        turn = float(boxes.yaw_rad[row]) - float(true.yaw_rad[case])
        yaw_off[case] = abs((turn + np.pi / 2) % np.pi - np.pi / 2)
    low, high = true.xyxy_px[:, :2], true.xyxy_px[:, 2:]
    cut = (low <= _BORDER_PX).any(axis=1) | (high >= np.array(size_px) - _BORDER_PX).any(axis=1)
    cases = BoxCases(
        frame_index=np.full(count, frame_index, np.int32),
        camera=np.full(count, camera, np.int16),
        object_id=true.object_id,
        category_class=true.category_class,
        distance_m=np.hypot(true.center_m[:, 0], true.center_m[:, 1]),
        points=points,
        cut=np.asarray(cut),
        boxed=boxed,
        error_m=error_m,
        bev_iou=iou,
        yaw_off_rad=yaw_off,
        xy_m=xy_m,
    )
    return cases[true.shown]


def _ranked(
    boxes: Boxes3D, true: TrueObjects, counted: NDArray[np.bool_]
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Score and hit of the boxes of one image, the surest first choosing; without those that hit what isn't counted."""
    free = np.ones(len(true), np.bool_)
    score: list[float] = []
    hit: list[bool] = []
    for row in np.argsort(-boxes.score, kind="stable").tolist():
        iou = np.array([_bev_iou(boxes, row, true, case) if free[case] else 0.0 for case in range(len(true))])
        best = int(iou.argmax()) if len(iou) else -1
        if best >= 0 and iou[best] >= GOOD_IOU:
            free[best] = False
            if not counted[best]:
                continue
        elif float(np.hypot(*boxes.center_m[row, :2])) > AP_MAX_DISTANCE_M:
            continue
        score.append(float(boxes.score[row]))
        hit.append(best >= 0 and bool(iou[best] >= GOOD_IOU))
    return np.array(score, np.float32), np.array(hit, np.bool_)


def _bev_iou(boxes: Boxes3D, row: int, true: TrueObjects, case: int) -> float:
    if np.hypot(*(boxes.center_m[row, :2] - true.center_m[case, :2])) > np.hypot(
        *(true.size_m[case, :2] + boxes.size_m[row, :2])
    ):
        return 0.0
    return iou_3d(
        boxes.center_m[row], boxes.size_m[row], float(boxes.yaw_rad[row]),
        true.center_m[case], true.size_m[case], float(true.yaw_rad[case]),
    )[1]  # fmt: skip


def _joined(parts: list[BoxCases]) -> BoxCases:
    names: Iterator[str] = iter(BoxCases.__dataclass_fields__)
    return BoxCases(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})
