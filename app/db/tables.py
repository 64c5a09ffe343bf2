"""Every table of the store, gathered for the migrations."""

from app.audit.models import AuditRow
from app.db.base import Base
from app.drives.models import CameraRow, DriveRow, FrameRow, ImageRow
from app.edits.models import EffectRow
from app.exports.models import ExportRow
from app.identities.models import IdentityRow
from app.jobs.models import JobRow
from app.merges.models import MergeRow
from app.reviews.models import ReviewRow
from app.tracks.models import Box3DRow, LabellingRow, LabelRow, ObservationRow, TrackRow

TABLES = (
    DriveRow,
    CameraRow,
    FrameRow,
    ImageRow,
    LabellingRow,
    TrackRow,
    ObservationRow,
    LabelRow,
    Box3DRow,
    IdentityRow,
    MergeRow,
    ReviewRow,
    EffectRow,
    JobRow,
    ExportRow,
    AuditRow,
)

metadata = Base.metadata
