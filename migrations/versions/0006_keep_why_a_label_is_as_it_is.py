"""Keep why a label is as it is: trust in its box, why it was withheld, how likely it is right, and by which rule

Revision 0006, after 0005.
"""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("observation", sa.Column("trust", sa.Double(), nullable=True))
    op.add_column("label", sa.Column("withheld", sa.String(), nullable=True))
    op.add_column("label", sa.Column("probability", sa.Double(), nullable=True))
    op.add_column("labelling", sa.Column("propagation", sa.JSON(), nullable=True))


def downgrade() -> None:
    op.drop_column("labelling", "propagation")
    op.drop_column("label", "probability")
    op.drop_column("label", "withheld")
    op.drop_column("observation", "trust")
