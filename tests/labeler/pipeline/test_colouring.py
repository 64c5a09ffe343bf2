"""The colours of tracks, read from images on disk."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from labeler.drive import open_drive
from labeler.identity.colours import colour_histogram, likeness
from labeler.pipeline.colouring import ColourUnit, measure_colours, read_colours
from labeler.pipeline.tables import columns_of, write_table
from labeler.tracking.types import Observations

BOX = (10.0, 10.0, 60.0, 50.0)


@pytest.fixture
def unit(made_drive: Path, tmp_path: Path) -> ColourUnit:
    """Two tracks of the first camera: one in frames 0 and 1, one in frame 2."""
    drive = open_drive(made_drive)
    camera = drive.cameras[0]
    images = {frame.index: frame.images[camera.name] for frame in drive.frames if camera.name in frame.images}
    seen = Observations(
        track_id=np.array([5, 5, 9], np.int32),
        frame_index=np.array([0, 1, 2], np.int32),
        xyxy_px=np.array([BOX] * 3, np.float32),
        score=np.full(3, 0.9, np.float32),
        class_id=np.zeros(3, np.int16),
        detection_index=np.arange(3, dtype=np.int32),
    )
    tracks = tmp_path / "tracks.arrow"
    write_table(tracks, [columns_of(seen)])
    return ColourUnit("key", camera, images, tracks, effort=len(images))


def look(unit: ColourUnit, frame: int) -> np.ndarray:
    """The histogram of the box in an image of the unit."""
    image = cv2.imread(str(unit.images[frame].path))
    assert image is not None
    histogram = colour_histogram(np.asarray(image, np.uint8), BOX)
    assert histogram is not None
    return histogram


def test_a_track_has_the_mean_of_its_looks(unit: ColourUnit, tmp_path: Path):
    measure_colours(unit, tmp_path / "colours.arrow")

    found = read_colours([tmp_path / "colours.arrow"])

    assert sorted(found) == [5, 9]
    np.testing.assert_allclose(found[5], (look(unit, 0) + look(unit, 1)) / 2, atol=1e-5)
    assert likeness(found[5], found[5]) == pytest.approx(1, abs=1e-5)


def test_images_that_are_missing_or_broken_are_left_out(unit: ColourUnit, tmp_path: Path):
    broken = tmp_path / "broken.jpg"
    broken.write_bytes(b"no image")
    images = {0: unit.images[0], 1: replace(unit.images[1], path=broken)}

    measure_colours(replace(unit, images=images), tmp_path / "colours.arrow")

    found = read_colours([tmp_path / "colours.arrow"])
    assert list(found) == [5]
    np.testing.assert_allclose(found[5], look(unit, 0), atol=1e-5)


def test_a_camera_without_tracks_has_no_colours(unit: ColourUnit, tmp_path: Path):
    write_table(unit.tracks, [columns_of(Observations.empty())])
    measure_colours(unit, tmp_path / "colours.arrow")
    assert read_colours([tmp_path / "colours.arrow"]) == {}
