"""What stands where in an image: semantic segmentation on onnxruntime, for painting LiDAR points."""

from labeler.segmentation.types import SegmentationScores

__all__ = ["SegmentationScores"]
