"""The truth of a drive as evaluation needs it: in order of images, with classes, distances and what is not counted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.drive.types import Drive, Truth, TruthBoxes2D, TruthBoxes3D
from labeler.evaluation.categories import DONT_CARE, NOT_COUNTED, class_of_category
from labeler.evaluation.types import EvaluationConfig, EvaluationError
from labeler.geometry.boxes_2d import area


@dataclass(frozen=True, eq=False)
class TruthTable:
    """True vehicles and don't-care regions, a row each, in order of ``image`` (T,) int64: frame times cameras plus
    camera.

    ``camera`` (T,) int16; ``object_id`` (T,) int32, the same for one object in all images; ``category_class`` (T,)
    int16 as in :mod:`labeler.evaluation.categories`; ``counted`` (T,) bool: hit or miss, else it only absorbs labels;
    ``whole_px`` (T, 4) float32; ``visible_px`` likewise, None where no visible parts are recorded; ``distance_m`` (T,)
    float32, NaN where unknown; ``visible_share`` (T,) float32 in 0..1, None where it is not known.
    """

    image: NDArray[np.int64]
    camera: NDArray[np.int16]
    object_id: NDArray[np.int32]
    category_class: NDArray[np.int16]
    counted: NDArray[np.bool_]
    whole_px: NDArray[np.float32]
    visible_px: NDArray[np.float32] | None
    distance_m: NDArray[np.float32]
    visible_share: NDArray[np.float32] | None

    def __len__(self) -> int:
        return len(self.image)

    def __getitem__(self, rows: slice | NDArray[np.intp]) -> TruthTable:
        return TruthTable(
            self.image[rows],
            self.camera[rows],
            self.object_id[rows],
            self.category_class[rows],
            self.counted[rows],
            self.whole_px[rows],
            None if self.visible_px is None else self.visible_px[rows],
            self.distance_m[rows],
            None if self.visible_share is None else self.visible_share[rows],
        )

    def boxes_px(self, truth: str) -> NDArray[np.float32]:
        """The (T, 4) boxes of "whole" or "visible" objects. A region without a visible part has its whole box."""
        if truth == "whole":
            return self.whole_px
        if self.visible_px is None:
            raise ValueError("this truth has no boxes of visible parts")
        boxes_px = self.visible_px.copy()
        hidden = ~_is_box(boxes_px)
        boxes_px[hidden] = self.whole_px[hidden]
        return boxes_px


def image_number(frame_index: NDArray[np.int32], camera: NDArray[np.int16], camera_count: int) -> NDArray[np.int64]:
    """(N,) int64 number of the image of each row; images go by frame, then by camera."""
    return frame_index.astype(np.int64) * camera_count + camera


def prepare_truth(truth: Truth, cameras: Sequence[str], config: EvaluationConfig) -> TruthTable | None:
    """The vehicles and don't-care regions in images of ``cameras``; None where there are no true boxes in images.

    Where the 2D boxes have no distance, that of the same object's 3D box is taken, from the ego frame's origin on the
    ground. What is too far, or shows too few pixels or none, is not counted; what has no known distance is.
    """
    boxes = truth.boxes_2d
    if boxes is None:
        return None
    number_of = {name: number for number, name in enumerate(cameras)}
    camera = np.array([number_of.get(name, -1) for name in boxes.camera], np.int16)
    classes = {name: class_of_category(name) for name in set(boxes.category)}
    category_class = np.array([classes[name] for name in boxes.category], np.int16)
    kept = np.flatnonzero((camera >= 0) & (category_class != NOT_COUNTED) & _is_box(boxes.xyxy_px))
    image = image_number(boxes.frame_index, camera, len(cameras))
    rows = kept[np.lexsort((*boxes.xyxy_px[kept].T[::-1], image[kept]))]

    distance_m = _distances(boxes, truth.boxes_3d)[rows]
    visible_px = None if boxes.visible_xyxy_px is None else boxes.visible_xyxy_px[rows]
    with np.errstate(invalid="ignore"):
        counted = (category_class[rows] != DONT_CARE) & ~(distance_m > config.max_distance_m)
    if visible_px is not None:
        counted &= _is_box(visible_px)
    if boxes.visible_pixels is not None:
        counted &= boxes.visible_pixels[rows] >= config.min_visible_pixels
    object_ids = {uuid: number for number, uuid in enumerate(dict.fromkeys(boxes.track_uuid))}
    return TruthTable(
        image=image[rows],
        camera=camera[rows],
        object_id=np.array([object_ids[boxes.track_uuid[row]] for row in rows.tolist()], np.int32),
        category_class=category_class[rows],
        counted=counted,
        whole_px=boxes.xyxy_px[rows],
        visible_px=visible_px,
        distance_m=distance_m,
        visible_share=_visible_shares(boxes, rows),
    )


def true_boxes_of(drive: Drive, config: EvaluationConfig) -> TruthTable:
    """Those in the images of all of a drive's cameras; EvaluationError where it comes without."""
    truth = drive.read_truth(drive.frames)
    table = None if truth is None else prepare_truth(truth, tuple(camera.name for camera in drive.cameras), config)
    if table is None:
        raise EvaluationError(f"The drive {drive.name} has no true boxes in its images.")
    return table


def front_cameras(cameras: Sequence[str]) -> tuple[int, ...]:
    """Numbers of the cameras that look ahead: whose name says front and no side; the only one where there is one."""
    if len(cameras) == 1:
        return (0,)
    names = [name.lower() for name in cameras]
    return tuple(
        number
        for number, name in enumerate(names)
        if "front" in name and not any(side in name for side in ("left", "right", "side"))
    )


def _distances(boxes: TruthBoxes2D, boxes_3d: TruthBoxes3D | None) -> NDArray[np.float32]:
    """(N,) float32, NaN where unknown."""
    if boxes.distance_m is not None:
        return boxes.distance_m
    if boxes_3d is None:
        return np.full(len(boxes.camera), np.nan, np.float32)
    found = np.linalg.norm(boxes_3d.center_m[:, :2], axis=1).tolist()
    of_object = dict(zip(zip(boxes_3d.frame_index.tolist(), boxes_3d.track_uuid, strict=True), found, strict=True))
    moments = zip(boxes.frame_index.tolist(), boxes.track_uuid, strict=True)
    return np.array([of_object.get(moment, np.nan) for moment in moments], np.float32)


def _visible_shares(boxes: TruthBoxes2D, rows: NDArray[np.intp]) -> NDArray[np.float32] | None:
    """(T,) float32 as recorded, else the area of the visible box over that of the whole one."""
    if boxes.visible_share is not None:
        return boxes.visible_share[rows]
    if boxes.visible_xyxy_px is None:
        return None
    visible_px = boxes.visible_xyxy_px[rows]
    share = np.zeros(len(rows), np.float32)
    np.divide(area(visible_px), area(boxes.xyxy_px[rows]), out=share, where=_is_box(visible_px))
    share[share > 1] = 1
    return share


def _is_box(xyxy_px: NDArray[np.float32]) -> NDArray[np.bool_]:
    """(N,) whether a box has an area; one with NaN has none."""
    with np.errstate(invalid="ignore"):
        return (xyxy_px[:, 2] > xyxy_px[:, 0]) & (xyxy_px[:, 3] > xyxy_px[:, 1])
