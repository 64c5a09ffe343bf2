"""A decision as the log shows it."""

from app.edits.schemas import Edit, EditAction
from app.reviews.models import ReviewRow


def to_edit(row: ReviewRow) -> Edit:
    """What the page learns of a decision of any kind."""
    return Edit(
        id=row.id,
        action=EditAction(row.action),
        reviewer=row.reviewer,
        created_at=row.created_at,
        undone=row.undone,
        target_id=row.target_id,
        revision=row.revision,
        **row.payload.get("about", {}),
    )
