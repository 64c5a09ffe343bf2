"""Keep the last audit of a labelling

Revision 0007, after 0006.
"""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "audit",
        sa.Column("labelling_id", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("result", sa.JSON(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(
            ["labelling_id"], ["labelling.id"], name=op.f("fk_audit_labelling_id_labelling"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("labelling_id", name=op.f("pk_audit")),
    )


def downgrade() -> None:
    op.drop_table("audit")
