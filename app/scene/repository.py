"""What the store knows for a 3D view."""

from sqlalchemy import and_, select
from sqlalchemy.orm import Session

from app.scene.types import SceneBox
from app.tracks.models import Box3DRow, LabellingRow, LabelRow, TrackRow


def boxes_of_frame(session: Session, drive_id: int, frame_index: int) -> list[SceneBox]:
    """The 3D boxes of a frame in the drive's current labelling; none before it was labelled.

    A box has the identity of its track, and class and score of its track's label there, else its own.
    Boxes that a person deleted are not among them."""
    query = (
        select(Box3DRow, TrackRow.identity_id, LabelRow.class_id, LabelRow.score, LabellingRow.class_names)
        .join(LabellingRow, LabellingRow.id == Box3DRow.labelling_id)
        .outerjoin(
            TrackRow,
            and_(TrackRow.labelling_id == Box3DRow.labelling_id, TrackRow.track_id == Box3DRow.track_id),
        )
        .outerjoin(
            LabelRow,
            and_(
                LabelRow.labelling_id == Box3DRow.labelling_id,
                LabelRow.track_id == Box3DRow.track_id,
                LabelRow.frame_index == Box3DRow.frame_index,
            ),
        )
        .where(
            LabellingRow.drive_id == drive_id,
            LabellingRow.current,
            Box3DRow.frame_index == frame_index,
            Box3DRow.track_id.is_not(None) | Box3DRow.tracked_id.is_(None),
        )
        .order_by(Box3DRow.camera_id, Box3DRow.row)
    )
    return [
        SceneBox(
            center_m=(row.center_x_m, row.center_y_m, row.center_z_m),
            size_m=(row.length_m, row.width_m, row.height_m),
            yaw_rad=row.yaw_rad,
            identity_id=identity_id,
            class_name=class_names[row.class_id if label_class_id is None else label_class_id],
            score=row.score if label_class_id is None else label_score,
        )
        for row, identity_id, label_class_id, label_score, class_names in session.execute(query)
    ]
