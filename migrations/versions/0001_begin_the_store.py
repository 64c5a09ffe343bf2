"""Begin the store

Revision 0001, after nothing.
"""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "drive",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("format", sa.String(), nullable=False),
        sa.Column("path", sa.String(), nullable=False),
        sa.Column("scene", sa.String(), nullable=True),
        sa.Column("uploaded", sa.Boolean(), nullable=False),
        sa.Column("frame_count", sa.Integer(), nullable=False),
        sa.Column("start_ns", sa.BigInteger(), nullable=False),
        sa.Column("duration_ns", sa.BigInteger(), nullable=False),
        sa.Column("has_lidar", sa.Boolean(), nullable=False),
        sa.Column("has_poses", sa.Boolean(), nullable=False),
        sa.Column("warnings", sa.JSON(), nullable=False),
        sa.Column("revision", sa.Integer(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_drive")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_drive_path"), "drive", ["path"], unique=False)
    op.create_table(
        "camera",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("drive_id", sa.Integer(), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("width_px", sa.Integer(), nullable=False),
        sa.Column("height_px", sa.Integer(), nullable=False),
        sa.Column("has_calibration", sa.Boolean(), nullable=False),
        sa.ForeignKeyConstraint(["drive_id"], ["drive.id"], name=op.f("fk_camera_drive_id_drive"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_camera")),
        sa.UniqueConstraint("drive_id", "name", name=op.f("uq_camera_drive_id_name")),
    )
    op.create_table(
        "frame",
        sa.Column("drive_id", sa.Integer(), nullable=False),
        sa.Column("frame_index", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("timestamp_ns", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["drive_id"], ["drive.id"], name=op.f("fk_frame_drive_id_drive"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("drive_id", "frame_index", name=op.f("pk_frame")),
        sqlite_with_rowid=False,
    )
    op.create_table(
        "job",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("drive_id", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(), nullable=False),
        sa.Column("state", sa.String(), nullable=False),
        sa.Column("model_path", sa.String(), nullable=True),
        sa.Column("stage", sa.String(), nullable=True),
        sa.Column("done", sa.Integer(), nullable=False),
        sa.Column("total", sa.Integer(), nullable=False),
        sa.Column("message", sa.String(), nullable=True),
        sa.Column("error", sa.String(), nullable=True),
        sa.Column("attempts", sa.Integer(), nullable=False),
        sa.Column("worker", sa.String(), nullable=True),
        sa.Column("heartbeat_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("cancel_requested", sa.Boolean(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("started_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("finished_at", sa.DateTime(timezone=True), nullable=True),
        sa.ForeignKeyConstraint(["drive_id"], ["drive.id"], name=op.f("fk_job_drive_id_drive"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_job")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_job_drive_id"), "job", ["drive_id"], unique=False)
    op.create_index(op.f("ix_job_state_id"), "job", ["state", "id"], unique=False)
    op.create_table(
        "labelling",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("drive_id", sa.Integer(), nullable=False),
        sa.Column("key", sa.String(), nullable=False),
        sa.Column("model_name", sa.String(), nullable=False),
        sa.Column("class_names", sa.JSON(), nullable=False),
        sa.Column("summary", sa.JSON(), nullable=False),
        sa.Column("warnings", sa.JSON(), nullable=False),
        sa.Column("observation_count", sa.Integer(), nullable=False),
        sa.Column("current", sa.Boolean(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(
            ["drive_id"], ["drive.id"], name=op.f("fk_labelling_drive_id_drive"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_labelling")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_labelling_drive_id"), "labelling", ["drive_id"], unique=False)
    op.create_table(
        "box3d",
        sa.Column("labelling_id", sa.Integer(), nullable=False),
        sa.Column("frame_index", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("camera_id", sa.Integer(), nullable=False),
        sa.Column("row", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("track_id", sa.Integer(), nullable=True),
        sa.Column("center_x_m", sa.Double(), nullable=False),
        sa.Column("center_y_m", sa.Double(), nullable=False),
        sa.Column("center_z_m", sa.Double(), nullable=False),
        sa.Column("length_m", sa.Double(), nullable=False),
        sa.Column("width_m", sa.Double(), nullable=False),
        sa.Column("height_m", sa.Double(), nullable=False),
        sa.Column("yaw_rad", sa.Double(), nullable=False),
        sa.Column("score", sa.Double(), nullable=False),
        sa.Column("class_id", sa.Integer(), nullable=False),
        sa.Column("point_count", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(
            ["camera_id"], ["camera.id"], name=op.f("fk_box3d_camera_id_camera"), ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(
            ["labelling_id"], ["labelling.id"], name=op.f("fk_box3d_labelling_id_labelling"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("labelling_id", "frame_index", "camera_id", "row", name=op.f("pk_box3d")),
        sqlite_with_rowid=False,
    )
    op.create_index(op.f("ix_box3d_camera_id"), "box3d", ["camera_id"], unique=False)
    op.create_table(
        "export",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("drive_id", sa.Integer(), nullable=False),
        sa.Column("job_id", sa.Integer(), nullable=False),
        sa.Column("format", sa.String(), nullable=False),
        sa.Column("min_score", sa.Double(), nullable=False),
        sa.Column("label_count", sa.Integer(), nullable=True),
        sa.Column("size_bytes", sa.Integer(), nullable=True),
        sa.Column("file_name", sa.String(), nullable=True),
        sa.ForeignKeyConstraint(["drive_id"], ["drive.id"], name=op.f("fk_export_drive_id_drive"), ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["job_id"], ["job.id"], name=op.f("fk_export_job_id_job"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_export")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_export_drive_id"), "export", ["drive_id"], unique=False)
    op.create_index(op.f("ix_export_job_id"), "export", ["job_id"], unique=False)
    op.create_table(
        "identity",
        sa.Column("labelling_id", sa.Integer(), nullable=False),
        sa.Column("identity_id", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("class_id", sa.Integer(), nullable=False),
        sa.Column("score", sa.Double(), nullable=False),
        sa.Column("donor_track_id", sa.Integer(), nullable=False),
        sa.Column("donor_frame_index", sa.Integer(), nullable=False),
        sa.Column("first_frame", sa.Integer(), nullable=False),
        sa.Column("last_frame", sa.Integer(), nullable=False),
        sa.Column("observation_count", sa.Integer(), nullable=False),
        sa.Column("propagated_count", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(
            ["labelling_id"], ["labelling.id"], name=op.f("fk_identity_labelling_id_labelling"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("labelling_id", "identity_id", name=op.f("pk_identity")),
        sqlite_with_rowid=False,
    )
    op.create_table(
        "image",
        sa.Column("drive_id", sa.Integer(), nullable=False),
        sa.Column("frame_index", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("camera_id", sa.Integer(), nullable=False),
        sa.Column("timestamp_ns", sa.BigInteger(), nullable=False),
        sa.Column("path", sa.String(), nullable=False),
        sa.ForeignKeyConstraint(
            ["camera_id"], ["camera.id"], name=op.f("fk_image_camera_id_camera"), ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(
            ["drive_id", "frame_index"],
            ["frame.drive_id", "frame.frame_index"],
            name=op.f("fk_image_drive_id_frame_index_frame"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("drive_id", "frame_index", "camera_id", name=op.f("pk_image")),
        sqlite_with_rowid=False,
    )
    op.create_index(op.f("ix_image_camera_id"), "image", ["camera_id"], unique=False)
    op.create_table(
        "merge",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("labelling_id", sa.Integer(), nullable=False),
        sa.Column("track_a", sa.Integer(), nullable=False),
        sa.Column("track_b", sa.Integer(), nullable=False),
        sa.Column("score", sa.Double(), nullable=False),
        sa.Column("machine_state", sa.String(), nullable=False),
        sa.Column("state", sa.String(), nullable=False),
        sa.Column("decided_by", sa.String(), nullable=False),
        sa.Column("shared_frames", sa.Integer(), nullable=False),
        sa.Column("agreeing_frames", sa.Integer(), nullable=False),
        sa.Column("mean_distance_m", sa.Double(), nullable=False),
        sa.Column("mean_bev_iou", sa.Double(), nullable=False),
        sa.Column("reason", sa.String(), nullable=False),
        sa.Column("best_frames", sa.JSON(), nullable=False),
        sa.ForeignKeyConstraint(
            ["labelling_id"], ["labelling.id"], name=op.f("fk_merge_labelling_id_labelling"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_merge")),
        sqlite_autoincrement=True,
    )
    op.create_index(
        op.f("ix_merge_labelling_id_track_a_track_b"), "merge", ["labelling_id", "track_a", "track_b"], unique=True
    )
    op.create_table(
        "track",
        sa.Column("labelling_id", sa.Integer(), nullable=False),
        sa.Column("track_id", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("camera_id", sa.Integer(), nullable=False),
        sa.Column("first_frame", sa.Integer(), nullable=False),
        sa.Column("last_frame", sa.Integer(), nullable=False),
        sa.Column("observation_count", sa.Integer(), nullable=False),
        sa.Column("best_score", sa.Double(), nullable=False),
        sa.Column("best_frame", sa.Integer(), nullable=False),
        sa.Column("class_id", sa.Integer(), nullable=False),
        sa.Column("identity_id", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(
            ["camera_id"], ["camera.id"], name=op.f("fk_track_camera_id_camera"), ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(
            ["labelling_id"], ["labelling.id"], name=op.f("fk_track_labelling_id_labelling"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("labelling_id", "track_id", name=op.f("pk_track")),
        sqlite_with_rowid=False,
    )
    op.create_index(op.f("ix_track_camera_id"), "track", ["camera_id"], unique=False)
    op.create_index(op.f("ix_track_labelling_id_identity_id"), "track", ["labelling_id", "identity_id"], unique=False)
    op.create_table(
        "label",
        sa.Column("labelling_id", sa.Integer(), nullable=False),
        sa.Column("track_id", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("frame_index", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("class_id", sa.Integer(), nullable=False),
        sa.Column("score", sa.Double(), nullable=True),
        sa.Column("source", sa.String(), nullable=False),
        sa.Column("donor_track_id", sa.Integer(), nullable=False),
        sa.Column("donor_frame_index", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(
            ["labelling_id", "track_id"],
            ["track.labelling_id", "track.track_id"],
            name=op.f("fk_label_labelling_id_track_id_track"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("labelling_id", "track_id", "frame_index", name=op.f("pk_label")),
        sqlite_with_rowid=False,
    )
    op.create_table(
        "observation",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("labelling_id", sa.Integer(), nullable=False),
        sa.Column("track_id", sa.Integer(), nullable=False),
        sa.Column("frame_index", sa.Integer(), nullable=False),
        sa.Column("x1_px", sa.Double(), nullable=False),
        sa.Column("y1_px", sa.Double(), nullable=False),
        sa.Column("x2_px", sa.Double(), nullable=False),
        sa.Column("y2_px", sa.Double(), nullable=False),
        sa.Column("score", sa.Double(), nullable=True),
        sa.Column("class_id", sa.Integer(), nullable=False),
        sa.Column("filled", sa.Boolean(), nullable=False),
        sa.ForeignKeyConstraint(
            ["labelling_id", "track_id"],
            ["track.labelling_id", "track.track_id"],
            name=op.f("fk_observation_labelling_id_track_id_track"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_observation")),
    )
    op.create_index(
        op.f("ix_observation_labelling_id_frame_index"), "observation", ["labelling_id", "frame_index"], unique=False
    )
    op.create_index(
        op.f("ix_observation_labelling_id_track_id_frame_index"),
        "observation",
        ["labelling_id", "track_id", "frame_index"],
        unique=True,
    )
    op.create_table(
        "review",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("drive_id", sa.Integer(), nullable=False),
        sa.Column("merge_id", sa.Integer(), nullable=True),
        sa.Column("subject_id", sa.Integer(), nullable=True),
        sa.Column("action", sa.String(), nullable=False),
        sa.Column("reviewer", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("anchor_a", sa.JSON(), nullable=False),
        sa.Column("anchor_b", sa.JSON(), nullable=False),
        sa.Column("evidence", sa.JSON(), nullable=False),
        sa.ForeignKeyConstraint(["drive_id"], ["drive.id"], name=op.f("fk_review_drive_id_drive"), ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["merge_id"], ["merge.id"], name=op.f("fk_review_merge_id_merge"), ondelete="SET NULL"),
        sa.ForeignKeyConstraint(
            ["subject_id"], ["review.id"], name=op.f("fk_review_subject_id_review"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_review")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_review_drive_id"), "review", ["drive_id"], unique=False)
    op.create_index(op.f("ix_review_merge_id"), "review", ["merge_id"], unique=False)
    op.create_index(op.f("ix_review_subject_id"), "review", ["subject_id"], unique=False)


def downgrade() -> None:
    op.drop_index(op.f("ix_review_subject_id"), table_name="review")
    op.drop_index(op.f("ix_review_merge_id"), table_name="review")
    op.drop_index(op.f("ix_review_drive_id"), table_name="review")
    op.drop_table("review")
    op.drop_index(op.f("ix_observation_labelling_id_track_id_frame_index"), table_name="observation")
    op.drop_index(op.f("ix_observation_labelling_id_frame_index"), table_name="observation")
    op.drop_table("observation")
    op.drop_table("label")
    op.drop_index(op.f("ix_track_labelling_id_identity_id"), table_name="track")
    op.drop_index(op.f("ix_track_camera_id"), table_name="track")
    op.drop_table("track")
    op.drop_index(op.f("ix_merge_labelling_id_track_a_track_b"), table_name="merge")
    op.drop_table("merge")
    op.drop_index(op.f("ix_image_camera_id"), table_name="image")
    op.drop_table("image")
    op.drop_table("identity")
    op.drop_index(op.f("ix_export_job_id"), table_name="export")
    op.drop_index(op.f("ix_export_drive_id"), table_name="export")
    op.drop_table("export")
    op.drop_index(op.f("ix_box3d_camera_id"), table_name="box3d")
    op.drop_table("box3d")
    op.drop_index(op.f("ix_labelling_drive_id"), table_name="labelling")
    op.drop_table("labelling")
    op.drop_index(op.f("ix_job_state_id"), table_name="job")
    op.drop_index(op.f("ix_job_drive_id"), table_name="job")
    op.drop_table("job")
    op.drop_table("frame")
    op.drop_table("camera")
    op.drop_index(op.f("ix_drive_path"), table_name="drive")
    op.drop_table("drive")
