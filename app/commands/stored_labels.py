"""The labels that the workspace holds of a drive in a folder, for commands that read them."""

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from app.db.engine import migrate, open_engine
from app.db.session import Store
from app.drives import repository as drives_repository
from app.drives.models import DriveRow
from app.reviews.constraints import constraints_about
from app.settings import Settings
from app.tracks import repository as tracks_repository
from app.tracks.models import LabellingRow
from labeler.drive import Drive, open_drive
from labeler.errors import HindsightError
from labeler.identity import Decisions


@dataclass(frozen=True, eq=False)
class StoredLabels:
    """A drive as ``recorded``, the ``store``, and its rows of the drive and of its current labelling."""

    recorded: Drive
    store: Store
    drive: DriveRow
    labelling: LabellingRow


@contextmanager
def open_stored_labels(settings: Settings, folder: Path, *, scene: str | None) -> Generator[StoredLabels]:
    """The current labels of the drive in ``folder``. HindsightError where the workspace holds none of it."""
    recorded = open_drive(folder.absolute(), scene=scene)
    if not _has_store(settings):
        raise _not_labelled(settings, recorded, folder)
    with _open_store(settings) as store:
        with store.read() as session:
            row = drives_repository.find_by_path(session, str(recorded.root), scene)
            labelling = None if row is None else tracks_repository.current_labelling(session, row.id)
        if row is None or labelling is None:
            raise _not_labelled(settings, recorded, folder)
        yield StoredLabels(recorded, store, row, labelling)


def decisions_about(settings: Settings, recorded: Drive, *, scene: str | None) -> Decisions:
    """What people decided about pairs of a drive's tracks; nothing where the workspace does not know the drive."""
    if not _has_store(settings):
        return Decisions()
    with _open_store(settings) as store, store.read() as session:
        row = drives_repository.find_by_path(session, str(recorded.root), scene)
        return Decisions() if row is None else constraints_about(session, row.id)


def _has_store(settings: Settings) -> bool:
    return settings.database_url is not None or (settings.workspace / "hindsight.db").exists()


@contextmanager
def _open_store(settings: Settings) -> Generator[Store]:
    engine = open_engine(settings.store_url)
    try:
        migrate(engine)
        yield Store(engine)
    finally:
        engine.dispose()


def _not_labelled(settings: Settings, recorded: Drive, folder: Path) -> HindsightError:
    return HindsightError(
        f"The workspace {settings.workspace} has no labels of {recorded.name}. Label it first, in the same workspace: "
        f"hindsight label {folder}."
    )
