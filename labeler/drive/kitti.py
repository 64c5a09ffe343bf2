"""The KITTI tracking benchmark's layout: https://www.cvlibs.net/datasets/kitti/eval_tracking.php.

A sequence is one drive. Files are named by frame number and recorded at 10 Hz; the timestamps are made up from the
number, so that missing files leave a gap. The ego frame is the Velodyne's: x forward, y left, z up.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from labeler.drive.assembly import Recording, assemble
from labeler.drive.errors import DriveError, DriveFileError
from labeler.drive.format import DriveFormat
from labeler.drive.kitti_text import KittiCalibration, read_calibration, read_oxts, read_truth_labels
from labeler.drive.listing import IMAGE_SUFFIXES, LARGEST_NS, counted, folders_in, list_numbered_files, some_of
from labeler.drive.sweeps import checked_sweep, read_float32_rows
from labeler.drive.types import Calibration, Drive, Frame, ImageFile, Poses, Sweep, SweepFile, Truth

PERIOD_NS = 100_000_000
"""Recorded at 10 Hz."""

_CAMERA_FOLDERS = ("image_00", "image_01", "image_02", "image_03")
_LABELLED_CAMERA = "image_02"


@dataclass(frozen=True)
class KittiSweepReader:
    """Reads ``velodyne/<sequence>/<frame>.bin``: x, y, z, reflectance as float32, in the Velodyne's frame."""

    def __call__(self, file: SweepFile) -> Sweep:
        rows = read_float32_rows(file.path, 4)
        return checked_sweep(file, rows[:, :3], rows[:, 3])


@dataclass(frozen=True, eq=False)
class KittiTruthReader:
    """Reads ``label_02/<sequence>.txt``. DriveFileError when it is there and can't be read."""

    path: Path
    calibration: KittiCalibration | None

    def __call__(self, frames: tuple[Frame, ...]) -> Truth | None:
        if not self.path.exists():
            return None
        index_of: dict[int, int] = {}
        for frame in frames:
            image = frame.images.get(_LABELLED_CAMERA)
            index_of[(frame.timestamp_ns if image is None else image.timestamp_ns) // PERIOD_NS] = frame.index
        return read_truth_labels(self.path, index_of, self.calibration, camera=_LABELLED_CAMERA)


@dataclass(frozen=True)
class _Sequence:
    split: Path
    name: str

    @property
    def full_name(self) -> str:
        return f"{self.split.name}/{self.name}"


def _matches(path: Path) -> bool:
    return bool(_splits(path))


def _splits(path: Path) -> list[Path]:
    """The folders that hold image_02 and so on: the given one, or ``training`` and ``testing`` in it."""
    candidates = (path, path / "training", path / "testing")
    return [split for split in candidates if any((split / camera).is_dir() for camera in _CAMERA_FOLDERS)]


def _open(path: Path, scene: str | None) -> Drive:
    sequence = _chosen(path, scene)
    split, name = sequence.split, sequence.name
    warnings: list[str] = []
    images = {
        camera: _images(split / camera / name, camera, warnings)
        for camera in _CAMERA_FOLDERS
        if (split / camera).is_dir()
    }
    sweeps = _numbered(split / "velodyne" / name, frozenset({".bin"}), warnings)
    calibration = _calibration(split / "calib" / f"{name}.txt", warnings)
    recording = Recording(
        name=f"{path.parent.name if split == path else path.name}_{name}",
        format=KITTI.name,
        root=path,
        images=images,
        sizes_px={},
        calibrations=_camera_calibrations(calibration),
        sweeps=[SweepFile(number * PERIOD_NS, file) for number, file in sweeps],
        poses=_poses(split / "oxts" / f"{name}.txt", calibration, warnings),
        read_sweep=KittiSweepReader(),
        read_truth=KittiTruthReader(split / "label_02" / f"{name}.txt", calibration),
    )
    return assemble(recording, warnings)


def _chosen(path: Path, scene: str | None) -> _Sequence:
    sequences = [
        _Sequence(split, name)
        for split in _splits(path)
        for name in sorted({folder.name for camera in _CAMERA_FOLDERS for folder in folders_in(split / camera)})
    ]
    if not sequences:
        raise DriveError(f"{path} has the folders of a KITTI drive, but they hold no sequence such as image_02/0000.")
    chosen = [one for one in sequences if scene in (None, one.name, one.full_name)]
    if len(chosen) == 1:
        return chosen[0]
    names = some_of([one.full_name for one in chosen or sequences], at_most=20)
    there = f"{path} holds {counted(len(chosen or sequences), 'KITTI sequence')}: {names}."
    if chosen:
        raise DriveError(f"{there} Name the one to open as the scene.")
    raise DriveError(f"{path} has no KITTI sequence named {scene}. {there}")


def _images(folder: Path, camera: str, warnings: list[str]) -> list[ImageFile]:
    files = _numbered(folder, IMAGE_SUFFIXES, warnings)
    return [ImageFile(camera, number * PERIOD_NS, file) for number, file in files]


def _numbered(folder: Path, suffixes: frozenset[str], warnings: list[str]) -> list[tuple[int, Path]]:
    return list_numbered_files(folder, suffixes, warnings, largest=LARGEST_NS // PERIOD_NS)


def _calibration(file: Path, warnings: list[str]) -> KittiCalibration | None:
    try:
        return read_calibration(file)
    except DriveFileError as error:
        warnings.append(f"The calibration can't be used: {error}")
        return None


def _camera_calibrations(calibration: KittiCalibration | None) -> dict[str, Calibration]:
    if calibration is None:
        return {}
    return {f"image_{number:02d}": found for number, found in calibration.cameras.items()}


def _poses(file: Path, calibration: KittiCalibration | None, warnings: list[str]) -> Poses | None:
    if not file.exists():
        return None
    if calibration is None or calibration.velo_SE3_imu is None:
        warnings.append(f"{file} is not used: the calibration doesn't say where the IMU stands (Tr_imu_velo).")
        return None
    try:
        return read_oxts(file, calibration.velo_SE3_imu, period_ns=PERIOD_NS, warnings=warnings)
    except DriveFileError as error:
        warnings.append(f"The drive is labelled without ego poses: {error}")
        return None


KITTI = DriveFormat(
    name="kitti",
    looked_for="a folder image_02/<sequence>, here or in training or testing, with images named <frame>.png",
    matches=_matches,
    open=_open,
)
