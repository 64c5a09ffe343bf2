"""Add where the car was to frames, and find 3D boxes by their track

Revision 0002, after 0001. Drives that were registered before keep no poses: their ways are shown relative to the car.
"""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("frame") as frame:
        for name in ("ego_x_m", "ego_y_m", "ego_yaw_rad"):
            frame.add_column(sa.Column(name, sa.Double(), nullable=True))
    op.create_index(op.f("ix_box3d_labelling_id_track_id"), "box3d", ["labelling_id", "track_id"], unique=False)


def downgrade() -> None:
    op.drop_index(op.f("ix_box3d_labelling_id_track_id"), table_name="box3d")
    with op.batch_alter_table("frame") as frame:
        for name in ("ego_yaw_rad", "ego_y_m", "ego_x_m"):
            frame.drop_column(name)
