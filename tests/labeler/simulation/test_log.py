"""Written logs are read back through ``open_drive``."""

import errno
import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from labeler.drive import open_drive
from labeler.geometry.se3 import se3
from labeler.simulation.errors import SimulationError
from labeler.simulation.lidar import Scan
from labeler.simulation.log import SimulatedLog
from labeler.simulation.rig import Rig
from labeler.simulation.solids import Solid
from labeler.simulation.truth import Target, TrueBox
from tests.labeler.simulation.solid_shapes import box

pytest.importorskip("embreex", reason="needs embreex, of the extra `simulation`")

RIG = Rig.on_roof(rear_axle_m=-1.3, height_m=1.5, width_px=64, height_px=32)
ABOUT = {"settings": {"seed": 1}}
TIMES_NS = (1_700_000_000_000_000_000, 1_700_000_000_100_000_000)
QUARTER_TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def target(x_m: float) -> Target:
    """A truck 6 m long, 2 wide, 3 high, turned to the left."""
    solid = Solid(box((-3.0, -1.0, 0.0), (3.0, 1.0, 3.0)), np.ones(12))
    return Target(5, "the truck", "truck", solid, (6.0, 2.0, 3.0), se3(QUARTER_TURN, [x_m, 4.0, 0.0]))


def sweep() -> Scan:
    return Scan(
        xyz_m=np.array([[10.0, 4.0, 1.0], [10.5, 6.5, 2.5], [30.0, 0.0, 0.0]]),
        intensity=np.array([10, 20, 30], np.uint8),
        laser_number=np.array([0, 5, 63], np.uint8),
        offset_ns=np.array([-50_000_000, 0, 49_000_000], np.int32),
        vehicle_id=np.array([5, 5, 0], np.int32),
    )


def write_moment(log: SimulatedLog, timestamp_ns: int, *, x_m: float) -> None:
    for view in RIG.views:
        log.write_image(view.camera, timestamp_ns, np.full((32, 64, 3), 90, np.uint8))
    log.write_sweep(timestamp_ns, sweep())
    whole_px, visible_px = np.array([1.5, 2.0, 30.0, 20.25]), np.array([10.0, 2.0, 30.0, 20.0])
    boxes = {"front": [TrueBox(target(x_m), whole_px, visible_px, 210, 0.625)], "left": []}
    log.finish_moment(
        timestamp_ns,
        city_SE3_ego=se3(QUARTER_TURN, [100.0, 50.0, 0.0]),
        targets=[target(x_m)],
        boxes=boxes,
        scan=sweep(),
    )


def write_log(folder: Path) -> None:
    log = SimulatedLog(folder, ABOUT, jpeg_quality=90)
    log.write_calibration(RIG)
    for timestamp_ns in TIMES_NS:
        write_moment(log, timestamp_ns, x_m=10.0)
    log.publish(TIMES_NS)


def test_classes_of_pixels_lie_beside_the_sensors_and_are_not_taken_for_images(tmp_path: Path) -> None:
    log = SimulatedLog(tmp_path / "drive", ABOUT, jpeg_quality=90)
    log.write_calibration(RIG)
    classes = np.arange(32 * 64, dtype=np.uint32).reshape(32, 64).astype(np.uint8) % 5
    write_moment(log, TIMES_NS[0], x_m=10.0)
    log.write_semantic("front", TIMES_NS[0], classes)
    log.publish(TIMES_NS[:1])

    file = tmp_path / "drive" / "semantic" / "front" / f"{TIMES_NS[0]}.png"
    np.testing.assert_array_equal(cv2.imread(str(file), cv2.IMREAD_UNCHANGED), classes)
    drive = open_drive(tmp_path / "drive")
    assert (drive.warnings, len(drive.cameras), len(drive.frames)) == ((), 4, 1)


def test_a_log_opens_as_a_drive_with_all_it_was_given(tmp_path: Path) -> None:
    write_log(tmp_path / "drive")
    drive = open_drive(tmp_path / "drive")
    assert (drive.format, drive.warnings, len(drive.frames)) == ("argoverse2", (), 2)
    assert [camera.name for camera in drive.cameras] == sorted(view.camera for view in RIG.views)
    for view in RIG.views:
        camera = drive.camera(view.camera)
        assert (camera.width_px, camera.height_px) == (64, 32)
        assert camera.calibration is not None
        assert camera.calibration.intrinsics == pytest.approx(view.intrinsics)
        assert camera.calibration.ego_SE3_camera == pytest.approx(view.ego_SE3_camera)
    assert drive.poses is not None
    assert drive.poses.timestamp_ns.tolist() == list(TIMES_NS)
    assert drive.poses.city_SE3_ego[1] == pytest.approx(se3(QUARTER_TURN, [100.0, 50.0, 0.0]))
    assert drive.frames[0].sweep is not None
    read = drive.read_sweep(drive.frames[0].sweep)
    assert read.xyz_m == pytest.approx(sweep().xyz_m, abs=1e-2)
    assert read.intensity.tolist() == [10, 20, 30]


