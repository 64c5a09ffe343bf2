"""Keep the evidence of merges

Revision 0005, after 0004.
"""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("merge") as table:
        table.add_column(sa.Column("evidence", sa.JSON(), nullable=False, server_default=sa.text("'{}'")))
        table.alter_column("mean_distance_m", existing_type=sa.Double(), nullable=True)
        table.alter_column("mean_bev_iou", existing_type=sa.Double(), nullable=True)


def downgrade() -> None:
    op.execute("DELETE FROM merge WHERE mean_distance_m IS NULL OR mean_bev_iou IS NULL")
    with op.batch_alter_table("merge") as table:
        table.alter_column("mean_bev_iou", existing_type=sa.Double(), nullable=False)
        table.alter_column("mean_distance_m", existing_type=sa.Double(), nullable=False)
        table.drop_column("evidence")
