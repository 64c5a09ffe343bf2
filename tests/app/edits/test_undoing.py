"""Undo and redo of any edits: what holds is what the edits that are not undone make of the machine's labels."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter
from sqlalchemy import select

from app.db.engine import migrate, open_engine
from app.db.session import Store
from app.drives.schemas import DriveRegistration
from app.drives.service import add_local_drive
from app.edits import service, undoing
from app.edits.schemas import AnyEdit
from app.errors import AppError
from app.identities.models import IdentityRow
from app.merges.models import MergeRow
from app.tracks.importing import import_labelled_drive
from app.tracks.models import Box3DRow, LabelRow, ObservationRow, TrackRow
from tests.app.made_labels import make_labelled_drive

NUMBER = st.integers(1, 8)
FRAME = st.integers(0, 5)
NUMBERS = st.lists(NUMBER, min_size=1, max_size=2)
CAMERA = st.sampled_from(["front", "left", "right"])
EDITS = st.one_of(
    st.fixed_dictionaries({"kind": st.just("class"), "identity_ids": NUMBERS, "class_name": st.just("truck")}),
    st.fixed_dictionaries({"kind": st.just("split"), "track_ids": NUMBERS, "frame_index": FRAME}),
    st.fixed_dictionaries({"kind": st.just("join"), "identity_ids": st.lists(NUMBER, min_size=2, max_size=3)}),
    st.fixed_dictionaries(
        {"kind": st.just("swap"), "identity_ids": st.lists(NUMBER, min_size=2, max_size=2), "frame_index": FRAME}
    ),
    st.fixed_dictionaries({"kind": st.just("delete"), "track_ids": NUMBERS}),
    st.fixed_dictionaries({"kind": st.just("mark"), "identity_ids": NUMBERS, "mark": st.just("ignored")}),
    st.fixed_dictionaries(
        {
            "kind": st.just("box"),
            "camera": CAMERA,
            "frame_index": FRAME,
            "box": st.just((5, 5, 30, 30)),
            "identity_id": st.one_of(st.none(), NUMBER),
            "class_name": st.just("cone"),
        }
    ),
    st.fixed_dictionaries(
        {"kind": st.just("interpolate"), "track_id": NUMBER, "first_frame": st.just(0), "last_frame": FRAME}
    ),
)
ADAPTER: TypeAdapter[AnyEdit] = TypeAdapter(AnyEdit)


@contextmanager
def _store(drive: Path, migrated_store: Path) -> Iterator[tuple[Store, int]]:
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "store.db"
        copy.write_bytes(migrated_store.read_bytes())
        engine = open_engine(f"sqlite:///{copy}")
        migrate(engine)
        store = Store(engine)
        drive_id = add_local_drive(store, DriveRegistration(path=str(drive))).id
        import_labelled_drive(store, drive_id, make_labelled_drive(), model_name="made")
        yield store, drive_id
        engine.dispose()


def _state(store: Store) -> dict[str, Any]:
    """All that an edit can change, but for the store's own numbers of drawn boxes."""
    tables: dict[str, tuple[Any, ...]] = {
        "observations": (
            select(
                ObservationRow.track_id,
                ObservationRow.frame_index,
                ObservationRow.x1_px,
                ObservationRow.filled,
                ObservationRow.drawn,
            ).where(ObservationRow.track_id.is_not(None)),
        ),
        "tracks": (select(*TrackRow.__table__.columns),),
        "labels": (select(*LabelRow.__table__.columns),),
        "identities": (select(*IdentityRow.__table__.columns),),
        "merges": (select(MergeRow.track_a, MergeRow.track_b, MergeRow.state),),
        "boxes": (select(Box3DRow.frame_index, Box3DRow.row, Box3DRow.track_id),),
    }
    with store.read() as session:
        return {name: sorted(map(repr, session.execute(query).all())) for name, (query,) in tables.items()}


def _try(store: Store, drive_id: int, edit: Any) -> bool:
    """Make an edit; False where the rules forbid it."""
    try:
        with store.write() as session:
            service.make_edit(session, drive_id, ADAPTER.validate_python(edit), seen_revision=None, reviewer="test")
    except AppError:
        return False
    return True


@given(edits=st.lists(EDITS, min_size=1, max_size=6))
@settings(max_examples=25, deadline=None)
def test_undo_brings_back_each_state_and_redo_brings_it_again(
    edits: list[Any], three_camera_drive: Path, migrated_store: Path
) -> None:
    with _store(three_camera_drive, migrated_store) as (store, drive_id):
        states = [_state(store)]
        for edit in edits:
            if _try(store, drive_id, edit):
                states.append(_state(store))
            else:
                assert _state(store) == states[-1]
        for before in reversed(states[:-1]):
            with store.write() as session:
                undoing.undo(session, drive_id, None, seen_revision=None, reviewer="test")
            assert _state(store) == before
        for after in states[1:]:
            with store.write() as session:
                undoing.redo(session, drive_id, None, seen_revision=None, reviewer="test")
            assert _state(store) == after
