"""Directions that say what they hold without a simulator: upright sides of boxes, painted as vehicles."""

import numpy as np

from labeler.training.clouds import DirectionSweep

CAR_M = (4.4, 1.8, 1.5)


def direction(*cars: tuple[float, float, float], clutter: int = 30, seed: int = 0) -> DirectionSweep:
    """A car for each ``(x_m, y_m, yaw_deg)``, points on all four sides, and painted ``clutter`` of buildings."""
    rng = np.random.default_rng(seed)
    length_m, width_m, height_m = CAR_M
    points = [np.column_stack([rng.uniform(5, 45, (clutter, 2)) * [1, 0.3], rng.uniform(0.5, 4, clutter)])]
    for x_m, y_m, yaw_deg in cars:
        share = rng.uniform(-0.5, 0.5, (120, 2)) * [length_m, width_m]
        on_side = np.where(rng.random((120, 1)) < 0.5, [[0, 1]], [[1, 0]]).astype(bool)
        share = np.where(on_side, np.sign(share) * [length_m / 2, width_m / 2], share)
        cos, sin = np.cos(np.radians(yaw_deg)), np.sin(np.radians(yaw_deg))
        xy_m = share @ np.array([[cos, sin], [-sin, cos]]) + [x_m, y_m]
        points.append(np.column_stack([xy_m, rng.uniform(0.3, height_m, 120)]))
    xyz_m = np.concatenate(points)
    rest = np.zeros((len(xyz_m), 5), np.uint8)
    rest[:, 0], rest[:, 1] = 128, 255  # intensity; seen
    rest[:clutter, 3], rest[clutter:, 2] = 255, 255  # building, vehicle
    truth = [(x, y, height_m / 2, *CAR_M, np.radians(yaw_deg)) for x, y, yaw_deg in cars]
    return DirectionSweep(
        xyz_cm=np.rint(xyz_m * 100).astype(np.int16),
        rest=rest,
        truth=np.array(truth, np.float32).reshape(-1, 7),
        classes=np.zeros(len(cars), np.int8),
        asked=np.ones(len(cars), np.bool_),
        reach_rad=np.radians([-50.0, 50.0]).astype(np.float32),
    )
