"""Audits of the labels that the store holds."""

from app.audit import repository
from app.audit.schemas import Audit
from app.db.session import Session, Store
from app.drives.models import DriveRow
from app.drives.service import require_drive
from app.settings import Settings
from app.tracks import repository as tracks_repository
from app.tracks.models import LabellingRow
from labeler.drive import Drive
from labeler.errors import HindsightError
from labeler.evaluation.audit import Audit as AuditResult
from labeler.evaluation.audit import AuditConfig, audit_labels
from labeler.pipeline.results import find_files
from labeler.pipeline.types import Progress


def last_audit(session: Session, drive_id: int) -> Audit | None:
    """The last audit of the drive's current labels; NotFound where there is no such drive."""
    require_drive(session, drive_id)
    labelling = tracks_repository.current_labelling(session, drive_id)
    row = None if labelling is None else repository.find(session, labelling.id)
    return None if row is None else Audit(**row.result, created_at=row.created_at)


def audit_labelling(
    store: Store,
    settings: Settings,
    row: DriveRow,
    labelling: LabellingRow,
    recorded: Drive,
    *,
    config: AuditConfig,
    progress: Progress,
) -> AuditResult:
    """Audit one labelling of a drive, and keep what came out; HindsightError where its files are gone, or no
    observation would be hidden."""
    files = find_files(settings.workspace, labelling.key)
    if files is None:
        raise HindsightError(
            f"The workspace {settings.workspace} does not have all that the labels of {row.name} were made from. Label "
            "the drive again with the same model and settings: what is there is used again."
        )
    found = audit_labels(recorded, files, config=config, progress=progress)
    with store.write() as session:
        current = tracks_repository.current_labelling(session, row.id)
        if current is not None and current.id == labelling.id:  # else it was labelled anew meanwhile
            repository.put(session, labelling.id, found)
    return found
