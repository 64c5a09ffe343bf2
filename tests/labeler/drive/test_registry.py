"""Finding the format of a folder, and saying clearly why there is none."""

from pathlib import Path

import pytest

from labeler.drive import DriveError, open_drive
from labeler.drive.registry import FORMATS


def test_every_format_has_its_own_name() -> None:
    names = [drive_format.name for drive_format in FORMATS]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("levels", [0, 1, 2])
def test_a_drive_is_found_up_to_two_levels_down(argoverse2_log: Path, tmp_path: Path, levels: int) -> None:
    outer = tmp_path.joinpath("outer", *["in"] * levels)
    outer.parent.mkdir(parents=True, exist_ok=True)
    argoverse2_log.rename(outer)
    (tmp_path / "outer" / "README.txt").write_text("unpacked")
    assert open_drive(tmp_path / "outer").root == outer
    assert open_drive(str(tmp_path / "outer")).format == "argoverse2"


def test_a_drive_three_levels_down_is_not_looked_for(argoverse2_log: Path, tmp_path: Path) -> None:
    (tmp_path / "1" / "2" / "3").mkdir(parents=True)
    argoverse2_log.rename(tmp_path / "1" / "2" / "3" / "log")
    with pytest.raises(DriveError, match="no drive of a known format"):
        open_drive(tmp_path / "1")


def test_several_drives_are_named(argoverse2_log: Path, kitti_root: Path, tmp_path: Path) -> None:
    with pytest.raises(DriveError, match=r"holds 2 drives: a log, kitti\. Name one of these folders"):
        open_drive(tmp_path)
    assert {argoverse2_log.parent, kitti_root.parent} == {tmp_path}


def test_a_folder_without_a_drive_says_what_was_looked_for(tmp_path: Path) -> None:
    with pytest.raises(DriveError, match=r"The folder is empty"):
        open_drive(tmp_path)
    (tmp_path / "holiday.mp4").write_text("x")
    (tmp_path / "notes").mkdir()
    with pytest.raises(DriveError) as raised:
        open_drive(tmp_path)
    message = str(raised.value)
    assert all(f"{drive_format.name}: {drive_format.looked_for}" in message for drive_format in FORMATS)
    assert message.endswith("There lies holiday.mp4, notes/.")


def test_a_path_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(DriveError, match="gone does not exist"):
        open_drive(tmp_path / "gone")


def test_a_file_is_no_drive(tmp_path: Path) -> None:
    (tmp_path / "drive.zip").write_text("x")
    with pytest.raises(DriveError, match="is a file, but a drive is a folder"):
        open_drive(tmp_path / "drive.zip")


@pytest.mark.parametrize("name", ["x" * 5000, "a\0b"])
def test_a_path_that_cannot_be(tmp_path: Path, name: str) -> None:
    with pytest.raises(DriveError):
        open_drive(tmp_path / name)
