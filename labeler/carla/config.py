"""What is recorded from CARLA. The defaults are the settings of the paper's Table II."""

from dataclasses import dataclass

from labeler.carla.errors import CarlaError

SHORTEST_S, LONGEST_S = 0.01, 0.25
"""Physics is reckoned in at most 16 steps of at most 1/60 s each, so moments can't lie farther apart."""


@dataclass(frozen=True)
class CarlaConfig:
    """A drive of ``frames`` moments, ``interval_s`` apart, in ``town``, with ``vehicles`` that are spawned, the ego car
    among them. Vehicles whose middle is within ``distance_m`` get a 3D box, and the LiDAR reaches as far.

    ``warm_up_s`` of traffic pass before the first moment. A call to the server, or the wait for a sensor, may take
    ``timeout_s``. ``traffic_port`` is that of the traffic manager. ``lidar_columns`` is readings of a beam a turn."""

    host: str = "127.0.0.1"
    port: int = 2000
    town: str = "Town10HD"
    vehicles: int = 60
    frames: int = 1000
    interval_s: float = 0.1
    seed: int = 0
    distance_m: float = 80.0
    width_px: int = 720
    height_px: int = 360
    jpeg_quality: int = 90
    lidar_channels: int = 64
    lidar_columns: int = 1024
    ego_model: str = "vehicle.tesla.model3"
    warm_up_s: float = 5.0
    traffic_port: int = 8000
    timeout_s: float = 60.0

    def __post_init__(self) -> None:
        if self.frames < 1 or self.vehicles < 1:
            raise CarlaError(f"At least 1 frame and 1 vehicle are needed, not {self.frames} and {self.vehicles}.")
        if not SHORTEST_S <= self.interval_s <= LONGEST_S:
            raise CarlaError(f"The interval must lie between {SHORTEST_S} and {LONGEST_S} s, not {self.interval_s}.")
        if not 1 <= self.lidar_channels <= 255:
            raise CarlaError(f"The LiDAR must have 1 to 255 channels, not {self.lidar_channels}.")
