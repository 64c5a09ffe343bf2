import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray

from labeler.identity.smoothing import Measured, MotionConfig, predict, smooth

CONFIG = MotionConfig(speed_change_mps=1.5, initial_speed_mps=10.0, correlation_s=0.0, outlier_sigmas=1e9)


def drive_by(count: int, seed: int, step_s: float = 0.1) -> Measured:
    """10 m/s along x from x = 3, with noise of 0.5 m along and 0.1 m across; every fifth place is missing."""
    random = np.random.default_rng(seed)
    frames = np.array([frame for frame in range(count) if frame % 5 != 4])
    time_s = frames * step_s
    xy_m = np.stack([3 + 10 * time_s, 0 * time_s], axis=1) + random.normal(0, [0.5, 0.1], (len(frames), 2))
    return Measured(frames, time_s, xy_m, np.tile(np.diag([0.25, 0.01]), (len(frames), 1, 1)))


def by_filterpy(track: Measured) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The same model in filterpy, its matrices written out anew."""
    kalman = KalmanFilter(dim_x=4, dim_z=2)
    kalman.H = np.eye(2, 4)
    kalman.x = np.array([*track.xy_m[0], 0, 0], float)
    kalman.P = np.zeros((4, 4))
    kalman.P[:2, :2] = track.cov_m2[0]
    kalman.P[2, 2] = kalman.P[3, 3] = 100.0
    means, covs = [kalman.x.copy()], [kalman.P.copy()]
    transitions: list[NDArray[np.float64]] = [np.eye(4)]
    noises: list[NDArray[np.float64]] = [np.zeros((4, 4))]
    for row in range(1, len(track.time_s)):
        dt = track.time_s[row] - track.time_s[row - 1]
        transition = np.eye(4)
        transition[0, 2] = transition[1, 3] = dt
        one = 1.5**2 * np.array([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]])
        noise = np.kron(one, np.eye(2)).astype(np.float64)
        kalman.predict(F=transition, Q=noise)
        kalman.update(track.xy_m[row], R=track.cov_m2[row])
        means.append(kalman.x.copy())
        covs.append(kalman.P.copy())
        transitions.append(transition)
        noises.append(noise)
    # filterpy takes the step from k to k + 1 from Fs[k + 1].
    mean, cov, _, _ = kalman.rts_smoother(np.array(means), np.array(covs), transitions, noises)
    return mean, cov


def test_many_tracks_at_once_equal_filterpy_one_by_one():
    tracks = [drive_by(30, 1), drive_by(4, 2), drive_by(1, 3), drive_by(55, 4, step_s=0.25)]
    for track, found in zip(tracks, smooth(tracks, CONFIG), strict=True):
        mean, cov = by_filterpy(track)
        np.testing.assert_allclose(found.mean, mean, rtol=1e-6, atol=1e-8)
        np.testing.assert_allclose(found.cov, cov, rtol=1e-6, atol=1e-8)
        assert found.frame_index.tolist() == track.frame_index.tolist()


def test_smoothing_finds_the_speed_at_both_ends():
    (found,) = smooth([drive_by(60, 5)], CONFIG)
    for row in (0, -1):
        assert found.mean[row, 2:] == pytest.approx([10, 0], abs=1.0)
        assert found.cov[row, 2, 2] < 1.0


def test_one_place_far_off_bends_no_trajectory():
    track = drive_by(41, 6)
    track.xy_m[16] += [0.0, 30.0]
    (found,) = smooth([track], MotionConfig(correlation_s=0.0))
    assert np.abs(found.mean[:, 1]).max() < 1.0


def test_errors_that_stay_count_as_one():
    often = drive_by(40, 7)
    (sure,), (doubtful,) = smooth([often], CONFIG), smooth([often], MotionConfig(correlation_s=0.8))
    assert doubtful.cov[20, 0, 0] > 3 * sure.cov[20, 0, 0]


def test_prediction_grows_unsure_in_both_directions():
    mean, cov = np.array([[1.0, 2.0, 3.0, 0.0]]), np.zeros((1, 4, 4))
    for dt in (2.0, -2.0):
        moved, spread = predict(mean, cov, np.array([dt]), MotionConfig(speed_change_mps=3.0))
        assert moved[0].tolist() == [1 + 3 * dt, 2, 3, 0]
        assert spread[0, 0, 0] == pytest.approx(9 * 8 / 3)
        assert spread[0, 0, 2] == pytest.approx(9 * 2 * np.sign(dt))
