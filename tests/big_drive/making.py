"""Make a workspace with a big drive in it: 1000 frames x 4 cameras, 2000 identities, 200,000 boxes.

    python -m tests.big_drive WORKSPACE
    hindsight serve --workspace WORKSPACE

Pictures, a few kilobytes each, are drawn by code; labels go into the store through the app's own importing code.
"""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pyarrow.feather as pyarrow_feather
from scipy.spatial.transform import Rotation

from app.commands.label import store_labels
from app.settings import Settings, load_settings
from labeler.pipeline.types import SilentProgress
from tests.big_drive import pictures
from tests.big_drive.labels import Tracked, label, track
from tests.big_drive.traffic import (
    CAMERA_HEIGHT_M,
    CAMERAS,
    FOCAL_PX,
    HEIGHT_PX,
    WIDTH_PX,
    YAW_DEG,
    Objects,
    make_objects,
    see,
)

pa: Any = pyarrow  # its types are partial
feather: Any = pyarrow_feather

START_NS, PERIOD_NS = 1_700_000_000_000_000_000, 100_000_000
FOLDER_NAME = "big drive"


@dataclass(frozen=True)
class Size:
    """How much the drive holds. ``objects`` become ``identities``: some merges are left for a person."""

    frames: int = 1000
    objects: int = 1600
    identities: int = 2000
    boxes: int = 200_000
    seed: int = 1


BIG = Size()
SMALL = Size(frames=60, objects=60, identities=75, boxes=4_000)


def make_workspace(workspace: Path, size: Size = BIG) -> Settings:
    """Write the drive into a folder of the workspace, and its labels into the workspace's store."""
    random = np.random.default_rng(size.seed)
    objects = make_objects(size.objects, size.frames, random)
    tracked = track(see(objects, size.frames, at_most=size.boxes), objects, random)
    labelled = label(tracked, size.identities, frames=size.frames, random=random)
    workspace.mkdir(parents=True, exist_ok=True)
    folder = _write_drive(workspace / FOLDER_NAME, tracked, objects, size.frames)
    settings = load_settings(workspace=workspace, database_url=f"sqlite:///{workspace.absolute()}/hindsight.db")
    store_labels(settings, folder, labelled, scene=None, model_name="made by code", progress=SilentProgress())
    return settings


def _write_drive(folder: Path, tracked: Tracked, objects: Objects, frames: int) -> Path:
    for camera in CAMERAS:
        (folder / "sensors" / "cameras" / camera).mkdir(parents=True)
    with ThreadPoolExecutor() as threads:
        for _ in threads.map(lambda job: _write_image(folder, *job), _image_jobs(tracked, objects, frames)):
            pass
    _write_calibration(folder / "calibration")
    return folder


def _image_jobs(tracked: Tracked, objects: Objects, frames: int) -> Iterable[tuple[int, int, Any, Any, Any, Any]]:
    """Frame, camera, and what to draw: boxes, objects and classes, far ones first; and the picture to draw on."""
    sightings = tracked.sightings
    base = pictures.background()
    order = np.lexsort((-sightings.distance_m, sightings.camera, sightings.frame))
    key = sightings.frame[order] * len(CAMERAS) + sightings.camera[order]
    edges = np.searchsorted(key, np.arange(frames * len(CAMERAS) + 1))
    for image in range(frames * len(CAMERAS)):
        rows = order[edges[image] : edges[image + 1]]
        numbers = sightings.obj[rows]
        boxes_px = np.rint(sightings.xyxy_px[rows]).astype(np.int64)
        yield *divmod(image, len(CAMERAS)), boxes_px, numbers.tolist(), objects.class_id[numbers].tolist(), base


def _write_image(folder: Path, frame: int, camera: int, boxes_px: Any, numbers: Any, classes: Any, base: Any) -> None:
    name = CAMERAS[camera]
    content = pictures.draw(base, frame, name, boxes_px, numbers, classes)
    (folder / "sensors" / "cameras" / name / f"{START_NS + frame * PERIOD_NS}.jpg").write_bytes(content)


def _write_calibration(folder: Path) -> None:
    folder.mkdir()
    count = len(CAMERAS)
    # A camera looks along its z; x is to its right, y down.
    looks_ahead = Rotation.from_matrix([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])
    turns = Rotation.from_euler("z", np.array(YAW_DEG)[:, None], degrees=True) * looks_ahead
    x, y, z, w = turns.as_quat().T
    poses = {"qw": w, "qx": x, "qy": y, "qz": z, "tx_m": [0.0] * count, "ty_m": [0.0] * count}
    intrinsics = {"fx_px": FOCAL_PX, "fy_px": FOCAL_PX, "cx_px": WIDTH_PX / 2, "cy_px": HEIGHT_PX * 0.48}
    sizes = {"width_px": WIDTH_PX, "height_px": HEIGHT_PX}
    distortion = {"k1": 0.0, "k2": 0.0, "k3": 0.0}
    same = {name: [value] * count for name, value in (intrinsics | distortion | sizes).items()}
    names = {"sensor_name": list(CAMERAS)}
    height = {"tz_m": [CAMERA_HEIGHT_M] * count}
    feather.write_feather(pa.table(names | poses | height), str(folder / "egovehicle_SE3_sensor.feather"))
    feather.write_feather(pa.table(names | same), str(folder / "intrinsics.feather"))
