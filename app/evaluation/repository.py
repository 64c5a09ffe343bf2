"""SQL about labels as evaluation reads them: only the columns that it needs, many rows at a time."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from app.identities.models import IdentityRow
from app.tracks.label_repository import is_label_of_observation
from app.tracks.models import LabelRow, ObservationRow, TrackRow
from app.tracks.repository import same_track


def labels_between(session: Session, labelling_id: int, start: int, stop: int) -> Sequence[Sequence[Any]]:
    """Columns of the observations of the frames ``start <= frame_index < stop``; empty where there are none.

    Objects that a person ignores are not among them.

    In order: frame_index, camera_id, x1_px, y1_px, x2_px, y2_px, class_id and score as detected, track_id, identity_id,
    class_id and score of the label, why it is withheld, how likely it is right.
    """
    ignored = select(IdentityRow.identity_id).where(
        IdentityRow.labelling_id == labelling_id, IdentityRow.mark == "ignored"
    )
    query = (
        select(
            ObservationRow.frame_index,
            TrackRow.camera_id,
            ObservationRow.x1_px,
            ObservationRow.y1_px,
            ObservationRow.x2_px,
            ObservationRow.y2_px,
            ObservationRow.class_id,
            ObservationRow.score,
            ObservationRow.track_id,
            TrackRow.identity_id,
            LabelRow.class_id,
            LabelRow.score,
            LabelRow.withheld,
            LabelRow.probability,
        )
        .join(TrackRow, same_track(TrackRow, ObservationRow))
        .join(LabelRow, is_label_of_observation())
        .where(
            ObservationRow.labelling_id == labelling_id,
            ObservationRow.frame_index >= start,
            ObservationRow.frame_index < stop,
            TrackRow.identity_id.not_in(ignored),
        )
    )
    return list(zip(*session.execute(query).all(), strict=True))
