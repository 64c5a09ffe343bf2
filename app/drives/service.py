"""Drives: listing, registering, deleting, asking for labels."""

import shutil
from collections.abc import Sequence
from pathlib import Path

from app.db.session import Session, Store
from app.drives import repository
from app.drives.models import CameraRow, DriveRow
from app.drives.schemas import Camera, Drive, DriveDetail, DriveRegistration, DriveState, Model
from app.errors import LocalPathsForbidden, NotFound, UnusableDrive, UnusableModel
from app.jobs import repository as jobs_repository
from app.jobs import service as jobs_service
from app.jobs.models import JobRow
from app.jobs.schemas import Job, JobState
from app.model_choice import chosen_detector, offered_detectors
from app.settings import Settings
from app.tracks import repository as tracks_repository
from app.tracks.repository import LabellingCounts
from labeler.drive import Drive as RecordedDrive
from labeler.drive import DriveError, Poses, is_simulated, open_drive
from labeler.geometry.se3 import yaw_of
from labeler.models import Choice, ModelStoreError, Origin, choose_detector, notice_of

NS_PER_MS = 1_000_000


def list_models(settings: Settings) -> list[Model]:
    """The detectors that a drive can be labelled with, the one that is taken when none is named among them."""
    try:
        chosen, offered = chosen_detector(settings), offered_detectors(settings)
    except ModelStoreError as error:
        raise UnusableModel(str(error)) from error
    return [
        Model(
            name=choice.name,
            named=_named(choice),
            origin=choice.origin,
            default=choice == chosen,
            notice=choice.notice(simulated=False),
        )
        for choice in offered
    ]


def list_drives(session: Session) -> list[Drive]:
    """All drives, newest first."""
    return _to_drives(session, repository.list_newest_first(session))


def get_drive(session: Session, drive_id: int) -> DriveDetail:
    row = require_drive(session, drive_id)
    cameras = repository.cameras_of(session, [drive_id])[drive_id]
    labelling = tracks_repository.current_labelling(session, drive_id)
    drive = drive_of(session, row)
    notices = [drive.notice] if drive.notice else []
    return DriveDetail(
        **drive.model_dump(),
        cameras=[
            Camera(
                name=camera.name,
                width_px=camera.width_px,
                height_px=camera.height_px,
                has_calibration=camera.has_calibration,
            )
            for camera in cameras
        ],
        frame_times_ms=[(time - row.start_ns) / NS_PER_MS for time in repository.frame_times_ns(session, drive_id)],
        warnings=list(dict.fromkeys([*notices, *row.warnings, *(labelling.warnings if labelling else ())])),
        class_names=labelling.class_names if labelling else [],
        revision=row.revision,
        summary=labelling.summary if labelling else None,
    )


def require_drive(session: Session, drive_id: int) -> DriveRow:
    """The drive's row; NotFound where there is none."""
    row = repository.find(session, drive_id)
    if row is None:
        raise NotFound(f"There is no drive {drive_id}. It may have been deleted.")
    return row


def register_drive(store: Store, settings: Settings, registration: DriveRegistration) -> Drive:
    """Take a folder of the server's disk as it lies there; one that is known already is answered as it is."""
    if not settings.may_use_local_paths:
        raise LocalPathsForbidden(
            f"This server can be reached from other machines ({settings.host}), so folders of its own disk can't be "
            "registered from the page. Upload the drive, or start the server with HINDSIGHT_ALLOW_LOCAL_PATHS=true."
        )
    return add_local_drive(store, registration)


def add_local_drive(store: Store, registration: DriveRegistration) -> Drive:
    """Take a folder of this machine's disk; one that is known already is answered as it is."""
    path = _expand_user(registration.path)
    if not path.is_absolute():
        raise UnusableDrive(
            f"{registration.path} is not a whole path. Name the folder from the root, as in /data/drive."
        )
    recorded = open_recorded_drive(path, scene=registration.scene)
    with store.write() as session:
        known = repository.find_by_path(session, str(recorded.root), registration.scene)
        row = known or add_drive(session, recorded, path=str(recorded.root), scene=registration.scene, uploaded=False)
        return drive_of(session, row)


def _expand_user(path: str) -> Path:
    try:
        return Path(path).expanduser()
    except RuntimeError:  # no such user
        return Path(path)


def open_recorded_drive(path: Path, *, scene: str | None = None) -> RecordedDrive:
    """The drive in a folder; UnusableDrive with the reason where it can't be used."""
    try:
        return open_drive(path, scene=scene)
    except DriveError as error:
        raise UnusableDrive(str(error)) from error


def open_stored_drive(settings: Settings, row: DriveRow) -> RecordedDrive:
    """The recorded drive of a row."""
    return open_recorded_drive(settings.workspace / row.path, scene=row.scene)


def add_drive(session: Session, recorded: RecordedDrive, *, path: str, scene: str | None, uploaded: bool) -> DriveRow:
    """Store a recorded drive: its cameras, frames and names of images."""
    start_ns, end_ns = recorded.frames[0].timestamp_ns, recorded.frames[-1].timestamp_ns
    drive = DriveRow(
        name=recorded.name,
        format=recorded.format,
        path=path,
        scene=scene,
        uploaded=uploaded,
        frame_count=len(recorded.frames),
        start_ns=start_ns,
        duration_ns=end_ns - start_ns,
        has_lidar=recorded.has_lidar,
        has_poses=recorded.poses is not None,
        is_simulated=is_simulated(recorded.root),
        warnings=list(recorded.warnings),
    )
    cameras = {
        camera.name: CameraRow(
            position=position,
            name=camera.name,
            width_px=camera.width_px,
            height_px=camera.height_px,
            has_calibration=camera.calibration is not None,
        )
        for position, camera in enumerate(recorded.cameras)
    }
    repository.insert_drive(session, drive, cameras.values())
    frames = [
        {
            "drive_id": drive.id,
            "frame_index": frame.index,
            "timestamp_ns": frame.timestamp_ns,
            **_ego_columns(recorded.poses, frame.timestamp_ns),
        }
        for frame in recorded.frames
    ]
    images = [
        {
            "drive_id": drive.id,
            "frame_index": frame.index,
            "camera_id": cameras[image.camera].id,
            "timestamp_ns": image.timestamp_ns,
            "path": _below(recorded.root, image.path),
        }
        for frame in recorded.frames
        for image in frame.images.values()
    ]
    repository.insert_frames(session, frames, images)
    return drive


