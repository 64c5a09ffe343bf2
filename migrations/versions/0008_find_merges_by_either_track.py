"""Find merges by either track, and those that people decided, without reading all

Revision 0008, after 0007.
"""

from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_index(op.f("ix_merge_labelling_id_track_b"), "merge", ["labelling_id", "track_b"])
    op.create_index(op.f("ix_merge_labelling_id_decided_by_state"), "merge", ["labelling_id", "decided_by", "state"])


def downgrade() -> None:
    op.drop_index(op.f("ix_merge_labelling_id_decided_by_state"), table_name="merge")
    op.drop_index(op.f("ix_merge_labelling_id_track_b"), table_name="merge")
