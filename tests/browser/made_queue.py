"""A workspace whose drive has a queue of merges, made by hand."""

from pathlib import Path

from app.db.engine import migrate, open_engine
from app.db.session import Store
from app.drives.schemas import DriveRegistration
from app.drives.service import add_local_drive
from app.tracks.importing import import_labelled_drive
from labeler.identity.types import MergeState
from tests.app.made_labels import MadeTrack, make_labelled_drive, write_three_camera_drive


def store_queue(workspace: Path, folder: Path, *, merges: int) -> int:
    """Write a drive into a folder and its labels into the workspace's store; gives the drive's id.

    Each of the proposed merges, and one more that the machine made, is of a track in front (scores .9) and one in left
    (.4), over 3 to 6 frames; the probability grows with the number.
    """
    drive = write_three_camera_drive(folder)
    workspace.mkdir()
    engine = open_engine(f"sqlite:///{workspace}/hindsight.db")
    migrate(engine)
    store = Store(engine)
    drive_id = add_local_drive(store, DriveRegistration(path=str(drive))).id
    pairs = range(1, merges + 2)
    tracks = [
        MadeTrack(number + 100 * side, camera, 0, dict.fromkeys(range(number % 4, 6), score), x_px=4.0 * number)
        for side, (camera, score) in enumerate((("front", 0.9), ("left", 0.4)))
        for number in pairs
    ]
    proposals = [
        (number, number + 100, 0.4 + number / 100, MergeState.PROPOSED if number <= merges else MergeState.ACCEPTED)
        for number in pairs
    ]
    assert import_labelled_drive(store, drive_id, make_labelled_drive(tracks, proposals), model_name="made")
    engine.dispose()
    return drive_id
