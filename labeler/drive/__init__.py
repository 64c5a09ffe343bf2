"""What was recorded: drives in several layouts, opened as one set of types."""

from labeler.drive.errors import DriveError, DriveFileError
from labeler.drive.images import read_image
from labeler.drive.registry import open_drive, open_truth
from labeler.drive.simulated import SIMULATION_FILE, is_simulated
from labeler.drive.types import (
    Calibration,
    Camera,
    Drive,
    Frame,
    ImageFile,
    Poses,
    Sweep,
    SweepFile,
    SweepReader,
    Truth,
    TruthBoxes2D,
    TruthBoxes3D,
    TruthReader,
)

__all__ = [
    "SIMULATION_FILE",
    "Calibration",
    "Camera",
    "Drive",
    "DriveError",
    "DriveFileError",
    "Frame",
    "ImageFile",
    "Poses",
    "Sweep",
    "SweepFile",
    "SweepReader",
    "Truth",
    "TruthBoxes2D",
    "TruthBoxes3D",
    "TruthReader",
    "is_simulated",
    "open_drive",
    "open_truth",
    "read_image",
]
