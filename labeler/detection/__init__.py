"""Step 2: finds road users in images with YOLOX on onnxruntime."""

from labeler.detection.classes import COCO_CLASSES, ROAD_USER_CLASSES, VEHICLE_CLASSES
from labeler.detection.config import DetectionConfig
from labeler.detection.errors import DetectionError
from labeler.detection.types import Detections, Detector
from labeler.detection.yolox import YoloxDetector, open_detector

__all__ = [
    "COCO_CLASSES",
    "ROAD_USER_CLASSES",
    "VEHICLE_CLASSES",
    "DetectionConfig",
    "DetectionError",
    "Detections",
    "Detector",
    "YoloxDetector",
    "open_detector",
]
