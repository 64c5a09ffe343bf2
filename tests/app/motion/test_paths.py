"""Ways of tracks over ground."""

import math

import numpy as np
import pytest
from sqlalchemy import update

from app.db.session import Store
from app.drives.models import FrameRow
from app.motion.paths import PathFrame, paths_of_tracks
from app.tracks import repository as tracks_repository


def _place_car(store: Store, drive_id: int, *, x_m: float, y_m: float, yaw_rad: float) -> None:
    with store.write() as session:
        values = {"ego_x_m": x_m, "ego_y_m": y_m, "ego_yaw_rad": yaw_rad}
        session.execute(update(FrameRow).where(FrameRow.drive_id == drive_id).values(**values))


def _path_of_track_1(store: Store, drive_id: int):
    with store.read() as session:
        labelling = tracks_repository.current_labelling(session, drive_id)
        assert labelling is not None
        paths = paths_of_tracks(session, drive_id, labelling.id, [1, 2])
    assert list(paths) == [1]  # track 2 has no 3D box
    return paths[1]


def test_without_poses_a_way_is_relative_to_the_car(store: Store, labelled_id: int) -> None:
    path = _path_of_track_1(store, labelled_id)
    # a box 12 m ahead and .5 m to the left, in every frame but 3, where the tracker filled the box in
    assert path.frame is PathFrame.EGO
    assert path.frame_index.tolist() == [0, 1, 2, 4, 5]
    assert path.xy_m == pytest.approx(np.tile([12.0, 0.5], (5, 1)))
    assert path.yaw_rad == pytest.approx(np.full(5, 0.25))
    assert path.ego_distance_m == pytest.approx(np.full(5, math.hypot(12.0, 0.5)))
    assert np.diff(path.time_s) == pytest.approx([0.1, 0.1, 0.2, 0.1], abs=1e-6)


def test_with_poses_a_way_is_over_ground(store: Store, labelled_id: int) -> None:
    _place_car(store, labelled_id, x_m=100.0, y_m=50.0, yaw_rad=math.pi / 2)
    path = _path_of_track_1(store, labelled_id)
    # the car looks along y: 12 m ahead is 12 m up, .5 m to its left is .5 m back along x
    assert path.frame is PathFrame.CITY
    assert path.xy_m[0] == pytest.approx([99.5, 62.0])
    assert path.yaw_rad[0] == pytest.approx(math.pi / 2 + 0.25)
    assert path.ego_distance_m[0] == pytest.approx(math.hypot(12.0, 0.5))
    assert path.size_m[0] == pytest.approx([4.5, 1.8, 1.5])


def test_angles_stay_between_minus_pi_and_pi(store: Store, labelled_id: int) -> None:
    _place_car(store, labelled_id, x_m=0.0, y_m=0.0, yaw_rad=math.pi - 0.05)
    assert _path_of_track_1(store, labelled_id).yaw_rad[0] == pytest.approx(-math.pi + 0.2)
