"""Know simulated drives

Revision 0003, after 0002. Drives that were registered before count as recorded; register them again to change that.
"""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("drive", sa.Column("is_simulated", sa.Boolean(), nullable=False, server_default=sa.false()))


def downgrade() -> None:
    op.drop_column("drive", "is_simulated")
