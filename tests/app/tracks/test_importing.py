"""Taking results of the pipeline into the store."""

from itertools import product

import pytest
from sqlalchemy import func, select

from app.db.session import Store
from app.tracks.importing import import_labelled_drive
from app.tracks.models import Box3DRow, LabellingRow, LabelRow, ObservationRow
from labeler.errors import HindsightError
from labeler.pipeline.types import Cancelled
from tests.app.conftest import Page
from tests.app.made_labels import TRACKS, MadeTrack, make_labelled_drive


def test_everything_arrives(page: Page) -> None:
    # 1 and 2 are one identity; its best observation is that of track 1 in frame 2: car, .9
    expected = {(track, frame): ("car", 0.9, "propagated", 1) for track in (1, 2) for frame in TRACKS[track - 1].scores}
    expected[1, 2] = ("car", 0.9, "auto", 1)
    # 3, 4 and 5 stand alone: class and score of their own best observation
    expected |= {(3, frame): ("car", 0.7, "propagated", 3) for frame in (2, 3, 5)} | {(3, 4): ("car", 0.7, "auto", 3)}
    expected |= {(4, frame): ("truck", 0.5, "propagated", 4) for frame in (0, 2)} | {(4, 1): ("truck", 0.5, "auto", 4)}
    expected |= {(5, 0): ("cone", 0.3, "auto", 5), (5, 1): ("cone", 0.3, "propagated", 5)}
    assert page.labels() == expected


def test_3d_boxes_know_their_track(store: Store, labelled_id: int) -> None:
    with store.read() as session:
        boxes = session.scalars(select(Box3DRow).order_by(Box3DRow.frame_index, Box3DRow.row)).all()
    # track 1 is detected in all frames but 3, each with a box of its own and one of no track
    assert [(box.frame_index, box.track_id) for box in boxes] == list(product((0, 1, 2, 4, 5), (1, None)))
    assert (boxes[0].center_x_m, boxes[0].width_m, boxes[0].yaw_rad) == (12.0, 1.8, 0.25)


def test_the_same_result_again_changes_nothing(store: Store, page: Page) -> None:
    before = page.client.get(f"/api/drives/{page.drive_id}").json()
    assert not import_labelled_drive(store, page.drive_id, make_labelled_drive(), model_name="made")
    assert page.client.get(f"/api/drives/{page.drive_id}").json() == before


def test_another_result_replaces_the_first_and_leaves_nothing_of_it(store: Store, page: Page) -> None:
    second = make_labelled_drive((TRACKS[3],), (), key="second")
    assert import_labelled_drive(store, page.drive_id, second, model_name="other")
    assert [track["id"] for track in page.get("tracks")] == [4]
    with store.read() as session:
        counts = [
            session.scalars(select(func.count()).select_from(table)).one()
            for table in (LabellingRow, ObservationRow, LabelRow, Box3DRow)
        ]
    assert counts == [1, 3, 3, 0]
    drive = page.client.get(f"/api/drives/{page.drive_id}").json()
    assert (drive["revision"], drive["track_count"], drive["observation_count"]) == (2, 1, 3)


def test_readers_see_the_old_result_until_the_new_one_is_whole(
    store: Store, page: Page, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.tracks.importing.ROWS_PER_TRANSACTION", 1)  # so that each frame is written at once
    before = page.everything()
    seen: list[bool] = []
    second = make_labelled_drive(
        (TRACKS[3],), (), key="second", on_frame=lambda _: seen.append(page.everything() == before)
    )
    import_labelled_drive(store, page.drive_id, second, model_name="other")
    assert seen == [True, True, True]
    assert page.everything() != before


class _CancelAt:
    """Stops the import when so many frames are stored."""

    def __init__(self, frames: int) -> None:
        self._left = frames

    def stage(self, name: str, units: int) -> None:
        assert (name, units) == ("store", 6)

    def advance(self, units: int = 1) -> None:
        self._left -= units
        if self._left <= 0:
            raise Cancelled("Stopped by the test.")


def test_an_import_that_stops_leaves_the_old_result_and_the_next_one_cleans_up(
    store: Store, page: Page, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.tracks.importing.ROWS_PER_TRANSACTION", 1)
    before = page.everything()
    second = make_labelled_drive(key="second")
    with pytest.raises(Cancelled):
        import_labelled_drive(store, page.drive_id, second, model_name="other", progress=_CancelAt(3))
    assert page.everything() == before
    assert import_labelled_drive(store, page.drive_id, second, model_name="other")
    with store.read() as session:
        assert session.scalars(select(LabellingRow.key)).all() == ["second"]
        assert session.scalars(select(func.count()).select_from(ObservationRow)).one() == 19


def test_labels_of_an_unknown_camera_are_refused(store: Store, drive_id: int) -> None:
    strange = make_labelled_drive((MadeTrack(1, "rear", 0, {0: 0.5}),), ())
    with pytest.raises(HindsightError, match="rear"):
        import_labelled_drive(store, drive_id, strange, model_name="made")


def test_labels_of_frames_that_the_drive_had_not_are_refused(store: Store, page: Page) -> None:
    before = page.everything()
    longer = make_labelled_drive((MadeTrack(1, "front", 0, {5: 0.5, 6: 0.5}),), (), key="longer")
    with pytest.raises(HindsightError, match="beyond frame 5"):
        import_labelled_drive(store, page.drive_id, longer, model_name="made")
    assert page.everything() == before


def test_a_deleted_drive_is_named(store: Store, drive_id: int) -> None:
    with pytest.raises(HindsightError, match=f"Drive {drive_id + 1} was deleted"):
        import_labelled_drive(store, drive_id + 1, make_labelled_drive(), model_name="made")
