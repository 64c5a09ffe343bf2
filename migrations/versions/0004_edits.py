"""Let people edit: effects of edits, tracks in pieces, drawn boxes, marks, undo

Revision 0004, after 0003.
"""

import json

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None

_NO_ROWID = {"sqlite_with_rowid": False}
_AUTOINCREMENT = {"sqlite_autoincrement": True}


def upgrade() -> None:
    _add_effects()
    for table, column in (("track", "track_id"), ("observation", "track_id"), ("box3d", "track_id")):
        op.add_column(table, sa.Column("tracked_id", sa.Integer(), nullable=True))
        op.execute(f"UPDATE {table} SET tracked_id = {column}")
    for column in ("tracked_a", "tracked_b", "frame_a", "frame_b"):
        op.add_column("merge", sa.Column(column, sa.Integer(), nullable=True))
    _place_merges()
    op.add_column("review", sa.Column("payload", sa.JSON(), nullable=True))
    op.execute("UPDATE review SET payload = '{}'")

    with op.batch_alter_table("track", table_kwargs=_NO_ROWID) as track:
        track.alter_column("tracked_id", existing_type=sa.Integer(), nullable=False)
        track.alter_column("best_score", existing_type=sa.Double(), nullable=True)
        track.create_index(track.f("ix_track_labelling_id_tracked_id"), ["labelling_id", "tracked_id"])
    with op.batch_alter_table("observation") as observation:
        observation.alter_column("tracked_id", existing_type=sa.Integer(), nullable=False)
        observation.alter_column("track_id", existing_type=sa.Integer(), nullable=True)
        observation.add_column(sa.Column("drawn", sa.Boolean(), nullable=False, server_default=sa.false()))
        observation.create_index(
            observation.f("ix_observation_labelling_id_tracked_id_frame_index"),
            ["labelling_id", "tracked_id", "frame_index"],
        )
    with op.batch_alter_table("merge", table_kwargs=_AUTOINCREMENT) as merge:
        for column in ("tracked_a", "tracked_b", "frame_a", "frame_b"):
            merge.alter_column(column, existing_type=sa.Integer(), nullable=False)
        for column in ("track_a", "track_b"):
            merge.alter_column(column, existing_type=sa.Integer(), nullable=True)
        merge.drop_index("ix_merge_labelling_id_track_a_track_b")
        merge.create_index(merge.f("ix_merge_labelling_id_track_a_track_b"), ["labelling_id", "track_a", "track_b"])
    with op.batch_alter_table("identity", table_kwargs=_NO_ROWID) as identity:
        identity.alter_column("score", existing_type=sa.Double(), nullable=True)
        identity.add_column(sa.Column("class_by_person", sa.Boolean(), nullable=False, server_default=sa.false()))
        identity.add_column(sa.Column("mark", sa.String(), nullable=True))
        identity.add_column(sa.Column("comment_count", sa.Integer(), nullable=False, server_default="0"))
    with op.batch_alter_table("labelling", table_kwargs=_AUTOINCREMENT) as labelling:
        labelling.add_column(sa.Column("since_revision", sa.Integer(), nullable=False, server_default="0"))
    with op.batch_alter_table("review", table_kwargs=_AUTOINCREMENT) as review:
        review.alter_column("payload", existing_type=sa.JSON(), nullable=False)
        review.add_column(sa.Column("target_id", sa.Integer(), nullable=True))
        review.add_column(sa.Column("undone", sa.Boolean(), nullable=False, server_default=sa.false()))
        review.add_column(sa.Column("revision", sa.Integer(), nullable=False, server_default="0"))
        review.create_foreign_key(
            review.f("fk_review_target_id_review"), "review", ["target_id"], ["id"], ondelete="CASCADE"
        )
        review.create_index(review.f("ix_review_target_id"), ["target_id"])