def test_truth_is_read_back(tmp_path: Path) -> None:
    write_log(tmp_path / "drive")
    drive = open_drive(tmp_path / "drive")
    truth = drive.read_truth(drive.frames)
    assert truth is not None
    in_3d, in_2d = truth.boxes_3d, truth.boxes_2d
    assert in_3d is not None
    assert in_2d is not None
    assert in_3d.category == ("TRUCK", "TRUCK")
    assert in_3d.center_m[0] == pytest.approx([10.0, 4.0, 1.5])  # 3D boxes count from their middle
    assert in_3d.size_m[0].tolist() == [6.0, 2.0, 3.0]
    assert in_3d.yaw_rad[0] == pytest.approx(np.pi / 2)
    assert (in_2d.camera, in_2d.category) == (("front", "front"), ("truck", "truck"))
    assert in_2d.frame_index.tolist() == [0, 1]
    assert in_2d.xyxy_px[0].tolist() == [1.5, 2.0, 30.0, 20.25]
    assert in_2d.visible_xyxy_px is not None
    assert in_2d.visible_xyxy_px[0].tolist() == [10.0, 2.0, 30.0, 20.0]
    assert in_2d.visible_share is not None
    assert in_2d.visible_share[0] == 0.625
    assert in_2d.visible_pixels is not None
    assert in_2d.visible_pixels[0] == 210
    assert in_2d.distance_m is not None
    assert in_2d.distance_m[0] == pytest.approx(np.hypot(10.0, 4.0))
    assert in_3d.track_uuid == in_2d.track_uuid == ("the truck", "the truck")


def test_interior_points_are_counted(tmp_path: Path) -> None:
    """Turned by a quarter at (10, 4), the truck spans x 9..11 and y 1..7: two of the three points."""
    import pyarrow.feather

    write_log(tmp_path / "drive")
    table = pyarrow.feather.read_table(tmp_path / "drive" / "annotations.feather")
    assert table["num_interior_pts"].to_pylist() == [2, 2]


def test_only_a_whole_log_gets_its_name(tmp_path: Path) -> None:
    log = SimulatedLog(tmp_path / "drive", ABOUT, jpeg_quality=90)
    log.write_calibration(RIG)
    write_moment(log, TIMES_NS[0], x_m=10.0)
    assert not (tmp_path / "drive").exists()
    with pytest.raises(SimulationError, match="1 of 2 moments have not been written"):
        log.publish(TIMES_NS)
    write_moment(log, TIMES_NS[1], x_m=10.0)
    log.publish(TIMES_NS)
    assert [path.name for path in tmp_path.iterdir()] == ["drive"]
    assert json.loads((tmp_path / "drive" / "simulation.json").read_text()) == ABOUT


def test_the_same_simulation_goes_on_and_ends_in_the_same_bytes(tmp_path: Path) -> None:
    write_log(tmp_path / "at once")
    stopped = SimulatedLog(tmp_path / "stopped", ABOUT, jpeg_quality=90)
    stopped.write_calibration(RIG)
    write_moment(stopped, TIMES_NS[0], x_m=10.0)
    again = SimulatedLog(tmp_path / "stopped", ABOUT, jpeg_quality=90)
    assert [again.has(timestamp_ns) for timestamp_ns in TIMES_NS] == [True, False]
    write_moment(again, TIMES_NS[1], x_m=10.0)
    again.publish(TIMES_NS)
    files = sorted(path.relative_to(tmp_path / "at once") for path in (tmp_path / "at once").rglob("*.*"))
    assert len(files) == 16
    for file in files:
        assert (tmp_path / "stopped" / file).read_bytes() == (tmp_path / "at once" / file).read_bytes()


def test_another_simulation_begins_anew(tmp_path: Path) -> None:
    stopped = SimulatedLog(tmp_path / "drive", ABOUT, jpeg_quality=90)
    write_moment(stopped, TIMES_NS[0], x_m=10.0)
    other = SimulatedLog(tmp_path / "drive", {"settings": {"seed": 2}}, jpeg_quality=90)
    assert not other.has(TIMES_NS[0])


def test_a_folder_that_is_there_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "drive").mkdir()
    with pytest.raises(SimulationError, match=r"drive is there already\. Choose another folder"):
        SimulatedLog(tmp_path / "drive", ABOUT, jpeg_quality=90)
    assert list((tmp_path / "drive").iterdir()) == []


def test_a_place_that_can_t_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(SimulationError, match=r"file/drive can't be written: .*"):
        SimulatedLog(tmp_path / "file" / "drive", ABOUT, jpeg_quality=90)


def test_a_full_disk_is_told_apart(tmp_path: Path) -> None:
    """Linux has a device that is always full."""
    if not Path("/dev/full").exists():
        pytest.skip("needs /dev/full")
    log = SimulatedLog(tmp_path / "drive", ABOUT, jpeg_quality=90)
    folder = tmp_path / ".drive.partial" / "sensors" / "cameras" / "front"
    folder.mkdir(parents=True)
    (folder / f"{TIMES_NS[0]}.jpg").symlink_to("/dev/full")
    with pytest.raises(SimulationError, match=r"No space is left for .*the same command then goes on") as caught:
        log.write_image("front", TIMES_NS[0], np.zeros((32, 64, 3), np.uint8))
    assert isinstance(caught.value.__cause__, OSError)
    assert caught.value.__cause__.errno == errno.ENOSPC
