"""Which units of work a run has, and the key of each: a hash of all that its result depends on.

Keys name content, not places: of images and sweeps by the bytes of the files, of the results of earlier stages by the
names of their artifacts, which are keys themselves. So a drive that was moved is not labelled again, and one whose
calibration was mended is.
"""

from __future__ import annotations

import pickle
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import blake2b
from itertools import groupby
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.detection import DetectionConfig, Detector
from labeler.detection.classes import suppression_group_of
from labeler.drive import Camera, Drive, Frame, ImageFile, Poses, SweepFile
from labeler.identity import Decisions, IdentityConfig, Rig, calibration
from labeler.lidar import LidarConfig, usual_sizes_m
from labeler.pipeline.artifacts import Artifacts, key_of
from labeler.pipeline.colouring import ColourUnit
from labeler.pipeline.detecting import DetectUnit
from labeler.pipeline.lidar_units import LidarFrame, LidarUnit, lidar_frame
from labeler.pipeline.segmenting import SegmentUnit
from labeler.pipeline.units import DonorUnit, IdentityUnit, LabelUnit, TrackUnit
from labeler.propagation import PropagationConfig, probability
from labeler.tracking import CameraMotion, TrackingConfig, trust

CLIP_FRAMES = 16
TRACK_IDS_PER_CAMERA = 1_000_000
LONGEST_LOAN_NS = 250_000_000
"""A frame without a sweep takes the nearest one in time, if it is no farther than this."""


@dataclass(frozen=True)
class Classes:
    """The detector's classes by id, and the group of each within which a detector may waver."""

    names: tuple[str, ...]
    groups: tuple[int, ...]

    @staticmethod
    def of(detector: Detector) -> Classes:
        groups: list[int] = suppression_group_of(detector.class_names).tolist()
        return Classes(detector.class_names, tuple(groups))


@dataclass(frozen=True)
class Clips:
    """The artifacts of detection, or segmentation: for each camera that has images, those of its clips by number, in
    order of time.

    ``images`` counts the images of each camera.
    """

    of_camera: Mapping[str, Mapping[int, Path]]
    images: Mapping[str, int]

    @staticmethod
    def of(units: Sequence[DetectUnit] | Sequence[SegmentUnit], paths: Sequence[Path]) -> Clips:
        of_camera: dict[str, dict[int, Path]] = {}
        images: Counter[str] = Counter()
        for unit, path in zip(units, paths, strict=True):
            of_camera.setdefault(unit.camera.name, {})[unit.clip] = path
            images[unit.camera.name] += len(unit.images)
        return Clips(of_camera, images)

    def by_camera(self) -> dict[str, list[Path]]:
        """The artifacts of each camera in order of time."""
        return {camera: list(clips.values()) for camera, clips in self.of_camera.items()}

    def of_clip(self, clip: int) -> dict[str, Path]:
        """The artifacts of one clip by camera."""
        return {camera: clips[clip] for camera, clips in self.of_camera.items() if clip in clips}


def detect_units(
    drive: Drive, detector: Detector, config: DetectionConfig, *, artifacts: Artifacts, model: Path
) -> list[DetectUnit]:
    """A unit for each camera and clip of frames, camera by camera."""
    model_hash = artifacts.content_hash([model])
    planned: list[DetectUnit] = []
    for camera in drive.cameras:
        for clip, of_clip in _clips_of_images(camera, drive.frames):
            key = key_of(model_hash, detector.class_names, config, _images_key(camera, of_clip, artifacts))
            planned.append(DetectUnit(key, camera, clip, of_clip))
    return planned


def segment_units(drive: Drive, *, artifacts: Artifacts, model: Path) -> list[SegmentUnit]:
    """A unit for each calibrated camera and clip of frames, where the drive has LiDAR: what can be painted."""
    model_hash = artifacts.content_hash([model])
    planned: list[SegmentUnit] = []
    for camera in drive.cameras:
        if camera.calibration is None or not drive.has_lidar:
            continue
        for clip, of_clip in _clips_of_images(camera, drive.frames):
            key = key_of(model_hash, _images_key(camera, of_clip, artifacts))
            planned.append(SegmentUnit(key, camera, clip, of_clip))
    return planned


