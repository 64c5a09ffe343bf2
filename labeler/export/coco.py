"""COCO object detection, https://cocodataset.org/#format-data: one JSON file for all images of a drive.

The file is written as the images come: image entries go into it at once, annotations into a second temporary file that
is appended at the end. So memory does not grow with the drive.

Boxes are cut at the image's edges, and those that lie outside are left out: COCO knows no coordinates outside. Classes
that COCO has keep COCO's own ids (1 to 90, with gaps), others get ids from 91 up. Beyond the standard, an image says
its camera, frame and time (as text: 64-bit integers don't survive every JSON reader), and an annotation its score,
track and identity, and in ``attributes`` where its label comes from and how likely it is right.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Generator, Iterable, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO
from uuid import uuid4

from labeler.detection.classes import COCO_CLASSES
from labeler.export.errors import ExportError
from labeler.export.types import DatasetInfo, ExportSummary, LabelledBox, LabelledImage

_UNUSED_COCO_IDS = frozenset({12, 26, 29, 30, 45, 66, 68, 69, 71, 83})
_COCO_IDS = [category_id for category_id in range(1, 91) if category_id not in _UNUSED_COCO_IDS]
COCO_CATEGORY_IDS: dict[str, int] = dict(zip(COCO_CLASSES, _COCO_IDS, strict=True))
"""COCO's own ids of its 80 classes."""


@dataclass(frozen=True)
class CocoExporter:
    """Writes COCO detection JSON."""

    name: str = "coco"
    suffix: str = ".json"
    media_type: str = "application/json"

    def write(self, path: Path, images: Iterable[LabelledImage], *, info: DatasetInfo) -> ExportSummary:
        """See :class:`labeler.export.types.Exporter`."""
        categories = category_ids(info.class_names)
        image_count = label_count = 0
        try:
            with _whole_file(path) as (file, annotations):
                file.write(f'{{"info": {_json(_info(info))},\n"licenses": [],\n"categories": ')
                file.write(_json([{"id": categories[name], "name": name} for name in dict.fromkeys(info.class_names)]))
                file.write(',\n"images": [')
                for image in images:
                    file.write(_separator(image_count) + _json(_image(image, image_count + 1)))
                    image_count += 1
                    for box in image.boxes:
                        xyxy_px = _cut(box.xyxy_px, image.width_px, image.height_px)
                        if xyxy_px is None:
                            continue
                        label_count += 1
                        category = categories[info.class_names[box.class_id]]
                        entry = _annotation(box, xyxy_px, category, annotation_id=label_count, image_id=image_count)
                        annotations.write(_separator(label_count - 1) + _json(entry))
                file.write('\n],\n"annotations": [')
                annotations.seek(0)
                shutil.copyfileobj(annotations, file)
                file.write("\n]}\n")
        except OSError as error:
            raise ExportError(f"The dataset can't be written to {path}: {error.strerror or error}.") from error
        return ExportSummary(image_count, label_count)


def category_ids(class_names: Sequence[str]) -> dict[str, int]:
    """The category id of each class name: COCO's own, or from 91 up in the order of the names."""
    names = list(dict.fromkeys(class_names))
    others = [name for name in names if name not in COCO_CATEGORY_IDS]
    return {name: COCO_CATEGORY_IDS.get(name) or 91 + others.index(name) for name in names}


@contextmanager
def _whole_file(path: Path) -> Generator[tuple[IO[str], IO[str]]]:
    """The file under a temporary name, and another for its second half; it gets its own name at the end."""
    path.parent.mkdir(parents=True, exist_ok=True)
    unique = uuid4().hex
    first, second = (path.with_name(f".{path.name}.{unique}.{part}") for part in ("images", "annotations"))
    try:
        with first.open("x", encoding="utf-8") as file, second.open("x+", encoding="utf-8") as annotations:
            yield file, annotations
            file.flush()
            os.fsync(file.fileno())
        first.replace(path)
    finally:
        first.unlink(missing_ok=True)
        second.unlink(missing_ok=True)


def _info(info: DatasetInfo) -> dict[str, object]:
    return {
        "description": f"Labels of drive {info.drive}, made by Hindsight",
        "version": info.hindsight_version,
        "date_created": info.created_at,
        "drive": info.drive,
        "drive_format": info.drive_format,
        "model": info.model,
        "min_score": info.min_score,
    }


def _image(image: LabelledImage, image_id: int) -> dict[str, object]:
    return {
        "id": image_id,
        "file_name": image.file_name,
        "width": image.width_px,
        "height": image.height_px,
        "camera": image.camera,
        "frame_index": image.frame_index,
        "timestamp_ns": str(image.timestamp_ns),
    }


def _annotation(
    box: LabelledBox,
    xyxy_px: tuple[float, float, float, float],
    category_id: int,
    *,
    annotation_id: int,
    image_id: int,
) -> dict[str, object]:
    x1, y1, x2, y2 = xyxy_px
    width, height = round(x2 - x1, 2), round(y2 - y1, 2)
    attributes: dict[str, object] = {"source": box.source, "filled": box.filled}
    if box.probability is not None:
        attributes["probability"] = box.probability
    if box.withheld is not None:
        attributes["withheld"] = box.withheld
    if box.donor is not None:
        attributes |= {
            "donor_camera": box.donor.camera,
            "donor_frame_index": box.donor.frame_index,
            "donor_track_id": box.donor.track_id,
            "donor_score": box.donor.score,
        }
    return {
        "id": annotation_id,
        "image_id": image_id,
        "category_id": category_id,
        "bbox": [x1, y1, width, height],
        "area": round(width * height, 2),
        "segmentation": [],
        "iscrowd": 0,
        "score": box.score,
        "track_id": box.track_id,
        "identity_id": box.identity_id,
        "attributes": attributes,
    }


def _cut(
    xyxy_px: tuple[float, float, float, float], width_px: int, height_px: int
) -> tuple[float, float, float, float] | None:
    """The part of a box inside the image, to a hundredth of a pixel; None where there is none."""
    x1, y1, x2, y2 = xyxy_px
    x1, x2 = (round(min(max(x, 0.0), width_px), 2) for x in (x1, x2))
    y1, y2 = (round(min(max(y, 0.0), height_px), 2) for y in (y1, y2))
    return (x1, y1, x2, y2) if x2 > x1 and y2 > y1 else None


def _separator(index: int) -> str:
    return ",\n" if index else "\n"


def _json(value: object) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
