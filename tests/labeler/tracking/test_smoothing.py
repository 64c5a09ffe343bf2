"""Smooth paths equal filterpy's Rauch-Tung-Striebel smoother, track by track."""

import numpy as np
from filterpy.kalman import KalmanFilter

from labeler.tracking import TrackingConfig
from labeler.tracking.smoothing import TrackBoxes, smooth

# without growth the noise, which follows the box's size, stays the same; following back asks for variances too
CONFIG = TrackingConfig(smooth_growth_ratio=0.0, follow_back=True)


def expected_x(
    x: np.ndarray, seen: np.ndarray, noise: np.ndarray, time_s: np.ndarray, size: float
) -> tuple[np.ndarray, np.ndarray]:
    """(F, 2) smooth centre x and its speed of a box whose size does not change, and (F, 2) their variances, by
    filterpy."""
    error = (CONFIG.smooth_measurement_std_sizes * size * noise) ** 2
    density = (CONFIG.smooth_speed_change_std_sizes * size) ** 2
    one = KalmanFilter(dim_x=2, dim_z=1)
    one.x = np.array([[x[0]], [0.0]])
    one.P = np.diag([error[0], (CONFIG.initial_speed_std_sizes * size) ** 2])
    one.H = np.array([[1.0, 0.0]])
    means, covariances, transitions, noises = [one.x], [one.P], [np.eye(2)], [np.zeros((2, 2))]
    for k in range(1, len(time_s)):
        dt = time_s[k] - time_s[k - 1]
        one.F = np.array([[1.0, dt], [0.0, 1.0]])
        one.Q = density * np.array([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]])
        one.predict()
        if seen[k]:
            one.update(np.array([[x[k]]]), R=np.array([[error[k]]]))
        means.append(one.x)
        covariances.append(one.P)
        transitions.append(one.F)
        noises.append(one.Q)
    smooth_means, smooth_covariances, *_ = one.rts_smoother(np.array(means), np.array(covariances), transitions, noises)
    return smooth_means[:, :, 0], np.diagonal(smooth_covariances, axis1=1, axis2=2)


def test_equals_filterpy() -> None:
    """Two tracks of different length and beginning, frames at uneven times, one track with a gap."""
    random = np.random.default_rng(0)
    time_s = np.cumsum(random.uniform(0.05, 0.3, 15))
    frames = [np.array([0, 1, 2, 5, 6, 7, 8, 9]), np.arange(4, 15)]
    xs = [random.normal(0, 10, 15) + 100, random.normal(0, 10, 15) + 400]
    noises = [random.uniform(1, 4, 15), random.uniform(1, 4, 15)]
    track = np.repeat([0, 1], [len(one) for one in frames])
    x = np.concatenate([of[one] for of, one in zip(xs, frames, strict=True)])
    boxes = np.stack([x - 20, np.full_like(x, 50.0), x + 20, np.full_like(x, 90.0)], axis=1)
    noise = np.concatenate([of[one] for of, one in zip(noises, frames, strict=True)])
    paths = smooth(TrackBoxes(track, np.concatenate(frames), boxes, noise), time_s, CONFIG)

    for number, (own, of_x, of_noise) in enumerate(zip(frames, xs, noises, strict=True)):
        rows = paths.track == number
        span = np.arange(own[0], own[-1] + 1)
        assert paths.frame[rows].tolist() == span.tolist()
        means, variances = expected_x(of_x[span], np.isin(span, own), of_noise[span], time_s[span], 40.0)
        np.testing.assert_allclose(paths.position[rows, 0], means[:, 0])
        np.testing.assert_allclose(paths.speed[rows, 0], means[:, 1])
        np.testing.assert_allclose(paths.variance[rows, 0], variances[:, 0])
        np.testing.assert_allclose(paths.speed_variance[rows, 0], variances[:, 1])
        np.testing.assert_allclose(paths.xyxy_px[rows][:, 2] - paths.xyxy_px[rows][:, 0], 40.0)


def test_nothing_to_smooth() -> None:
    none = np.zeros(0, np.int64)
    assert len(smooth(TrackBoxes(none, none, np.zeros((0, 4)), np.zeros(0)), np.zeros(0), CONFIG).track) == 0