def lidar_units(
    drive: Drive, clips: Clips, segmented: Clips, classes: Classes, config: LidarConfig, *, artifacts: Artifacts
) -> list[LidarUnit]:
    """A unit for each clip of frames; none when no camera is calibrated. ``segmented`` may be empty."""
    cameras = tuple(camera for camera in drive.cameras if camera.calibration is not None)
    rig = [(camera.name, *_calibration_key(camera)) for camera in cameras]
    reader = blake2b(pickle.dumps(drive.read_sweep), digest_size=16).hexdigest()
    sweeps = _nearest_sweeps(drive)
    network = None if config.network is None else artifacts.content_hash([Path(config.network)])
    planned: list[LidarUnit] = []
    if not cameras:
        return planned
    for clip, group in groupby(drive.frames, key=lambda frame: frame.index // CLIP_FRAMES):
        frames = tuple(lidar_frame(frame, sweeps[frame.index], drive.poses) for frame in group)
        detections, segmentation = clips.of_clip(clip), segmented.of_clip(clip)
        key = key_of(
            replace(config, network=network),
            classes.names,
            rig,
            reader,
            _names(detections),
            _names(segmentation),
            [(frame.frame_index, frame.timestamp_ns, _motion_key(frame)) for frame in frames],
            artifacts.content_hash(frame.sweep.path for frame in frames if frame.sweep is not None),
        )
        planned.append(
            LidarUnit(key, frames, cameras, detections, segmentation, drive.read_sweep, config, classes.names)
        )
    return planned


def track_units(drive: Drive, clips: Clips, classes: Classes, config: TrackingConfig) -> list[TrackUnit]:
    """A unit for each camera; the n-th camera's tracks are numbered from n million and 1."""
    planned: list[TrackUnit] = []
    for number, (camera, paths) in enumerate(clips.by_camera().items(), start=1):
        first_id = first_track_id(number)
        motion = motion_of(drive, camera, classes.names, config)
        key = key_of(
            config,
            classes.groups,
            camera,
            first_id,
            [path.name for path in paths],
            trust.shipped_text(),
            None if motion is None else motion.content(),
        )
        effort = clips.images[camera]
        planned.append(TrackUnit(key, tuple(paths), config, classes.groups, first_id, effort, motion))
    return planned


def motion_of(drive: Drive, camera: str, class_names: Sequence[str], config: TrackingConfig) -> CameraMotion | None:
    """How a camera of a drive moves, for its tracker; None where it is not known, or ``config`` does without it."""
    times_ns = [frame.images[camera].timestamp_ns for frame in drive.frames if camera in frame.images]
    return motion_over(drive.camera(camera), drive.poses, times_ns, class_names, config)


def motion_over(
    camera: Camera, poses: Poses | None, times_ns: Sequence[int], class_names: Sequence[str], config: TrackingConfig
) -> CameraMotion | None:
    """How a camera moves over the times of its images; None as above."""
    if config.ego_motion == "none" or config.method == "baseline":
        return None
    height_m = usual_sizes_m(np.arange(len(class_names)), tuple(class_names))[:, 2]
    if config.ego_motion == "rotation":
        height_m = np.full(len(class_names), np.inf)  # seen as from far away, where only turns count
    return CameraMotion.of(camera, poses, times_ns, height_m)


def first_track_id(camera_number: int) -> int:
    """The id of the first track of the n-th camera, counted from 1."""
    return camera_number * TRACK_IDS_PER_CAMERA + 1


def colour_units(drive: Drive, tracks: Mapping[str, Path]) -> list[ColourUnit]:
    """A unit for each camera. The name of its tracks stands for the images that they were found in as well."""
    planned: list[ColourUnit] = []
    for camera in drive.cameras:
        if camera.name not in tracks:
            continue
        images = [(frame.index, frame.images[camera.name]) for frame in drive.frames if camera.name in frame.images]
        path = tracks[camera.name]
        planned.append(ColourUnit(key_of(path.name), camera, dict(images), path, len(images)))
    return planned


def identity_unit(
    drive: Drive,
    tracks: Mapping[str, Path],
    boxes_3d: Sequence[Path],
    colours: Sequence[Path],
    classes: Classes,
    config: IdentityConfig,
    decisions: Decisions,
) -> IdentityUnit:
    """The one unit of the drive. ``decisions`` are those of a person about this drive."""
    rig = rig_of(drive)
    poses = None if rig.city_SE3_ego is None else blake2b(rig.city_SE3_ego.tobytes(), digest_size=16).hexdigest()
    key = key_of(
        config,
        classes.groups,
        _names(tracks),
        [path.name for path in boxes_3d],
        [path.name for path in colours],
        calibration.shipped_text(),
        [(camera.name, camera.width_px, camera.height_px, *_calibration_key(camera)) for camera in drive.cameras],
        rig.timestamp_ns.tolist(),
        poses,
        (decisions.same, decisions.different),
    )
    return IdentityUnit(key, tracks, tuple(boxes_3d), tuple(colours), config, classes.groups, rig, decisions)


def rig_of(drive: Drive) -> Rig:
    """The cameras of a drive, and the pose of the car at the time of each frame."""
    poses = drive.poses
    return Rig.of(
        drive.cameras,
        frame_times_of(drive),
        None if poses is None else np.stack([poses.at(frame.timestamp_ns) for frame in drive.frames]),
    )


def donor_unit(drive: Drive, tracks: Mapping[str, Path], identities: Path, config: PropagationConfig) -> DonorUnit:
    """The one unit of the drive."""
    times_ns = frame_times_of(drive)
    key = key_of(config, _names(tracks), identities.name, times_ns.tolist())
    return DonorUnit(key, tracks, identities, config, times_ns)


def label_units(
    drive: Drive, tracks: Mapping[str, Path], identities: Path, donors: Path, config: PropagationConfig
) -> list[LabelUnit]:
    """A unit for each camera."""
    times_ns = frame_times_of(drive)
    shared = (identities.name, donors.name, probability.shipped_text())
    return [
        LabelUnit(key_of(path.name, *shared), path, identities, donors, config, times_ns) for path in tracks.values()
    ]


def frame_times_of(drive: Drive) -> NDArray[np.int64]:
    """(F,) the time of each frame."""
    return np.array([frame.timestamp_ns for frame in drive.frames], np.int64)


def _clips_of_images(
    camera: Camera, frames: Sequence[Frame]
) -> Iterator[tuple[int, tuple[tuple[int, ImageFile], ...]]]:
    """(clip, its images with their frames) of one camera, in order."""
    images = [(frame.index, frame.images[camera.name]) for frame in frames if camera.name in frame.images]
    for clip, group in groupby(images, key=lambda item: item[0] // CLIP_FRAMES):
        yield clip, tuple(group)


def _images_key(camera: Camera, images: Sequence[tuple[int, ImageFile]], artifacts: Artifacts) -> str:
    """A key of all that reading these images depends on."""
    return key_of(
        (camera.width_px, camera.height_px),
        [(index, file.timestamp_ns) for index, file in images],
        artifacts.content_hash(file.path for _, file in images),
    )


def _names(paths: Mapping[str, Path]) -> dict[str, str]:
    return {camera: path.name for camera, path in paths.items()}


def _calibration_key(camera: Camera) -> tuple[list[float], list[float]]:
    if camera.calibration is None:
        return [], []
    return camera.calibration.intrinsics.ravel().tolist(), camera.calibration.ego_SE3_camera.ravel().tolist()


def _motion_key(frame: LidarFrame) -> tuple[int | None, list[float], dict[str, list[float]]]:
    return (
        None if frame.sweep is None else frame.sweep.timestamp_ns,
        frame.frame_ego_SE3_sweep_ego.ravel().tolist(),
        {camera: matrix.ravel().tolist() for camera, matrix in frame.image_ego_SE3_frame_ego.items()},
    )


def _nearest_sweeps(drive: Drive) -> list[SweepFile | None]:
    """For each frame its own sweep, else the nearest in time of another frame, where that is near enough."""
    sweeps = [frame.sweep for frame in drive.frames if frame.sweep is not None]
    times = np.array([sweep.timestamp_ns for sweep in sweeps], np.int64)
    chosen: list[SweepFile | None] = []
    for frame in drive.frames:
        sweep = frame.sweep
        if sweep is None and len(sweeps):
            off_ns = np.abs(times - frame.timestamp_ns)
            nearest = int(off_ns.argmin())
            sweep = sweeps[nearest] if off_ns[nearest] <= LONGEST_LOAN_NS else None
        chosen.append(sweep)
    return chosen
