"""The table of audits."""

from datetime import datetime
from typing import Any

from sqlalchemy import ForeignKey
from sqlalchemy.orm import Mapped, mapped_column

from app.db.base import Base, now


class AuditRow(Base):
    """The last audit of a labelling; ``result`` is what ``hindsight audit --json`` prints."""

    __tablename__ = "audit"

    labelling_id: Mapped[int] = mapped_column(
        ForeignKey("labelling.id", ondelete="CASCADE"), primary_key=True, autoincrement=False
    )
    result: Mapped[dict[str, Any]]
    created_at: Mapped[datetime] = mapped_column(default=now)
