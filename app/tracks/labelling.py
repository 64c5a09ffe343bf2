"""The label job: run the pipeline on a drive, and take the result into the store."""

from pathlib import Path

from app.drives.service import open_stored_drive, require_drive
from app.jobs.worker import JobContext
from app.model_choice import boxes_file, segmentation_file
from app.reviews.constraints import constraints_about
from app.tracks.importing import import_labelled_drive
from labeler.errors import HindsightError
from labeler.identity import IdentityConfig
from labeler.pipeline import LabelSettings
from labeler.pipeline.run import label_drive


def run_label_job(context: JobContext) -> str | None:
    """Label the job's drive. What an earlier run made of it is used again, and what people decided about it holds."""
    if context.model_path is None:
        raise HindsightError("The job names no model.")
    model = Path(context.model_path)
    with context.store.read() as session:
        row = require_drive(session, context.drive_id)
        decisions = constraints_about(session, context.drive_id)
    drive = open_stored_drive(context.settings, row)
    segmentation = segmentation_file(context.settings, drive.root)
    labelled = label_drive(
        drive,
        model=model,
        segmentation=segmentation,
        boxes=boxes_file(context.settings, drive.root),
        workspace=context.settings.workspace,
        settings=LabelSettings(
            identity=IdentityConfig(method=context.settings.identity),
            propagation=context.settings.propagation_config(model),
        ),
        decisions=decisions,
        progress=context.progress,
    )
    changed = import_labelled_drive(
        context.store, context.drive_id, labelled, model_name=model.stem, progress=context.progress
    )
    return None if changed else "Nothing has changed since the drive was labelled."
