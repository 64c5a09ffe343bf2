"""The export job: read the labels a clip of frames at a time, and hand them to the exporter.

All is read in one transaction, so that a decision made meanwhile does not split the dataset into before and after.
"""

import re
from collections import defaultdict
from collections.abc import Iterator

from app import __version__
from app.db.base import now
from app.db.session import Session
from app.drives import repository as drives_repository
from app.drives.models import CameraRow, DriveRow
from app.drives.service import require_drive
from app.exports import repository
from app.identities import repository as identities_repository
from app.jobs.worker import JobContext, JobProgress
from app.tracks import label_repository
from app.tracks import repository as tracks_repository
from app.tracks.label_repository import LabelledFrames, LabelledObservation
from app.tracks.models import LabellingRow
from labeler.errors import HindsightError
from labeler.export import DatasetInfo, DonorReference, LabelledBox, LabelledImage, find_exporter

FRAMES_PER_CLIP = 100
STAGE = "export"


def run_export_job(context: JobContext) -> str | None:
    """Write the dataset file of the job's export, and note its size."""
    with context.store.read() as session:
        export = repository.of_job(session, context.job_id)
        drive = require_drive(session, context.drive_id)
        labelling = tracks_repository.current_labelling(session, context.drive_id)
        if labelling is None:
            raise HindsightError(f"Drive {drive.name} has no labels to export yet. Label it first.")
        exporter = find_exporter(export.format)
        path = context.settings.exports_folder / _file_name(drive, export.format, export.id, exporter.suffix)
        info = DatasetInfo(
            drive=drive.name,
            drive_format=drive.format,
            model=labelling.model_name,
            hindsight_version=__version__,
            created_at=now().isoformat(timespec="seconds"),
            min_score=export.min_score,
            class_names=tuple(labelling.class_names),
        )
        images = _labelled_images(session, drive, labelling, export.min_score, context.progress)
        summary = exporter.write(path, images, info=info)
    with context.store.write() as session:
        done = repository.of_job(session, context.job_id)
        done.file_name = path.name
        done.label_count = summary.label_count
        done.size_bytes = path.stat().st_size
    return f"{summary.label_count:,} labels in {summary.image_count:,} images."


def _labelled_images(
    session: Session, drive: DriveRow, labelling: LabellingRow, min_score: float, progress: JobProgress
) -> Iterator[LabelledImage]:
    """Every image of the drive with its labels, by frame and camera; without objects that a person ignores."""
    cameras = {camera.id: camera for camera in drives_repository.cameras_of(session, [drive.id])[drive.id]}
    ignored = identities_repository.ignored(session, labelling.id)
    progress.stage(STAGE, drive.frame_count)
    for start in range(0, drive.frame_count, FRAMES_PER_CLIP):
        stop = min(start + FRAMES_PER_CLIP, drive.frame_count)
        boxes: defaultdict[tuple[int, int], list[LabelledBox]] = defaultdict(list)
        found = label_repository.labelled_frames(session, labelling.id, start, stop)
        for row in found.observations:
            track = found.tracks[row.track_id]
            if min_score <= (row.label_score or 0.0) and track.identity_id not in ignored:
                boxes[row.frame_index, track.camera_id].append(_to_box(row, found, cameras))
        for image in drives_repository.images_between(session, drive.id, start, stop):
            camera = cameras[image.camera_id]
            yield LabelledImage(
                file_name=image.path,
                camera=camera.name,
                frame_index=image.frame_index,
                timestamp_ns=image.timestamp_ns,
                width_px=camera.width_px,
                height_px=camera.height_px,
                boxes=tuple(boxes[image.frame_index, image.camera_id]),
            )
        progress.advance(stop - start)


def _to_box(row: LabelledObservation, found: LabelledFrames, cameras: dict[int, CameraRow]) -> LabelledBox:
    source = found.donors[row.donor_track_id, row.donor_frame_index]
    donor = None
    if source.id != row.id:
        donor = DonorReference(
            track_id=row.donor_track_id,
            camera=cameras[source.camera_id].name,
            frame_index=row.donor_frame_index,
            score=source.score,
        )
    return LabelledBox(
        xyxy_px=(row.x1_px, row.y1_px, row.x2_px, row.y2_px),
        class_id=row.label_class_id,
        score=row.label_score,
        track_id=row.track_id,
        identity_id=found.tracks[row.track_id].identity_id,
        source=row.label_source,
        filled=bool(row.filled),
        donor=donor,
        probability=row.probability,
        withheld=row.withheld,
    )


def _file_name(drive: DriveRow, export_format: str, export_id: int, suffix: str) -> str:
    name = re.sub(r"[^A-Za-z0-9._-]+", "_", drive.name).strip("._-") or "drive"
    return f"{name}-{export_format}-{export_id}{suffix}"