def _add_effects() -> None:
    op.create_table(
        "effect",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("labelling_id", sa.Integer(), nullable=False),
        sa.Column("review_id", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(), nullable=False),
        sa.Column("tracked_id", sa.Integer(), nullable=False),
        sa.Column("frame_index", sa.Integer(), nullable=False),
        sa.Column("other_tracked_id", sa.Integer(), nullable=True),
        sa.Column("other_frame_index", sa.Integer(), nullable=True),
        sa.Column("until_frame", sa.Integer(), nullable=True),
        sa.Column("made_track_id", sa.Integer(), nullable=True),
        sa.Column("value", sa.JSON(), nullable=False),
        sa.Column("active", sa.Boolean(), nullable=False),
        sa.ForeignKeyConstraint(
            ["labelling_id"], ["labelling.id"], name=op.f("fk_effect_labelling_id_labelling"), ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(
            ["review_id"], ["review.id"], name=op.f("fk_effect_review_id_review"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_effect")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_effect_labelling_id_tracked_id"), "effect", ["labelling_id", "tracked_id"])
    op.create_index(op.f("ix_effect_labelling_id_kind"), "effect", ["labelling_id", "kind"])
    op.create_index(op.f("ix_effect_review_id"), "effect", ["review_id"])


def _place_merges() -> None:
    """Anchor each merge in the frame of its best evidence, or of each track's best observation where it names none."""
    connection = op.get_bind()
    merges = connection.execute(
        sa.text(
            "SELECT m.id, m.track_a, m.track_b, m.best_frames, a.best_frame, b.best_frame FROM merge m "
            "JOIN track a ON a.labelling_id = m.labelling_id AND a.track_id = m.track_a "
            "JOIN track b ON b.labelling_id = m.labelling_id AND b.track_id = m.track_b"
        )
    ).all()
    for merge_id, track_a, track_b, best_frames, best_a, best_b in merges:
        frames = json.loads(best_frames) if isinstance(best_frames, str) else best_frames
        shared = frames[0]["frame_index"] if frames else None
        connection.execute(
            sa.text("UPDATE merge SET tracked_a = :a, tracked_b = :b, frame_a = :fa, frame_b = :fb WHERE id = :id"),
            {
                "a": track_a,
                "b": track_b,
                "fa": best_a if shared is None else shared,
                "fb": best_b if shared is None else shared,
                "id": merge_id,
            },
        )


def downgrade() -> None:
    """Labels of edited drives are lost: they must be labelled again. Decisions about merges stay."""
    for table in ("observation", "label", "box3d", "identity", "merge", "track"):
        op.execute(f"DELETE FROM {table} WHERE labelling_id IN (SELECT labelling_id FROM effect)")
    op.execute("DELETE FROM labelling WHERE id IN (SELECT labelling_id FROM effect)")
    op.drop_table("effect")
    op.execute("DELETE FROM review WHERE undone OR target_id IS NOT NULL OR subject_id IS NULL")
    with op.batch_alter_table("review", table_kwargs=_AUTOINCREMENT) as review:
        review.drop_index("ix_review_target_id")
        review.drop_constraint("fk_review_target_id_review", type_="foreignkey")
        for column in ("payload", "target_id", "undone", "revision"):
            review.drop_column(column)
    with op.batch_alter_table("labelling", table_kwargs=_AUTOINCREMENT) as labelling:
        labelling.drop_column("since_revision")
    with op.batch_alter_table("identity", table_kwargs=_NO_ROWID) as identity:
        identity.alter_column("score", existing_type=sa.Double(), nullable=False)
        for column in ("class_by_person", "mark", "comment_count"):
            identity.drop_column(column)
    with op.batch_alter_table("merge", table_kwargs=_AUTOINCREMENT) as merge:
        merge.drop_index("ix_merge_labelling_id_track_a_track_b")
        for column in ("track_a", "track_b"):
            merge.alter_column(column, existing_type=sa.Integer(), nullable=False)
        for column in ("tracked_a", "tracked_b", "frame_a", "frame_b"):
            merge.drop_column(column)
        merge.create_index(
            merge.f("ix_merge_labelling_id_track_a_track_b"), ["labelling_id", "track_a", "track_b"], unique=True
        )
    with op.batch_alter_table("observation") as observation:
        observation.drop_index("ix_observation_labelling_id_tracked_id_frame_index")
        observation.alter_column("track_id", existing_type=sa.Integer(), nullable=False)
        observation.drop_column("tracked_id")
        observation.drop_column("drawn")
    with op.batch_alter_table("track", table_kwargs=_NO_ROWID) as track:
        track.drop_index("ix_track_labelling_id_tracked_id")
        track.alter_column("best_score", existing_type=sa.Double(), nullable=False)
        track.drop_column("tracked_id")
    with op.batch_alter_table("box3d", table_kwargs=_NO_ROWID) as box3d:
        box3d.drop_column("tracked_id")
