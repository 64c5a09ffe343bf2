"""Makes a Drive of what a format's reader has found: cameras with their sizes, frames, and the reasons to refuse."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from labeler.drive.errors import DriveError, DriveFileError
from labeler.drive.images import image_size
from labeler.drive.listing import some_of
from labeler.drive.synchronisation import synchronise
from labeler.drive.types import Calibration, Camera, Drive, ImageFile, Poses, SweepFile, SweepReader, TruthReader


@dataclass(frozen=True, eq=False)
class Recording:
    """What lies in a drive's folder. ``images`` has a key for each camera that is there or ought to be.

    ``sizes_px`` are (width, height) as the drive's tables tell them, where they do."""

    name: str
    format: str
    root: Path
    images: Mapping[str, Sequence[ImageFile]]
    sizes_px: Mapping[str, tuple[int, int]]
    calibrations: Mapping[str, Calibration]
    sweeps: Sequence[SweepFile]
    poses: Poses | None
    read_sweep: SweepReader
    read_truth: TruthReader


def assemble(recording: Recording, warnings: list[str]) -> Drive:
    """The drive, with ``warnings`` and those that arise here. DriveError when no camera has a readable image."""
    told = list(warnings)
    cameras = _cameras(recording, told)
    if not cameras:
        names = some_of(sorted(recording.images), at_most=10) or "none found"
        reasons = " ".join(["", *told[:5]])
        raise DriveError(f"{recording.root} can't be labelled: no camera has an image (cameras: {names}).{reasons}")
    images = {camera.name: recording.images[camera.name] for camera in cameras}
    frames, more = synchronise(images, recording.sweeps)
    return Drive(
        name=recording.name,
        format=recording.format,
        root=recording.root,
        cameras=cameras,
        frames=frames,
        poses=recording.poses,
        read_sweep=recording.read_sweep,
        read_truth=recording.read_truth,
        warnings=(*told, *more),
    )


def _cameras(recording: Recording, told: list[str]) -> tuple[Camera, ...]:
    """Cameras with images, by name."""
    cameras: list[Camera] = []
    empty: list[str] = []
    uncalibrated: list[str] = []
    for name, images in sorted(recording.images.items()):
        if not images:
            empty.append(name)
            continue
        declared, calibration = recording.sizes_px.get(name), recording.calibrations.get(name)
        size_px = _size_of(images, declared)
        if size_px is None:
            told.append(f"Camera {name} is left out: none of its {len(images):,} images has a readable header.")
            continue
        if declared is not None and size_px != declared:
            told.append(
                f"Camera {name}: its images are {_text(size_px)} pixels, but the calibration is for {_text(declared)}. "
                "The calibration is not used, and the camera is labelled in 2D only."
            )
            calibration = None
        elif calibration is None:
            uncalibrated.append(name)
        cameras.append(Camera(name, size_px[0], size_px[1], calibration))
    if empty:
        told.append(f"Left out cameras without images: {some_of(empty, at_most=10)}.")
    if uncalibrated:
        names = some_of(uncalibrated, at_most=10)
        told.append(f"No usable calibration for {names}: labelled in 2D only, and no merges between cameras.")
    return tuple(cameras)


def _size_of(images: Sequence[ImageFile], declared: tuple[int, int] | None) -> tuple[int, int] | None:
    """The declared size when the first, middle or last image has it, else that of the first readable header."""
    if declared is not None:
        readable = [_header_size(images[row]) for row in sorted({0, len(images) // 2, len(images) - 1})]
        sizes = [size_px for size_px in readable if size_px is not None]
        if declared in sizes or not sizes:
            return declared
        return sizes[0]
    return next((size_px for image in images if (size_px := _header_size(image)) is not None), None)


def _header_size(image: ImageFile) -> tuple[int, int] | None:
    try:
        return image_size(image.path)
    except DriveFileError:
        return None  # reported when the image itself is read


def _text(size_px: tuple[int, int]) -> str:
    return f"{size_px[0]} x {size_px[1]}"
