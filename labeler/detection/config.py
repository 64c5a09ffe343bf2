"""How to detect: plain values, so that the pipeline can hash them."""

from dataclasses import dataclass

from labeler.detection.classes import ROAD_USER_CLASSES

LARGEST_STRIDE_PX = 32
"""YOLOX shrinks the image by 8, 16 and 32: the sides of its input are multiples of this."""


@dataclass(frozen=True)
class DetectionConfig:
    """Settings of the detection step. ValueError when one is out of range.

    - ``min_score``: boxes below are dropped. Low on purpose: later steps use weak boxes to bridge gaps.
    - ``nms_iou``: of two boxes that overlap more, the weaker is dropped. 0.65 as in YOLOX's own evaluation (``nmsthre``
      in yolox/exp/yolox_base.py of github.com/Megvii-BaseDetection/YOLOX).
    - ``classes``: names of the classes to keep; they become the detector's ``class_names``, in this order, without
      those that the model does not know.
    - ``input_long_side_px``: longest side of the network's input where the model's shape is free. An image is never
      enlarged. A multiple of 32. With YOLOX-nano, 960 finds as many vehicles as 1280 in half the time.
    - ``batch_size``: images in one run where the model's batch is free; None is 1 on the CPU, 8 on a GPU.
    - ``tile_aspect``: where the model's shape is fixed, an image at least this many times as wide (or as high) as the
      shape, relative to its other side, is cut into tiles; no tile is that wide.
    - ``tile_overlap``: share of a tile that the next one sees too. An object narrower than that is whole in one.
    - ``max_candidates``: this many best boxes of an image, or tile, go into non-maximum suppression.
    """

    min_score: float = 0.05
    nms_iou: float = 0.65
    classes: tuple[str, ...] = ROAD_USER_CLASSES
    input_long_side_px: int = 960
    batch_size: int | None = None
    tile_aspect: float = 2.0
    tile_overlap: float = 0.2
    max_candidates: int = 2000

    def __post_init__(self) -> None:
        if not 0 < self.min_score < 1:
            raise ValueError(f"min_score must lie between 0 and 1, got {self.min_score}")
        if not 0 < self.nms_iou <= 1:
            raise ValueError(f"nms_iou must be above 0 and at most 1, got {self.nms_iou}")
        if not self.classes:
            raise ValueError("classes must name at least one class")
        if self.input_long_side_px < LARGEST_STRIDE_PX or self.input_long_side_px % LARGEST_STRIDE_PX:
            raise ValueError(
                f"input_long_side_px must be a positive multiple of {LARGEST_STRIDE_PX}, got {self.input_long_side_px}"
            )
        if self.batch_size is not None and self.batch_size < 1:
            raise ValueError(f"batch_size must be at least 1, got {self.batch_size}")
        if not self.tile_aspect > 1:
            raise ValueError(f"tile_aspect must be above 1, got {self.tile_aspect}")
        if not 0 <= self.tile_overlap < 1:
            raise ValueError(f"tile_overlap must be at least 0 and below 1, got {self.tile_overlap}")
        if self.max_candidates < 1:
            raise ValueError(f"max_candidates must be at least 1, got {self.max_candidates}")
