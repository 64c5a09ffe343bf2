"""What of a drive is asked for, ignored, and left out; read from files."""

from pathlib import Path

import cv2
import numpy as np
import pyarrow as pa
import pytest
from pyarrow import feather

from labeler.drive import open_drive
from labeler.training.errors import TrainingError
from labeler.training.pictures import find_drives, load_pictures, pictures_of

TIME_NS = 1_700_000_000_000_000_000

ROWS = [
    # category, visible box, visible pixels, visible share, asked for?
    ("car", (10, 10, 40, 30), 500, 1.0, True),
    ("motorcycle", (50, 10, 60, 30), 120, 0.5, True),
    ("car", (70, 10, 73, 30), 50, 0.9, False),  # 3 px wide
    ("bus", (10, 52, 60, 59), 29, 0.9, False),  # too few pixels show it
    ("truck", (10, 40, 60, 50), 400, 0.05, False),  # nearly hidden
    ("trailer", (70, 40, 90, 50), 200, 1.0, False),  # none of the classes
]


def make_drive(folder: Path, *, semantic: bool = True, visible: bool = True) -> Path:
    image = folder / "sensors" / "cameras" / "front" / f"{TIME_NS}.jpg"
    image.parent.mkdir(parents=True)
    cv2.imwrite(str(image), np.full((60, 100, 3), 90, np.uint8))
    columns: dict[str, object] = {
        "timestamp_ns": np.full(len(ROWS), TIME_NS, np.int64),
        "camera": ["front"] * len(ROWS),
        "track_uuid": [str(index) for index in range(len(ROWS))],
        "category": [row[0] for row in ROWS],
    }
    for index, name in enumerate(("x1_px", "y1_px", "x2_px", "y2_px")):
        columns[name] = np.array([row[1][index] for row in ROWS], np.float32)
        if visible:
            columns[f"visible_{name}"] = columns[name]
    columns["visible_pixels"] = np.array([row[2] for row in ROWS], np.int32)
    columns["distance_m"] = np.array([60.0 if row[0] == "motorcycle" else 20.0 for row in ROWS], np.float32)
    columns["visible_share"] = np.array([row[3] for row in ROWS], np.float32)
    feather.write_feather(pa.table(columns), str(folder / "annotations_2d.feather"))
    if semantic:
        classes = folder / "semantic" / "front" / f"{TIME_NS}.png"
        classes.parent.mkdir(parents=True)
        cv2.imwrite(str(classes), np.full((60, 100), 3, np.uint8))
    return folder


def test_what_shows_enough_is_asked_for_and_the_rest_ignored(tmp_path: Path) -> None:
    (found,) = pictures_of(open_drive(make_drive(tmp_path / "drive")))

    assert found.boxes_px.tolist() == [list(map(float, row[1])) for row in ROWS if row[4]]
    assert found.classes.tolist() == [0, 3]
    assert found.ignored_px.tolist() == [list(map(float, row[1])) for row in ROWS if not row[4]]
    assert found.semantic is not None
    assert found.semantic.shape == found.image.shape[:2] == (60, 100)


def test_a_drive_without_classes_of_pixels_can_still_teach_a_detector(tmp_path: Path) -> None:
    (found,) = pictures_of(open_drive(make_drive(tmp_path / "drive", semantic=False)))

    assert found.semantic is None


def test_a_drive_without_visible_boxes_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TrainingError, match="no visible true boxes"):
        load_pictures([make_drive(tmp_path / "drive", visible=False)])


def test_a_damaged_image_of_classes_is_named(tmp_path: Path) -> None:
    folder = make_drive(tmp_path / "drive")
    (file,) = (folder / "semantic").rglob("*.png")
    file.write_bytes(b"no image")

    with pytest.raises(TrainingError, match=r"\.png is not an image of classes"):
        load_pictures([folder])


def test_drives_are_found_by_name_with_numbers_as_numbers(tmp_path: Path) -> None:
    for name in ("train10", "train2", "val0", "a drive"):
        make_drive(tmp_path / name)
    (tmp_path / "notes").mkdir()

    assert [path.name for path in find_drives([tmp_path])] == ["a drive", "train2", "train10", "val0"]
    assert find_drives([tmp_path / "val0"]) == [tmp_path / "val0"]


def test_a_folder_without_drives_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TrainingError, match=r"There is no drive in .*nowhere"):
        find_drives([tmp_path / "nowhere"])
