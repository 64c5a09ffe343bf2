"""The drive that the review page is measured on has what it says, also when a small one is made."""

from pathlib import Path

import cv2
import numpy as np

from app.db.engine import open_engine
from app.db.session import Store
from app.drives import repository as drives_repository
from app.tracks import repository as tracks_repository
from tests.big_drive.making import FOLDER_NAME, SMALL, START_NS, make_workspace
from tests.big_drive.pictures import read_number


def test_a_small_one_has_as_many_identities_and_boxes_as_asked(tmp_path: Path) -> None:
    settings = make_workspace(tmp_path, SMALL)
    engine = open_engine(settings.store_url)
    with Store(engine).read() as session:
        drive = drives_repository.list_newest_first(session)[0]
        counts = tracks_repository.counts_of_drives(session, [drive.id])[drive.id]
    engine.dispose()
    assert (drive.frame_count, counts.identities, counts.observations) == (60, 75, 4_000)
    assert counts.proposed_merges > 0


def test_a_picture_carries_the_number_of_its_frame(tmp_path: Path) -> None:
    make_workspace(tmp_path, SMALL)
    for frame in (0, 37, 59):
        path = tmp_path / FOLDER_NAME / "sensors" / "cameras" / "left" / f"{START_NS + frame * 100_000_000}.jpg"
        image = cv2.imread(str(path))
        assert image is not None
        assert read_number(image.astype(np.uint8)) == frame
