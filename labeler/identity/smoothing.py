"""Smooth trajectories in the world: a Kalman filter with constant velocity forwards, Rauch-Tung-Striebel backwards.

The state is x, y in metres and their speeds in metres a second. Many trajectories of different lengths go through the
filter side by side, step by step, because one call of a filter for each track and time would take most of the time of
the whole identity step. A measurement far from where it is expected counts less (Huber's weight): a box on the wrong
thing bends a trajectory but does not break it. Against :mod:`filterpy`, the numbers are held by a test.

Source: Rauch, Tung, Striebel, Maximum likelihood estimates of linear dynamic systems, AIAA Journal 1965.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class MotionConfig:
    """``speed_change_mps``: by how much a speed changes within a second (standard deviation). ``initial_speed_mps``:
    how fast an object may be when it is first seen. ``correlation_s``: errors of places closer in time than this are
    one error, so more of them say no more. ``outlier_sigmas``: a place farther off counts less."""

    speed_change_mps: float = 1.5
    initial_speed_mps: float = 10.0
    correlation_s: float = 0.4
    outlier_sigmas: float = 3.0


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Places of one track in order of time: ``frame_index`` (N,) int64, ``time_s`` (N,) float64, ``mean`` (N, 4) x, y
    and their speeds, ``cov`` (N, 4, 4)."""

    frame_index: NDArray[np.int64]
    time_s: NDArray[np.float64]
    mean: NDArray[np.float64]
    cov: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.time_s)


@dataclass(frozen=True, eq=False)
class Measured:
    """Places of one track as measured, in order of time: ``frame_index`` (N,), ``time_s`` (N,), ``xy_m`` (N, 2),
    ``cov_m2`` (N, 2, 2)."""

    frame_index: NDArray[np.int64]
    time_s: NDArray[np.float64]
    xy_m: NDArray[np.float64]
    cov_m2: NDArray[np.float64]


def smooth(tracks: list[Measured], config: MotionConfig) -> list[Trajectory]:
    """The smoothed trajectory of each track, at the times of its measurements. Each needs one at least."""
    if not tracks:
        return []
    lengths = np.array([len(track.time_s) for track in tracks], np.int64)
    order = np.argsort(-lengths, kind="stable")  # the longest first: at every step the live ones are a slice
    steps, count = int(lengths.max()), len(tracks)
    live = [int(np.count_nonzero(lengths > step)) for step in range(steps)]
    time_s, xy_m, cov_m2 = np.zeros((steps, count)), np.zeros((steps, count, 2)), np.zeros((steps, count, 2, 2))
    for column, index in enumerate(order):
        track = tracks[int(index)]
        time_s[: lengths[index], column] = track.time_s
        xy_m[: lengths[index], column] = track.xy_m
        cov_m2[: lengths[index], column] = track.cov_m2 * _inflation(track.time_s, config)
    mean, cov = np.zeros((steps, count, 4)), np.zeros((steps, count, 4, 4))
    _filter(time_s, xy_m, cov_m2, live, mean, cov, config)
    _smooth_back(time_s, live, mean, cov, config)
    found: list[Trajectory | None] = [None] * count
    for column, index in enumerate(order):
        track, length = tracks[int(index)], lengths[index]
        found[int(index)] = Trajectory(track.frame_index, track.time_s, mean[:length, column], cov[:length, column])
    return [trajectory for trajectory in found if trajectory is not None]