def queue_labelling(session: Session, settings: Settings, drive_id: int, model: str | None = None) -> Job:
    """Queue labelling with the model of that name or file, or with the one that the settings lead to."""
    require_drive(session, drive_id)
    return jobs_service.queue_label_job(session, drive_id, model_path=str(_detector(settings, model).path))


def queue_if_suited(session: Session, settings: Settings, drive_id: int) -> None:
    """Queue labelling where nobody asked for it: with a model that the settings name, or one that knows such drives."""
    simulated = require_drive(session, drive_id).is_simulated
    try:
        detector = _detector(settings, None)
    except UnusableModel:
        return  # the page says why when somebody asks
    if settings.model is not None or detector.notice(simulated=simulated) is None:
        jobs_service.queue_label_job(session, drive_id, model_path=str(detector.path))


def drive_of(session: Session, row: DriveRow) -> Drive:
    """What the page learns about a drive."""
    return _to_drives(session, [row])[0]


def delete_drive(store: Store, settings: Settings, drive_id: int) -> None:
    """Forget a drive; then delete its uploaded copy. A registered folder stays as it is."""
    with store.write() as session:
        row = require_drive(session, drive_id)
        repository.delete_drive(session, drive_id)
    if row.uploaded:
        shutil.rmtree(settings.drives_folder / _first_part(row.path), ignore_errors=True)


def _detector(settings: Settings, named: str | None) -> Choice:
    try:
        choice = chosen_detector(settings) if named is None else choose_detector(named, settings.model_cache)
        offered = offered_detectors(settings)
    except ModelStoreError as error:
        raise UnusableModel(str(error)) from error
    if choice not in offered and not settings.may_use_local_paths:
        raise LocalPathsForbidden(
            f"This server can be reached from other machines ({settings.host}), so only models that it offers can be "
            "used."
        )
    if not choice.path.is_file():
        raise UnusableModel(f"There is no model file {choice.path}.")
    return choice


def _named(choice: Choice) -> str:
    """What a request calls that model."""
    return str(choice.path) if choice.origin is Origin.FILE else choice.name


def _to_drives(session: Session, rows: Sequence[DriveRow]) -> list[Drive]:
    ids = [row.id for row in rows]
    cameras = repository.cameras_of(session, ids)
    jobs = jobs_repository.latest_label_jobs(session, ids)
    counts = tracks_repository.counts_of_drives(session, ids)
    return [_to_drive(row, cameras[row.id], counts.get(row.id), jobs.get(row.id)) for row in rows]


def _to_drive(row: DriveRow, cameras: Sequence[CameraRow], counts: LabellingCounts | None, job: JobRow | None) -> Drive:
    return Drive(
        id=row.id,
        name=row.name,
        format=row.format,
        state=_state(job, is_labelled=counts is not None),
        frame_count=row.frame_count,
        camera_names=[camera.name for camera in cameras],
        duration_ms=row.duration_ns / NS_PER_MS,
        has_lidar=row.has_lidar,
        has_poses=row.has_poses,
        is_simulated=row.is_simulated,
        model=counts.model_name if counts else None,
        notice=notice_of(counts.model_name, simulated=row.is_simulated) if counts else None,
        identity_count=counts.identities if counts else 0,
        track_count=counts.tracks if counts else 0,
        observation_count=counts.observations if counts else 0,
        proposed_merge_count=counts.proposed_merges if counts else 0,
        uploaded=row.uploaded,
        error=job.error if job else None,
        created_at=row.created_at,
        job=jobs_service.to_job(job) if job else None,
    )


def _state(job: JobRow | None, *, is_labelled: bool) -> DriveState:
    """What the drive's latest label job makes of it; an earlier result outlives a later failure."""
    match job.state if job else None:
        case JobState.QUEUED:
            return DriveState.QUEUED
        case JobState.RUNNING:
            return DriveState.LABELLING
        case JobState.FAILED if not is_labelled:
            return DriveState.FAILED
        case _:
            return DriveState.READY if is_labelled else DriveState.NEW


def _ego_columns(poses: Poses | None, timestamp_ns: int) -> dict[str, float | None]:
    """Where the car was, as the columns of a frame."""
    if poses is None:
        return {"ego_x_m": None, "ego_y_m": None, "ego_yaw_rad": None}
    city_SE3_ego = poses.at(timestamp_ns)
    return {
        "ego_x_m": float(city_SE3_ego[0, 3]),
        "ego_y_m": float(city_SE3_ego[1, 3]),
        "ego_yaw_rad": yaw_of(city_SE3_ego),
    }


def _below(root: Path, path: Path) -> str:
    return str(path.relative_to(root)) if path.is_relative_to(root) else str(path)


def _first_part(path: str) -> str:
    """``drives/<folder>/...`` -> ``<folder>``."""
    return Path(path).parts[1]
