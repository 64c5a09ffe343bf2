"""What stands where in an image: semantic segmentation on onnxruntime, for painting LiDAR points."""

from labeler.segmentation.errors import SegmentationError
from labeler.segmentation.model import CITYSCAPES_CLASSES
from labeler.segmentation.network import Segmenter, open_segmenter
from labeler.segmentation.types import SegmentationScores

__all__ = ["CITYSCAPES_CLASSES", "SegmentationError", "SegmentationScores", "Segmenter", "open_segmenter"]
