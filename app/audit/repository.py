"""SQL about audits."""

from collections.abc import Mapping
from typing import Any

from sqlalchemy import delete
from sqlalchemy.orm import Session

from app.audit.models import AuditRow


def find(session: Session, labelling_id: int) -> AuditRow | None:
    """The last audit of a labelling, None where there is none."""
    return session.get(AuditRow, labelling_id)


def put(session: Session, labelling_id: int, result: Mapping[str, Any]) -> None:
    """Keep an audit in the place of the one before."""
    session.execute(delete(AuditRow).where(AuditRow.labelling_id == labelling_id))
    session.add(AuditRow(labelling_id=labelling_id, result=dict(result)))
    session.flush()