def predict(
    mean: NDArray[np.float64], cov: NDArray[np.float64], dt_s: NDArray[np.float64], config: MotionConfig
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """States (N, 4) and covariances (N, 4, 4) moved on by ``dt_s`` (N,) seconds; negative ones move them back."""
    transition = _transitions(dt_s)
    moved = np.einsum("nij,nj->ni", transition, mean)
    spread = transition @ cov @ transition.transpose(0, 2, 1) + _process_noise(np.abs(dt_s), np.sign(dt_s), config)
    return moved, spread


def _inflation(time_s: NDArray[np.float64], config: MotionConfig) -> float:
    """How many measurements in a row share one error."""
    if len(time_s) < 2:
        return 1.0
    step_s = float(time_s[-1] - time_s[0]) / (len(time_s) - 1)
    return max(1.0, config.correlation_s / max(step_s, 1e-3))


def _transitions(dt_s: NDArray[np.float64]) -> NDArray[np.float64]:
    transition = np.zeros((len(dt_s), 4, 4))
    transition[:] = np.eye(4)
    transition[:, 0, 2] = transition[:, 1, 3] = dt_s
    return transition


def _process_noise(
    dt_s: NDArray[np.float64], direction: NDArray[np.float64], config: MotionConfig
) -> NDArray[np.float64]:
    """(N, 4, 4) of white noise on the acceleration over ``dt_s`` >= 0; place and speed covary by the direction."""
    density = config.speed_change_mps**2
    noise = np.zeros((len(dt_s), 4, 4))
    noise[:, 0, 0] = noise[:, 1, 1] = density * dt_s**3 / 3
    noise[:, 2, 2] = noise[:, 3, 3] = density * dt_s
    mixed = density * np.square(dt_s) / 2 * direction
    noise[:, 0, 2] = noise[:, 2, 0] = noise[:, 1, 3] = noise[:, 3, 1] = mixed
    return noise


def _filter(
    time_s: NDArray[np.float64],
    xy_m: NDArray[np.float64],
    cov_m2: NDArray[np.float64],
    live: list[int],
    mean: NDArray[np.float64],
    cov: NDArray[np.float64],
    config: MotionConfig,
) -> None:
    """Fill ``mean`` and ``cov`` with the filtered states."""
    mean[0, :, :2] = xy_m[0]
    cov[0, :, :2, :2] = cov_m2[0]
    cov[0, :, 2, 2] = cov[0, :, 3, 3] = config.initial_speed_mps**2
    for step in range(1, len(time_s)):
        n = live[step]
        expected, spread = predict(
            mean[step - 1, :n], cov[step - 1, :n], time_s[step, :n] - time_s[step - 1, :n], config
        )
        off = xy_m[step, :n] - expected[:, :2]
        noise = cov_m2[step, :n]
        innovation = spread[:, :2, :2] + noise
        sigmas = np.sqrt(np.einsum("ni,nij,nj->n", off, _inverse_2x2(innovation), off))
        doubt = np.maximum(1.0, sigmas / config.outlier_sigmas)
        innovation = spread[:, :2, :2] + noise * np.square(doubt)[:, None, None]
        gain = spread[:, :, :2] @ _inverse_2x2(innovation)
        mean[step, :n] = expected + np.einsum("nij,nj->ni", gain, off)
        cov[step, :n] = spread - gain @ spread[:, :2, :]


def _smooth_back(
    time_s: NDArray[np.float64],
    live: list[int],
    mean: NDArray[np.float64],
    cov: NDArray[np.float64],
    config: MotionConfig,
) -> None:
    """Turn filtered states into smoothed ones, from the last step back."""
    for step in range(len(time_s) - 2, -1, -1):
        n = live[step + 1]
        dt_s = time_s[step + 1, :n] - time_s[step, :n]
        expected, spread = predict(mean[step, :n], cov[step, :n], dt_s, config)
        crossed = cov[step, :n] @ _transitions(dt_s).transpose(0, 2, 1)
        gain = np.linalg.solve(spread, crossed.transpose(0, 2, 1)).transpose(0, 2, 1)
        mean[step, :n] += np.einsum("nij,nj->ni", gain, mean[step + 1, :n] - expected)
        cov[step, :n] += gain @ (cov[step + 1, :n] - spread) @ gain.transpose(0, 2, 1)


def _inverse_2x2(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    a, b, c, d = matrix[:, 0, 0], matrix[:, 0, 1], matrix[:, 1, 0], matrix[:, 1, 1]
    inverse = np.stack([np.stack([d, -b], axis=-1), np.stack([-c, a], axis=-1)], axis=-2)
    return inverse / (a * d - b * c)[:, None, None]
