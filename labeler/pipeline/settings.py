"""What a user may set about a run, room by room."""

from dataclasses import dataclass, field

from labeler.detection import DetectionConfig
from labeler.identity import IdentityConfig
from labeler.lidar import LidarConfig
from labeler.propagation import PropagationConfig
from labeler.tracking import TrackingConfig


@dataclass(frozen=True)
class LabelSettings:
    """The settings of every step. Each changes the key of its own step's artifacts and of those that follow."""

    detection: DetectionConfig = field(default_factory=DetectionConfig)
    tracking: TrackingConfig = field(default_factory=TrackingConfig)
    lidar: LidarConfig = field(default_factory=LidarConfig)
    identity: IdentityConfig = field(default_factory=IdentityConfig)
    propagation: PropagationConfig = field(default_factory=PropagationConfig)
